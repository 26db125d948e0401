#include "discrete/embree_device.h"

#include <algorithm>
#include <new>

#include <kairos/error.h>

namespace kairos {

namespace {

/// In Embree's words.
const char* config_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::scalar:
    case InstructionSet::sse4:
      return "isa=sse4.2";
    case InstructionSet::avx2:
      return "isa=avx2";
    case InstructionSet::avx512:
      return "isa=avx512";
    case InstructionSet::neon:
      break;
  }
  return "";
}

}  // namespace

EmbreeDevice::EmbreeDevice(InstructionSet set) : device_(rtcNewDevice(config_of(set))) {
  if (!device_ && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (!device_)
    throw Error(ErrorCode::bad_input, "Embree",
                "cannot start (error " + std::to_string(rtcGetDeviceError(nullptr)) + "); is this processor too old?");
  rtcSetDeviceErrorFunction(device_, on_error, this);
  rtcSetDeviceMemoryMonitorFunction(device_, on_memory, this);
}

EmbreeDevice::~EmbreeDevice() { rtcReleaseDevice(device_); }

void EmbreeDevice::check() {
  const std::lock_guard lock(mutex_);
  if (error_.empty()) return;
  const std::string error = std::move(error_);
  error_.clear();
  if (out_of_memory_) throw std::bad_alloc();
  throw Error(ErrorCode::bad_input, "Embree", error);
}

size_t EmbreeDevice::memory_bytes() const { return static_cast<size_t>(std::max<int64_t>(0, bytes_.load())); }

void EmbreeDevice::on_error(void* self, RTCError code, const char* text) {
  auto& device = *static_cast<EmbreeDevice*>(self);
  const std::lock_guard lock(device.mutex_);
  if (!device.error_.empty()) return;
  device.out_of_memory_ = code == RTC_ERROR_OUT_OF_MEMORY;
  device.error_ = "error " + std::to_string(code);
  if (text && *text) device.error_ += std::string(": ") + text;
}

bool EmbreeDevice::on_memory(void* self, ssize_t bytes, bool) {
  static_cast<EmbreeDevice*>(self)->bytes_ += bytes;
  return true;
}

}  // namespace kairos
