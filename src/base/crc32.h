// The checksum of ZIP archives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace kairos {

/// [byte]: what it adds to a remainder.
inline constexpr std::array<uint32_t, 256> kCrc32Table = [] {
  std::array<uint32_t, 256> table{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t rest = i;
    for (int bit = 0; bit < 8; ++bit) rest = (rest & 1u) != 0 ? 0xedb88320u ^ (rest >> 1) : rest >> 1;
    table[i] = rest;
  }
  return table;
}();

/// CRC-32 of ISO 3309, of all bytes that were added.
class Crc32 {
 public:
  void add(const void* data, size_t size) {
    const auto* bytes = static_cast<const uint8_t*>(data);
    for (size_t i = 0; i < size; ++i) rest_ = kCrc32Table[(rest_ ^ bytes[i]) & 0xff] ^ (rest_ >> 8);
  }
  uint32_t value() const { return ~rest_; }

 private:
  uint32_t rest_ = 0xffffffffu;
};

}  // namespace kairos
