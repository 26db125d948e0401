// Event cameras: scenes as streams of events.
#include <kairos/event_file.h>
#include <kairos/events.h>

#include "bindings.h"
#include "held_scene.h"
#include "params.h"
#include "shot.h"

namespace kairos::python {

namespace {

template <class F, class S>
void sensor_fields(F& f, S& s) {
  f("on", s.on);
  f("off", s.off);
  f("mismatch", s.mismatch);
  f("white", s.white);
  f("dark", s.dark);
  f("refractory", s.refractory);
  f("refractory_mode", s.refractory_mode);
  f("cutoff", s.cutoff);
  f("leak", s.leak);
  f("leak_spread", s.leak_spread);
  f("leak_jitter", s.leak_jitter);
  f("shot_noise", s.shot_noise);
  f("random_level", s.random_level);
  f("bayer", s.bayer);
}

py::dict sensor_preset(const std::string& name) {
  const auto sensor = event_sensor(name);
  if (!sensor) refuse("sensor", "'" + name + "' is not one of: " + event_sensor_names());
  Writer writer;
  sensor_fields(writer, *sensor);
  return writer.values;
}

class Collector : public EventSink {
 public:
  void add(std::span<const Event> more) override { events.insert(events.end(), more.begin(), more.end()); }
  std::vector<Event> events;
};

/// The events as an array of this, whose memory is the collector's.
py::dtype event_type() {
  const py::list names = py::cast(std::vector<std::string>{"t", "x", "y", "p", "kind"});
  const py::list formats = py::cast(std::vector<std::string>{"i8", "u2", "u2", "i1", "u1"});
  const py::list offsets = py::cast(std::vector<size_t>{offsetof(Event, time), offsetof(Event, x), offsetof(Event, y),
                                                        offsetof(Event, polarity), offsetof(Event, kind)});
  return {names, formats, offsets, sizeof(Event)};
}

py::array array_of_events(std::unique_ptr<Collector> collected) {
  Event* data = collected->events.data();
  const size_t count = collected->events.size();
  return {event_type(), {count}, {sizeof(Event)}, data, keeper(std::move(collected))};
}

py::tuple events(const HeldScene& held, const py::dict& values, py::object callback) {
  EventOptions options;
  options.shot.lights = LightChoice::automatic;
  options.render.shading = ShadingKind::whitted;
  std::optional<std::array<int, 2>> size;
  Reader reader("", values);
  Reader sensor("sensor", py::dict(reader.take("sensor").attr("__dict__")));
  sensor_fields(sensor, options.sensor);
  sensor.finish();
  reader("from", options.from);
  reader("to", options.to);
  reader("rays", options.rays);
  reader("edges", options.edges);
  reader("looks", options.looks);
  reader("chunk", options.chunk);
  reader("camera", options.shot.camera);
  reader("motion_tolerance", options.shot.motion_tolerance);
  reader("lights", options.shot.lights);
  reader("shading", options.render.shading);
  reader("max_depth", options.render.max_depth);
  reader("seed", options.render.seed);
  reader("threads", options.render.threads);
  reader("size", size);
  reader.finish();
  if (size) {
    options.shot.width = (*size)[0];
    options.shot.height = (*size)[1];
  }
  options.shot.threads = options.render.threads;
  if (!is_lit(options.render.shading) && options.shot.lights == LightChoice::automatic)
    options.shot.lights = LightChoice::file;  // without light a studio would only be a background
  auto sink = std::make_unique<Collector>();
  const Progress progress = progress_of(std::move(callback));
  EventStats stats;
  {
    const py::gil_scoped_release unlocked;
    stats = record_events(*held.scene, options, *sink, progress);
  }
  Writer f;
  f("on", stats.on);
  f("off", stats.off);
  f("leak", stats.leak);
  f("shot", stats.shot);
  f("edges", stats.edges);
  f("steps", stats.steps);
  f("fastest", stats.fastest);
  f("rays", stats.rays);
  f("shading_samples", stats.shading_samples);
  f("cpu_seconds", stats.cpu_seconds);
  f.values["notes"] = stats.notes;
  return py::make_tuple(array_of_events(std::move(sink)), py::make_tuple(stats.width, stats.height), f.values);
}

/// The library's events of an array of its own kind.
std::span<const Event> events_of(const py::array& array) {
  if (array.ndim() != 1 || !array.dtype().equal(event_type()))
    refuse("events", "is no array of events, as Events.events is");
  if (array.size() > 1 && array.strides(0) != sizeof(Event)) refuse("events", "is not contiguous; copy it");
  return {static_cast<const Event*>(array.data()), static_cast<size_t>(array.size())};
}

void write_stream(const py::array& array, std::array<int, 2> size, const std::string& path, const py::dict& values) {
  EventFileOptions options;
  Reader reader("Events.write", values);
  std::string evt = "3";
  reader("evt", evt);
  if (evt == "2")
    options.evt = EventFileOptions::Evt::evt2;
  else if (evt == "2.1")
    options.evt = EventFileOptions::Evt::evt21;
  else if (evt != "3")
    refuse("evt", "'" + evt + "' is not one of: 2, 2.1, 3");
  reader("kinds", options.kinds);
  bool nanoseconds = false;
  reader("nanoseconds", nanoseconds);
  reader.finish();
  if (nanoseconds) options.time = EventFileOptions::Time::nanoseconds;
  const std::span<const Event> events = events_of(array);
  for (size_t i = 0; i < events.size(); ++i)
    if (events[i].time < 0 || events[i].x >= size[0] || events[i].y >= size[1] ||
        (i > 0 && events[i].time < events[i - 1].time))
      refuse("events", "event " + std::to_string(i) + " lies outside of the sensor, or is earlier than the one before");
  if (!events.empty()) options.duration = events.back().time + 1;
  const py::gil_scoped_release unlocked;
  EventFileWriter file(path, size[0], size[1], options);
  file.add(events);
  file.finish();
}

py::tuple read_file(const std::string& path) {
  auto sink = std::make_unique<Collector>();
  EventFileFacts facts;
  {
    const py::gil_scoped_release unlocked;
    facts = read_events(path, *sink);
  }
  return py::make_tuple(array_of_events(std::move(sink)), py::make_tuple(facts.width, facts.height));
}

}  // namespace

void bind_events(py::module_& module) {
  module.def("sensor_preset", &sensor_preset);
  module.def("events", &events);
  module.def("write_events", &write_stream);
  module.def("read_events", &read_file);
}

}  // namespace kairos::python
