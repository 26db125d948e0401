// The values in a PLY file after its header, one after the other: text or binary behind the same functions.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include <kairos/error.h>

#include "scene_io/ply/header.h"
#include "scene_io/text_numbers.h"

namespace kairos {

class PlyAsciiSource {
 public:
  PlyAsciiSource(std::string_view rest, const std::string& path) : rest_(rest), path_(path) {}

  double number(PlyType) { return parse<double>(); }
  float real(PlyType type) { return type == PlyType::float32 ? parse<float>() : to_float(parse<double>()); }
  void skip(PlyType, uint64_t count) {
    for (uint64_t i = 0; i < count; ++i) take_token();
  }
  /// The most values of `type` that the rest of the file may hold: each takes a digit and a space.
  uint64_t room(PlyType) const { return room(uint64_t{2}); }
  /// The most elements of at least `size` bytes.
  uint64_t room(uint64_t size) const { return (rest_.size() + 1) / size; }
  static uint64_t min_size(PlyType) { return 2; }

  /// Beyond float's range is infinite: a plain conversion of such a number is undefined.
  static float to_float(double x) {
    if (std::abs(x) > std::numeric_limits<float>::max())
      return x > 0 ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity();
    return static_cast<float>(x);
  }

 private:
  std::string_view take_token() {
    constexpr std::string_view kSpaces = " \t\r\n\v\f";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kSpaces), rest_.size()));
    if (rest_.empty()) throw Error(ErrorCode::bad_input, path_, "ends before the last of its elements");
    const std::string_view token = rest_.substr(0, rest_.find_first_of(kSpaces));
    rest_.remove_prefix(token.size());
    return token;
  }

  template <class T>
  T parse() {
    const std::string_view token = take_token();
    T value = 0;
    if (!parse_number(token, value))
      throw Error(ErrorCode::bad_input, path_, "'" + printable(token) + "' is not a number");
    return value;
  }

  std::string_view rest_;
  const std::string& path_;
};

template <bool kSwap>
class PlyBinarySource {
 public:
  PlyBinarySource(std::string_view rest, const std::string& path) : rest_(rest), path_(path) {}

  double number(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return take<int8_t, uint8_t>();
      case PlyType::uint8:
        return take<uint8_t, uint8_t>();
      case PlyType::int16:
        return take<int16_t, uint16_t>();
      case PlyType::uint16:
        return take<uint16_t, uint16_t>();
      case PlyType::int32:
        return take<int32_t, uint32_t>();
      case PlyType::uint32:
        return take<uint32_t, uint32_t>();
      case PlyType::float32:
        return take<float, uint32_t>();
      case PlyType::float64:
        break;
    }
    return take<double, uint64_t>();
  }
  float real(PlyType type) {
    return type == PlyType::float32 ? take<float, uint32_t>() : PlyAsciiSource::to_float(number(type));
  }
  /// `count` is at most room(type).
  void skip(PlyType type, uint64_t count) { rest_.remove_prefix(size_of(type) * count); }
  uint64_t room(PlyType type) const { return rest_.size() / size_of(type); }
  uint64_t room(uint64_t size) const { return rest_.size() / size; }
  static uint64_t min_size(PlyType type) { return size_of(type); }

 private:
  template <class T, class Bits>
  T take() {
    if (rest_.size() < sizeof(Bits)) throw Error(ErrorCode::bad_input, path_, "ends before the last of its elements");
    Bits bits;
    std::memcpy(&bits, rest_.data(), sizeof(Bits));
    rest_.remove_prefix(sizeof(Bits));
    if constexpr (kSwap && sizeof(Bits) == 2) bits = __builtin_bswap16(bits);
    if constexpr (kSwap && sizeof(Bits) == 4) bits = __builtin_bswap32(bits);
    if constexpr (kSwap && sizeof(Bits) == 8) bits = __builtin_bswap64(bits);
    return std::bit_cast<T>(bits);
  }

  std::string_view rest_;
  const std::string& path_;
};

}  // namespace kairos
