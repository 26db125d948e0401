// What Embree needs around it: a device whose errors become exceptions, and the arithmetic it asks for.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>

#include <embree3/rtcore.h>

#include <kairos/tracer.h>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace kairos {

/// An Embree device that remembers its first error and counts its memory. Not to be moved: Embree points to it.
class EmbreeDevice {
 public:
  /// set: which of Embree's code is used; the machine must have it. Rounding differs, so it decides about bits.
  explicit EmbreeDevice(InstructionSet set);
  ~EmbreeDevice();
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;

  RTCDevice get() const { return device_; }
  /// Throws Error(bad_input) when a call has failed since the last check.
  void check();
  size_t memory_bytes() const;

 private:
  static void on_error(void* self, RTCError code, const char* text);
  static bool on_memory(void* self, ssize_t bytes, bool post);

  std::atomic<int64_t> bytes_{0};
  std::mutex mutex_;
  std::string error_;
  bool out_of_memory_ = false;
  RTCDevice device_ = nullptr;
};

struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;
using EmbreeGeometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry>;

/// While it lives, denormals of this thread are zero, going in and coming out.
class DenormalsAreZero {
#if defined(__SSE__)
 public:
  DenormalsAreZero() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlushToZero | kDenormalsAreZero); }
  ~DenormalsAreZero() { _mm_setcsr(saved_); }
  DenormalsAreZero(const DenormalsAreZero&) = delete;
  DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;  // bits of MXCSR
  unsigned saved_;
#endif
};

}  // namespace kairos
