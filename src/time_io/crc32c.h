// CRC-32C: whether bytes are those that were written (G. Castagnoli 1993; RFC 3720, appendix B.4).
#pragma once

#include <cstddef>
#include <cstdint>

namespace kairos {

/// Of `size` bytes after those of which `before` is the checksum.
uint32_t crc32c(const void* data, size_t size, uint32_t before = 0);

/// The same on machines without an instruction for it.
uint32_t crc32c_of_tables(const void* data, size_t size, uint32_t before = 0);

}  // namespace kairos
