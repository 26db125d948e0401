// Event cameras: scenes as streams of events.
#include <kairos/event_file.h>
#include <kairos/event_folder.h>
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

/// The events as an array of this, whose memory is the list's.
py::dtype event_type() {
  const py::list names = py::cast(std::vector<std::string>{"t", "x", "y", "p", "kind"});
  const py::list formats = py::cast(std::vector<std::string>{"i8", "u2", "u2", "i1", "u1"});
  const py::list offsets = py::cast(std::vector<size_t>{offsetof(Event, time), offsetof(Event, x), offsetof(Event, y),
                                                        offsetof(Event, polarity), offsetof(Event, kind)});
  return {names, formats, offsets, sizeof(Event)};
}

py::dtype label_type() {
  py::list names, formats, offsets;
  const EventLabel label;
  label_fields(
      [&](const char* name, const auto& field) {
        names.append(name);
        formats.append(py::dtype::of<std::remove_cvref_t<decltype(field)>>());
        offsets.append(reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&label));
      },
      label);
  return {names, formats, offsets, sizeof(EventLabel)};
}

template <class Item>
py::array array_holding(const py::dtype& type, std::vector<Item> items) {
  auto held = std::make_unique<std::vector<Item>>(std::move(items));
  Item* data = held->data();
  const size_t count = held->size();
  return {type, {count}, {sizeof(Item)}, data, keeper(std::move(held))};
}

/// The events, and their labels or None.
py::tuple arrays_of(EventList&& list) {
  py::object labels = py::none();
  if (!list.labels.empty()) labels = array_holding(label_type(), std::move(list.labels));
  return py::make_tuple(array_holding(event_type(), std::move(list.events)), std::move(labels));
}

/// Hands events to a list, and to a folder where there is one.
class ListAndFolder : public EventList {
 public:
  explicit ListAndFolder(EventFolder* folder) : folder_(folder) {}
  void add(std::span<const Event> more) override {
    EventList::add(more);
    if (folder_ != nullptr) folder_->add(more);
  }
  void add_labelled(std::span<const Event> more, std::span<const EventLabel> of_them) override {
    EventList::add(more);
    labels.insert(labels.end(), of_them.begin(), of_them.end());
    if (folder_ != nullptr) folder_->add_labelled(more, of_them);
  }

 private:
  EventFolder* folder_;
};

/// A folder of a data set's layout, where one is wanted.
struct FolderWish {
  std::string path;
  EventFolderOptions options;
};
std::optional<FolderWish> read_folder(const py::object& value) {
  if (value.is_none()) return std::nullopt;
  FolderWish wish;
  Reader reader("record_events", value.cast<py::dict>());
  reader("folder", wish.path);
  reader("layout", wish.options.layout);
  reader("frame_rate", wish.options.frame_rate);
  reader("frame_exposure", wish.options.exposure);
  reader("frame_samples", wish.options.samples);
  reader("pose_rate", wish.options.pose_rate);
  reader.finish();
  return wish;
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
  reader("labels", options.labels);
  auto folder_wish = read_folder(reader.take("folder"));
  reader.finish();
  if (size) {
    options.shot.width = (*size)[0];
    options.shot.height = (*size)[1];
  }
  options.shot.threads = options.render.threads;
  if (!is_lit(options.render.shading) && options.shot.lights == LightChoice::automatic)
    options.shot.lights = LightChoice::file;  // without light a studio would only be a background
  const Progress progress = progress_of(std::move(callback));
  EventStats stats;
  EventList list;
  {
    const py::gil_scoped_release unlocked;
    std::optional<EventFolder> folder;
    if (folder_wish) {
      folder.emplace(folder_wish->path, folder_wish->options, *held.scene, options);
    }
    ListAndFolder sink(folder ? &*folder : nullptr);
    stats = record_events(*held.scene, options, sink, progress);
    if (folder) {
      folder->finish(progress);
      write_event_notes(folder_wish->path + "/recording.json", options, stats, "kairos.record_events");
    }
    list = std::move(sink);
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
  return py::make_tuple(arrays_of(std::move(list)), py::make_tuple(stats.width, stats.height), f.values, stats.meshes);
}

/// The library's items of an array of its own kind.
template <class Item>
std::span<const Item> items_of(const char* name, const py::dtype& type, const py::array& array) {
  if (array.ndim() != 1 || !array.dtype().equal(type)) refuse(name, "is no such array as Events has");
  if (array.size() > 1 && array.strides(0) != sizeof(Item)) refuse(name, "is not contiguous; copy it");
  return {static_cast<const Item*>(array.data()), static_cast<size_t>(array.size())};
}

void write_stream(const py::array& array, const std::optional<py::array>& label_array, std::array<int, 2> size,
                  const std::string& path, const py::dict& values) {
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
  const auto events = items_of<Event>("events", event_type(), array);
  std::span<const EventLabel> labels;
  if (label_array) labels = items_of<EventLabel>("labels", label_type(), *label_array);
  options.labels = label_array && holds_labels(path);
  if (label_array && labels.size() != events.size()) refuse("labels", "are not as many as events");
  for (size_t i = 0; i < events.size(); ++i)
    if (events[i].time < 0 || events[i].x >= size[0] || events[i].y >= size[1] ||
        (i > 0 && events[i].time < events[i - 1].time))
      refuse("events", "event " + std::to_string(i) + " lies outside of the sensor, or is earlier than the one before");
  if (!events.empty()) options.duration = events.back().time + 1;
  const py::gil_scoped_release unlocked;
  EventFileWriter file(path, size[0], size[1], options);
  if (options.labels)
    file.add_labelled(events, labels);
  else
    file.add(events);
  file.finish();
}

py::tuple read_file(const std::string& path) {
  EventList list;
  EventFileFacts facts;
  {
    const py::gil_scoped_release unlocked;
    facts = read_events(path, list);
  }
  return py::make_tuple(arrays_of(std::move(list)), py::make_tuple(facts.width, facts.height));
}

}  // namespace

void bind_events(py::module_& module) {
  module.def("sensor_preset", &sensor_preset);
  module.def("events", &events);
  module.def("write_events", &write_stream);
  module.def("read_events", &read_file);
}

}  // namespace kairos::python
