// Numbers in files, least significant byte first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kairos {

/// The caller has checked that the bytes are there.
template <class Number>
Number read_little(const uint8_t* bytes) {
  Number value = 0;
  for (size_t i = 0; i < sizeof(Number); ++i) value |= static_cast<Number>(static_cast<Number>(bytes[i]) << (8 * i));
  return value;
}
/// Of a whole number.
template <class Number>
void put_little(std::vector<uint8_t>& out, Number value) {
  for (size_t i = 0; i < sizeof(Number); ++i)
    out.push_back(static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i)));
}

}  // namespace kairos
