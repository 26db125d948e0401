// Text in glTF files: names, percent-encoded relative paths, data: URIs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kairos::gltf {

bool is_data_uri(std::string_view uri);

/// The bytes of a data: URI, base64 or percent-encoded. Throws Error(bad_input, place).
std::vector<uint8_t> decode_data_uri(std::string_view uri, const std::string& place);

/// %XX becomes the byte it stands for; a '%' without two hexadecimal digits stays as it is.
std::string percent_decode(std::string_view uri);

}  // namespace kairos::gltf
