#include "event_io/npy.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <kairos/error.h>

#include "event_io/event_format.h"

namespace kairos {

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr size_t kPreamble = 10;  // magic, version, length of the rest of the header

/// What stands behind 'key': in the dictionary, up to a comma or the brace that ends it, but for those in brackets.
std::string value_of(std::string_view text, std::string_view key) {
  const size_t at = text.find(std::string("'") + std::string(key) + "':");
  if (at == std::string_view::npos) return "";
  std::string value;
  int depth = 0;
  for (size_t i = at + key.size() + 3; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '(' || c == '[') ++depth;
    if (depth == 0 && (c == ',' || c == '}')) break;
    if (c == ')' || c == ']') --depth;
    value += c;
  }
  return value;
}

}  // namespace

size_t npy_item_size(const std::string& descr) {
  static constexpr std::array<std::pair<std::string_view, size_t>, 12> kSizes{{
      {"'|b1'", 1},
      {"'|u1'", 1},
      {"'|i1'", 1},
      {"'<u2'", 2},
      {"'<i2'", 2},
      {"'<u4'", 4},
      {"'<i4'", 4},
      {"'<u8'", 8},
      {"'<i8'", 8},
      {"'<f4'", 4},
      {"'<f8'", 8},
      {kNpyEvents, 16},
  }};
  for (const auto& [name, size] : kSizes)
    if (name == descr) return size;
  return 0;
}

NpyArray parse_npy(const std::string& place, std::span<const uint8_t> bytes) {
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::bad_input, place, why); };
  if (bytes.size() < kPreamble || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin(),
                                              [](char a, uint8_t b) { return static_cast<uint8_t>(a) == b; }))
    refuse("is no numpy array");
  const bool is_long = bytes[6] >= 2;  // later versions have longer headers
  if (is_long && bytes.size() < kPreamble + 2) refuse("ends within its header");
  const size_t begin = is_long ? kPreamble + 2 : kPreamble;
  const size_t length = is_long ? read_little<uint32_t>(&bytes[8]) : read_little<uint16_t>(&bytes[8]);
  if (bytes.size() - begin < length) refuse("ends within its header");
  std::string text;
  for (const uint8_t c : bytes.subspan(begin, length))
    if (std::isspace(c) == 0) text += static_cast<char>(c);
  NpyArray array;
  array.descr = value_of(text, "descr");
  const std::string shape = value_of(text, "shape");
  if (value_of(text, "fortran_order") != "False" || shape.size() < 4 || shape.front() != '(' ||
      shape.substr(shape.size() - 2) != ",)" || shape.find(',') != shape.size() - 2 || shape.size() > 20)
    refuse("is no one-dimensional array");
  for (const char digit : shape.substr(1, shape.size() - 3)) {
    if (digit < '0' || digit > '9') refuse("is no one-dimensional array");
    array.count = array.count * 10 + static_cast<uint64_t>(digit - '0');
  }
  array.data = bytes.subspan(begin + length);
  const size_t size = npy_item_size(array.descr);
  if (size > 0 && array.data.size() / size < array.count)
    refuse("should hold " + std::to_string(array.count) + " numbers, but ends before the last");
  return array;
}

}  // namespace kairos
