// Where random tests begin.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace kairos::test {

/// Another one each time; printed. KAIROS_SEED of the environment, if it is set: that replays a failure.
inline uint32_t seed() {
  const char* text = std::getenv("KAIROS_SEED");
  const uint32_t value =
      text != nullptr ? static_cast<uint32_t>(std::strtoul(text, nullptr, 10)) : std::random_device()();
  std::printf("KAIROS_SEED=%u\n", value);
  return value;
}

}  // namespace kairos::test
