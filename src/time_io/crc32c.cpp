#include "time_io/crc32c.h"

#include <array>
#include <cstring>

#if defined(__x86_64__)
#include <nmmintrin.h>
#endif

namespace kairos {

namespace {

constexpr uint32_t kPolynomial = 0x82f63b78;  // bits in reverse
constexpr size_t kAtOnce = 8;                 // bytes

using Tables = std::array<std::array<uint32_t, 256>, kAtOnce>;

/// [n][byte]: what a byte adds with n bytes behind it.
constexpr Tables make_tables() {
  Tables tables{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t sum = byte;
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1u) != 0 ? sum >> 1 ^ kPolynomial : sum >> 1;
    tables[0][byte] = sum;
  }
  for (size_t n = 1; n < kAtOnce; ++n)
    for (size_t byte = 0; byte < 256; ++byte)
      tables[n][byte] = tables[n - 1][byte] >> 8 ^ tables[0][tables[n - 1][byte] & 0xffu];
  return tables;
}

constexpr Tables kTables = make_tables();

#if defined(__x86_64__)
/// SSE4.2 has an instruction for it.
__attribute__((target("sse4.2"))) uint32_t with_instruction(const unsigned char* bytes, size_t size, uint64_t sum) {
  for (; size >= sizeof(uint64_t); size -= sizeof(uint64_t), bytes += sizeof(uint64_t)) {
    uint64_t word;
    std::memcpy(&word, bytes, sizeof word);
    sum = _mm_crc32_u64(sum, word);
  }
  auto rest = static_cast<uint32_t>(sum);
  for (; size > 0; --size, ++bytes) rest = _mm_crc32_u8(rest, *bytes);
  return rest;
}
#endif

}  // namespace

uint32_t crc32c(const void* data, size_t size, uint32_t before) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("sse4.2"))
    return ~with_instruction(static_cast<const unsigned char*>(data), size, ~before);
#endif
  return crc32c_of_tables(data, size, before);
}

uint32_t crc32c_of_tables(const void* data, size_t size, uint32_t before) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  uint32_t sum = ~before;
  for (; size >= kAtOnce; size -= kAtOnce, bytes += kAtOnce) {
    uint32_t next = 0;
    for (size_t i = 0; i < kAtOnce; ++i) {
      const uint32_t byte = i < 4 ? bytes[i] ^ (sum >> (8 * i) & 0xffu) : bytes[i];
      next ^= kTables[kAtOnce - 1 - i][byte];
    }
    sum = next;
  }
  for (; size > 0; --size, ++bytes) sum = sum >> 8 ^ kTables[0][(sum ^ *bytes) & 0xffu];
  return ~sum;
}

}  // namespace kairos
