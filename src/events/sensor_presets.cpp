#include <array>
#include <utility>

#include <kairos/events.h>

namespace kairos {

namespace {

/// Thresholds and faults as the simulators that they are named after have them by default; what those do per frame
/// happens in continuous time here.
EventSensor v2e_sensor(double mismatch, double cutoff, double leak, double shot, double refractory) {
  EventSensor sensor;
  sensor.mismatch = mismatch;
  sensor.cutoff = cutoff;
  sensor.leak = leak;
  sensor.shot_noise = shot;
  sensor.refractory = refractory;
  sensor.leak_jitter = sensor.leak_spread = leak > 0 ? 0.1 : 0;
  return sensor;
}

EventSensor dropping_sensor(double threshold, double mismatch, double dark) {
  EventSensor sensor;
  sensor.on = sensor.off = threshold;
  sensor.mismatch = mismatch;
  sensor.dark = dark;
  sensor.refractory_mode = Refractory::drop;
  return sensor;
}

EventSensor metavision_sensor() {
  EventSensor sensor = dropping_sensor(0.2, 0.05, 1e-5);
  sensor.cutoff = 70;
  sensor.leak = 0.1;
  sensor.shot_noise = 10;
  return sensor;
}

const std::array<std::pair<const char*, EventSensor>, 7>& presets() {
  static const std::array<std::pair<const char*, EventSensor>, 7> all{{
      {"ideal", {}},
      {"v2e", v2e_sensor(0.03, 300, 0.01, 0.001, 0.0005)},
      {"v2e-clean", v2e_sensor(0.02, 0, 0, 0, 0)},
      {"v2e-noisy", v2e_sensor(0.05, 30, 0.1, 5, 0)},
      {"esim", dropping_sensor(0.5, 0.021, 1e-3)},
      {"vid2e", dropping_sensor(0.2, 0, 1e-5)},
      {"metavision", metavision_sensor()},
  }};
  return all;
}

}  // namespace

std::optional<EventSensor> event_sensor(const std::string& preset) {
  for (const auto& [name, sensor] : presets())
    if (preset == name) return sensor;
  return std::nullopt;
}

std::string event_sensor_names() {
  std::string names;
  for (const auto& [name, sensor] : presets()) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

}  // namespace kairos
