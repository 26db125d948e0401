// Reads OpenEXR files.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <kairos/image.h>

namespace kairos {

struct ExrSize {
  int width = 0, height = 0;  ///< of the data window
  uint64_t channels = 0;
};

/// What the header says, once it is known to be sound and to ask the library for no more memory than the file bears
/// out. Throws Error(bad_input, place).
ExrSize exr_size(std::span<const uint8_t> bytes, const std::string& place);

/// All channels as floats, and the attributes of the kinds that Attribute knows, in alphabetical order. Refuses files
/// whose pixels would need more than `byte_limit` bytes. Of several parts the first is read. Throws
/// Error(bad_input, place).
Image read_exr(std::span<const uint8_t> bytes, const std::string& place, uint64_t byte_limit);

/// The same from a file. Throws Error(io), too.
Image read_exr(const std::string& path, uint64_t byte_limit = uint64_t{1} << 32);

}  // namespace kairos
