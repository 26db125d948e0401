#include "base/memory_budget.h"

#include <algorithm>
#include <limits>

#include <kairos/error.h>

namespace kairos {

void MemoryBudget::add_file(uint64_t bytes) {
  constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();
  const uint64_t granted = bytes > kMost / kPerFileByte ? kMost : bytes * kPerFileByte;
  left_ += std::min(granted, kMost - left_);
}

bool MemoryBudget::take(uint64_t bytes) {
  if (bytes > left_) return false;
  left_ -= bytes;
  return true;
}

void MemoryBudget::charge(uint64_t bytes, const std::string& place) {
  if (take(bytes)) return;
  throw Error(ErrorCode::bad_input, place,
              "grows by another " + megabytes_text(bytes) + ", where the scene's files leave " + megabytes_text(left_) +
                  "; if they are to be trusted, raise --memory-budget");
}

std::string megabytes_text(uint64_t bytes) {
  constexpr uint64_t kMegabyte = 1000000;
  return std::to_string(bytes / kMegabyte + (bytes % kMegabyte != 0 ? 1 : 0)) + " MB";
}

}  // namespace kairos
