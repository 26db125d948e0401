// Progress and cancellation while many threads render.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>

#include <kairos/error.h>
#include <kairos/render.h>

namespace kairos {

class Monitor {
 public:
  Monitor(const Progress& progress, uint64_t pixels) : progress_(progress), pixels_(pixels) {}

  void finish_pixel() { done_.fetch_add(1, std::memory_order_relaxed); }

  /// Called often, from any thread. Tells the caller now and then; throws Error(cancelled) when they said stop.
  void poll() {
    if (!progress_) return;
    if (cancelled_.load(std::memory_order_relaxed)) cancel();
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    auto due = due_.load(std::memory_order_relaxed);
    if (now.count() < due) return;
    if (!due_.compare_exchange_strong(due, (now + kInterval).count())) return;  // another thread is at it
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!progress_(fraction())) cancelled_ = true;
    if (cancelled_) cancel();
  }

  /// Once all is done.
  void finish() {
    if (progress_ && !progress_(1)) cancel();
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kInterval = std::chrono::milliseconds(50);

  double fraction() const { return static_cast<double>(done_.load()) / static_cast<double>(pixels_); }
  [[noreturn]] static void cancel() { throw Error(ErrorCode::cancelled, "", "rendering was stopped"); }

  const Progress& progress_;
  uint64_t pixels_;
  std::atomic<uint64_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::atomic<Clock::rep> due_{0};
  std::mutex mutex_;
};

}  // namespace kairos
