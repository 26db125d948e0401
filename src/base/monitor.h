// Progress and cancellation while many threads render.
#pragma once

#include <atomic>
#include <cstdint>

#include "base/parallel.h"

namespace kairos {

/// How much of a picture is done. Safe to use from many threads at once.
class Monitor {
 public:
  explicit Monitor(uint64_t pixels) : pixels_(pixels) {}

  void finish_pixel() { done_.fetch_add(1, std::memory_order_relaxed); }

  /// Called often, by whoever renders; throws Error(cancelled) when the caller said stop.
  void poll() { throw_if_cancelled(); }

  /// 0 to 1.
  double fraction() const {
    return static_cast<double>(done_.load(std::memory_order_relaxed)) / static_cast<double>(pixels_);
  }

 private:
  uint64_t pixels_;
  std::atomic<uint64_t> done_{0};
};

}  // namespace kairos
