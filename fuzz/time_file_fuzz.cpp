// Any bytes as a picture over time: opened, exposed and read whole, or kairos::Error is thrown. Checksums are made to
// fit first, where there is room for them: else hardly anything would get past them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/object_layers.h>
#include <kairos/time_file.h>

#include "time_io/crc32c.h"

namespace {

/// Puts at `field` the checksum of [begin, end) without the field itself.
void fit(std::vector<uint8_t>& bytes, size_t begin, size_t end, size_t field) {
  if (begin > field || field + 4 > end || end > bytes.size()) return;
  const uint32_t before = kairos::crc32c(bytes.data() + begin, field - begin);
  const uint32_t sum = kairos::crc32c(bytes.data() + field + 4, end - field - 4, before);
  std::memcpy(bytes.data() + field, &sum, sizeof sum);
}

template <class Number>
uint64_t number_at(const std::vector<uint8_t>& bytes, size_t at) {
  Number number = 0;
  if (at + sizeof number <= bytes.size()) std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

void fit_all(std::vector<uint8_t>& bytes) {
  constexpr uint64_t kFar = 1 << 30;
  const uint64_t text = std::min(number_at<uint32_t>(bytes, 12), kFar);
  fit(bytes, 0, 64 + text, 40);
  const uint64_t index = number_at<uint64_t>(bytes, 16);
  if (index != 0 && index < bytes.size()) fit(bytes, index, bytes.size(), index + 8);
  const uint64_t last = index != 0 ? std::min<uint64_t>(index, bytes.size()) : bytes.size();
  for (uint64_t at = 64 + text; at + 64 <= last;) {
    const uint64_t packed = std::min(number_at<uint64_t>(bytes, at + 24), kFar);
    fit(bytes, at, at + 64 + packed, at + 4);
    at += (64 + packed + 15) / 16 * 16;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<uint8_t> bytes(data, data + size);
  fit_all(bytes);
  const int file = memfd_create("fuzz", 0);
  if (file < 0 || write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  try {
    const kairos::TimeFile opened = kairos::TimeFile::open("/proc/self/fd/" + std::to_string(file));
    const kairos::TimeFrame& frame = opened.picture().frame();
    constexpr int64_t kMostPixels = 1 << 16;
    if (int64_t{frame.width} * frame.height <= kMostPixels) {
      opened.check();
      kairos::ExposeOptions options;
      options.threads = 1;
      const kairos::Image image = opened.picture().expose(kairos::TimeWeight({{0.25, 1}, {0.5, 1}}), options);
      for (const float value : image.channels[0].values)
        if (std::isnan(value) && opened.picture().quality().tolerance != 0) std::abort();
      opened.picture().at(1, options);
      if (opened.has_rays()) {
        kairos::deep_segments(image, opened, {[](int, int) { return kairos::TimeWeight({{0.25, 1}, {0.5, 1}}); }});
      }
      if (opened.picture().has_objects())
        opened.picture().objects({[](int, int) { return kairos::TimeWeight({{0.25, 1}, {0.5, 1}}); }}, options);
    }
  } catch (const kairos::Error&) {
  }
  close(file);
  return 0;
}
