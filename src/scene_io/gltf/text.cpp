#include "scene_io/gltf/text.h"

#include <algorithm>

#include <kairos/error.h>
#include <kairos/printable.h>

namespace kairos::gltf {

namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

std::vector<uint8_t> decode_base64(std::string_view text, const std::string& place) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int bit_count = 0;
  for (char c : text) {
    const int digit = base64_digit(c);
    if (digit < 0) throw Error(ErrorCode::bad_input, place, "its data: URI holds a character that is not base64");
    bits = (bits << 6) | static_cast<uint32_t>(digit);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<uint8_t>(bits >> bit_count));
    }
  }
  return bytes;
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  constexpr std::string_view kScheme = "data:";
  return uri.size() >= kScheme.size() &&
         std::equal(kScheme.begin(), kScheme.end(), uri.begin(), [](char known, char c) {
           return known == (c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
         });
}

std::vector<uint8_t> decode_data_uri(std::string_view uri, const std::string& place) {
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos)
    throw Error(ErrorCode::bad_input, place, "its data: URI has no comma before the data");
  const std::string_view head = uri.substr(0, comma), body = uri.substr(comma + 1);
  constexpr std::string_view kBase64 = ";base64";
  if (head.size() >= kBase64.size() && head.substr(head.size() - kBase64.size()) == kBase64)
    return decode_base64(body, place);
  const std::string text = percent_decode(body);
  return {text.begin(), text.end()};
}

std::string percent_decode(std::string_view uri) {
  std::string result;
  result.reserve(uri.size());
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0) {
      result.push_back(static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2])));
      i += 2;
    } else {
      result.push_back(uri[i]);
    }
  }
  return result;
}

}  // namespace kairos::gltf
