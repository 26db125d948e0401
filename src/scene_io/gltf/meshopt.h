// Buffer views compressed by meshoptimizer (EXT_meshopt_compression).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// count * byteStride bytes. Throws Error at `where` for what is no such stream, or has numbers that the extension does
/// not allow.
std::vector<uint8_t> decode_meshopt(Document& document, const file::Compression& packed, std::span<const uint8_t> bytes,
                                    const std::string& where);

}  // namespace kairos::gltf
