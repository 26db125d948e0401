#include "event_io/sensor_file.h"

#include <set>

#include <kairos/event_file.h>
#include <kairos/names.h>
#include <kairos/printable.h>

#include "base/file.h"
#include "scene_io/json_node.h"
#include "scene_io/json_text.h"

namespace kairos {

namespace {

/// visit(name, value) with all of them.
template <class Sensor, class Visit>
void each_parameter(Sensor& sensor, const Visit& visit) {
  visit("on", sensor.on);
  visit("off", sensor.off);
  visit("mismatch", sensor.mismatch);
  visit("white", sensor.white);
  visit("dark", sensor.dark);
  visit("refractory_s", sensor.refractory);
  visit("refractory_mode", sensor.refractory_mode);
  visit("cutoff_hz", sensor.cutoff);
  visit("leak_hz", sensor.leak);
  visit("leak_spread", sensor.leak_spread);
  visit("leak_jitter", sensor.leak_jitter);
  visit("shot_noise_hz", sensor.shot_noise);
  visit("random_level", sensor.random_level);
  visit("bayer", sensor.bayer);
}

struct Put {
  nlohmann::ordered_json& json;

  template <class Value>
  void operator()(const char* name, const Value& value) const {
    json[name] = value;
  }
  void operator()(const char* name, const Refractory& mode) const { json[name] = std::string(to_string(mode)); }
};

void take(const JsonNode& node, double& out) { out = node.number(); }
void take(const JsonNode& node, bool& out) { out = node.boolean(); }
void take(const JsonNode& node, std::string& out) { out = node.string(); }
void take(const JsonNode& node, Refractory& out) {
  const std::string name = node.string();
  for (const auto& [known, mode] : kNames<Refractory>)
    if (known == name) return void(out = mode);
  node.fail("unknown mode '" + printable(name) + "'; expected hold, drop or resample");
}

}  // namespace

nlohmann::ordered_json sensor_json(const EventSensor& sensor) {
  nlohmann::ordered_json json;
  each_parameter(sensor, Put{json});
  return json;
}

EventSensor read_event_sensor(const std::string& path) {
  constexpr uint64_t kMostDescription = 16 << 20;
  const std::vector<uint8_t> bytes = read_file(path, kMostDescription);
  const JsonText text(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), path);
  JsonNode node(text.root(), path);
  if (!node.is_object()) node.fail("is no sensor: an object of its parameters, or a recording's description");
  const bool beside_recording = text.root().contains("sensor");
  const JsonNode parameters = beside_recording ? node.at("sensor") : node;
  EventSensor sensor;
  std::set<std::string> known;
  each_parameter(sensor, [&](const char* name, auto& value) {
    known.insert(name);
    if (const auto given = parameters.find(name)) take(*given, value);
  });
  for (const auto& [name, value] : parameters.fields())
    if (known.count(name) == 0) value.fail("is no parameter of a sensor");
  return sensor;
}

}  // namespace kairos
