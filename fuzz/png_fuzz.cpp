// PNG's check sums would keep the fuzzer out: they are made right first.
#include <vector>

#include <zlib.h>

#include "picture_fuzz.h"

namespace {

std::vector<uint8_t> with_check_sums(std::span<const uint8_t> bytes) {
  std::vector<uint8_t> png(bytes.begin(), bytes.end());
  constexpr size_t kSignature = 8, kAround = 12;  // length, name and check sum of a chunk
  for (size_t at = kSignature; at + kAround <= png.size();) {
    uint64_t size = 0;
    for (size_t i = 0; i < 4; ++i) size = size << 8 | png[at + i];
    if (size > png.size() - at - kAround) break;
    const auto sum = static_cast<uint32_t>(crc32(0, &png[at + 4], static_cast<uInt>(size + 4)));
    for (size_t i = 0; i < 4; ++i) png[at + 8 + size + i] = static_cast<uint8_t>(sum >> (24 - 8 * i));
    at += kAround + size;
  }
  return png;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  fuzz_picture(kairos::kPng, with_check_sums({data, size}));
  return 0;
}
