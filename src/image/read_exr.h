// Reads OpenEXR files.
#pragma once

#include <cstdint>
#include <string>

#include <kairos/image.h>

namespace kairos {

/// All channels as floats, and the attributes of the kinds that Attribute knows, in alphabetical order. Refuses files
/// whose pixels would need more than `byte_limit` bytes. Throws Error(io) or Error(bad_input).
Image read_exr(const std::string& path, uint64_t byte_limit = uint64_t{1} << 32);

}  // namespace kairos
