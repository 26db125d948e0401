#include "event_io/npy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <filesystem>
#include <type_traits>
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

/// Bytes of a label.
size_t label_size() {
  size_t size = 0;
  const KindLabel like;
  kind_label_fields([&](const char* /*name*/, const auto& field) { size += sizeof field; }, like);
  return size;
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

std::string npy_labels_path(const std::string& path) {
  return std::filesystem::path(path).replace_extension(".labels.npy").string();
}

std::string npy_labels_descr() {
  std::string descr;
  const KindLabel like;
  kind_label_fields(
      [&](const char* name, const auto& field) {
        descr += descr.empty() ? "[(" : ",(";
        descr += "'" + std::string(name) + "'," + npy_descr<std::remove_cvref_t<decltype(field)>>() + ")";
      },
      like);
  return descr + "]";
}

NpyLabels::NpyLabels(const std::string& place, std::span<const uint8_t> bytes, uint64_t count) {
  const NpyArray array = parse_npy(place, bytes);
  if (array.descr != npy_labels_descr()) throw Error(ErrorCode::bad_input, place, "is no array of labels of events");
  if (array.count != count || array.data.size() / label_size() < count)
    throw Error(ErrorCode::bad_input, place,
                "has not as many labels as there are events (" + std::to_string(count) +
                    ") in the file beside which it lies; remove it, or write both again");
  data_ = array.data.first(count * label_size());
}

KindLabel NpyLabels::at(uint64_t index) const {
  KindLabel all;
  const uint8_t* at = &data_[index * label_size()];
  kind_label_fields(
      [&](const char* /*name*/, auto& field) {
        using Number = std::remove_cvref_t<decltype(field)>;
        if constexpr (std::is_same_v<Number, float>)
          field = std::bit_cast<float>(read_little<uint32_t>(at));
        else if constexpr (sizeof(Number) == 4)
          field = read_little<uint32_t>(at);
        else
          field = static_cast<Number>(*at);
        at += sizeof field;
      },
      all);
  return all;
}

}  // namespace kairos
