// The hash by which Cryptomatte names things.
#pragma once

#include <cstdint>
#include <string_view>

namespace kairos {

/// MurmurHash3 of 32 bits for x86 (A. Appleby 2011), with the seed 0.
uint32_t murmur3_32(std::string_view text);

/// The float that stands for a name in Cryptomatte's channels: the hash's bits, but for infinities, denormals and what
/// is no number.
float cryptomatte_id(std::string_view name);

}  // namespace kairos
