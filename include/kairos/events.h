// Event cameras: an animated scene as the stream of events that a sensor gives, with exact time stamps. docs/events.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/names.h>
#include <kairos/render.h>
#include <kairos/scene.h>

namespace kairos {

/// Why a pixel fired.
enum class EventKind : uint8_t {
  signal,  ///< what it sees became brighter or darker
  leak,    ///< its level leaked away
  shot,    ///< shot noise
};

/// A pixel says that what it sees has become brighter, or darker, by its threshold.
struct Event {
  int64_t time = 0;       ///< nanoseconds from the recording's begin
  uint16_t x = 0, y = 0;  ///< (0, 0) is the upper left corner
  int8_t polarity = 1;    ///< 1: brighter; -1: darker
  EventKind kind = EventKind::signal;

  /// The order of a stream: time, then y, then x. A pixel's own events differ in time.
  friend bool operator<(const Event& a, const Event& b) {
    return a.time != b.time ? a.time < b.time : a.y != b.y ? a.y < b.y : a.x < b.x;
  }
  friend bool operator==(const Event&, const Event&) = default;
};

/// What made a pixel fire. Meshes are numbered from 1 in their order in the shot, as in the AOV `mesh`; 0: none.
struct EventLabel {
  uint32_t surface =
      0;                ///< of an edge: the surface whose edge it is, the nearer one; else the one whose colour changes
  uint32_t behind = 0;  ///< of an edge: what it hides, or sets free; else the same as `surface`
  float depth = std::numeric_limits<float>::infinity();  ///< of `surface`, along the view axis, in the scene's units
  std::array<float, 2> flow{};                           ///< of its material, pixels a second, right and down
  bool edge = false;  ///< another surface is seen, or the same one where it hides itself; else: colours change

  friend bool operator==(const EventLabel&, const EventLabel&) = default;
};

/// Names what a label says as files and Python do: field(name, member) for each, in order. Label: EventLabel, const or
/// not.
template <class Field, class Label>
void label_fields(Field&& field, Label& label) {
  field("surface", label.surface);
  field("behind", label.behind);
  field("depth", label.depth);
  field("flow_x", label.flow[0]);
  field("flow_y", label.flow[1]);
  field("edge", label.edge);
}

/// What a pixel does for a while after an event.
enum class Refractory {
  hold,      ///< its level stays as it is: what has changed meanwhile fires when the while is over
  drop,      ///< it goes on, and what it would say is lost
  resample,  ///< it is blind, and takes what it sees when the while is over as its new level
};

/// What a pixel makes of the light that it gets: it compares ln(light / white + dark) with the level at which it fired
/// last. Light is luminance (Rec. 709), or one channel under a Bayer pattern. Everything but the thresholds is off by
/// default: an ideal sensor. The parameters are those of v2e (Y. Hu, S.-C. Liu, T. Delbruck 2021), in continuous time.
struct EventSensor {
  double on = 0.2, off = 0.2;  ///< thresholds, in units of the logarithm; 0.001 to 100
  double mismatch = 0;         ///< standard deviation of each pixel's thresholds; none is below 0.01
  double white = 1;            ///< light that counts as 1; above 0
  double dark = 1.0 / 255;     ///< what is added to it: the light below which a pixel sees little; above 0
  double refractory = 0;       ///< seconds; 0 or more
  Refractory refractory_mode = Refractory::hold;
  double cutoff = 0;       ///< Hz, of the photoreceptor in light of 1: a low pass that is slower in the dark; 0: none
  double leak = 0;         ///< Hz, of the events that leaking gives where nothing changes; 0: none
  double leak_spread = 0;  ///< standard deviation of log10 of each pixel's leak
  double leak_jitter = 0;  ///< relative standard deviation of the leak from event to event
  double shot_noise = 0;   ///< Hz, of both polarities together, in the dark; a quarter of it in light of 1; 0: none
  bool random_level = false;  ///< pixels begin anywhere between their thresholds, not at what they see
  std::string bayer;          ///< empty, or which channel the upper left 2x2 pixels get, row by row: "RGGB", ...

  friend bool operator==(const EventSensor&, const EventSensor&) = default;
};

/// "ideal", "v2e", "v2e-clean", "v2e-noisy", "esim", "vid2e" or "metavision"; unset for another name.
KAIROS_API std::optional<EventSensor> event_sensor(const std::string& preset);
/// The names of all presets, separated by commas.
KAIROS_API std::string event_sensor_names();

/// How a pixel's light is made of the rays' that stand for it.
enum class EdgeModel {
  area,  ///< when an edge passes a ray, the ray's part of the pixel is covered as the moving edge covers it
  step,  ///< each ray jumps when an edge passes it
};

struct EventOptions {
  double from = 0, to = 1;  ///< scene time, seconds: of the recording
  ShotOptions shot;         ///< of the scene: its times are not used
  /// What it is shaded with: shading, max_depth, seed, threads, instruction_set. All else is not used.
  RenderParams render;
  int rays = 4;  ///< per pixel: 1, 4, 16, 64 or 256, at points that stay for all of the recording
  EdgeModel edges = EdgeModel::area;
  EventSensor sensor;
  int looks = 64;  ///< how often in a second colours are looked at, at least: 2 to 65536
  /// Seconds that are rendered at once, at multiples of it: memory and, by rounding, the stream's last bits depend on
  /// it.
  double chunk = 0.5;
  std::optional<Crop> crop;  ///< the pixels that are recorded: their events are those of a recording of all
  bool labels = false;       ///< tells the sink what made each pixel fire: EventSink::add_labelled
  /// Goes on where a recording of the same scene with the same options, on a machine of the same kind, was when it said
  /// this (EventSink::end_chunk): the sink gets what follows. Empty: from the beginning.
  std::vector<uint8_t> resume = {};
  /// Changes the shot of each chunk, before it is rendered.
  std::function<void(Shot&)> change_shot = {};
};

/// Need files tell signal and noise apart?
inline bool has_kinds(const EventOptions& options) {
  return options.labels || options.sensor.leak > 0 || options.sensor.shot_noise > 0;
}

/// Where a stream goes.
class KAIROS_API EventSink {
 public:
  virtual ~EventSink() = default;
  /// Called from one thread with what follows on all before, in the stream's order.
  virtual void add(std::span<const Event> events) = 0;
  /// In place of add() with EventOptions::labels. labels: [event].
  virtual void add_labelled(std::span<const Event> events, [[maybe_unused]] std::span<const EventLabel> labels) {
    add(events);
  }
  /// At the end of each chunk, when all of its events have been added. state: the bytes by which the recording can go
  /// on from here (EventOptions::resume).
  virtual void end_chunk([[maybe_unused]] const std::function<std::vector<uint8_t>()>& state) {}
};

/// Keeps a stream in memory.
class EventList : public EventSink {
 public:
  void add(std::span<const Event> more) override { events.insert(events.end(), more.begin(), more.end()); }
  void add_labelled(std::span<const Event> more, std::span<const EventLabel> of_them) override {
    add(more);
    labels.insert(labels.end(), of_them.begin(), of_them.end());
  }

  std::vector<Event> events;
  std::vector<EventLabel> labels;  ///< [event], or empty
};

/// Of a recording.
struct EventStats {
  int width = 0, height = 0;
  uint64_t on = 0, off = 0;     ///< events
  uint64_t leak = 0, shot = 0;  ///< of them
  uint64_t edges = 0;           ///< moving edges that passed a ray, and changed what it sees
  uint64_t steps = 0;           ///< changes without an edge that is known: taken as steps
  double fastest = 0;           ///< pixels a second: of the edges, across themselves
  uint64_t rays = 0, shading_samples = 0;
  double cpu_seconds = 0;           ///< processor time of the whole process
  std::vector<std::string> notes;   ///< one line each, of the shots
  std::vector<std::string> meshes;  ///< names of those that labels number; empty without labels
};

/// What the stamps of a recording may be off by, in pixels: divide by an edge's speed for seconds.
struct EventErrors {
  double motion = 0;  ///< straight motion between keys
  double area = 0;    ///< of an outline with a radius of 5 pixels (EdgeModel::area), or about the scatter of steps
};
KAIROS_API EventErrors event_errors(const EventOptions& options);

/// Records a scene. Events of the first instant are none: pixels begin at the level of what they see. The stream does
/// not depend on the number of threads. Throws Error(bad_usage) for options out of range, Error(bad_input) as make_shot
/// does, Error(cancelled) when `progress` says so, and what the sink throws.
KAIROS_API EventStats record_events(const Scene& scene, const EventOptions& options, EventSink& sink,
                                    const Progress& progress = {});

template <>
inline constexpr auto kNames<Refractory> = std::to_array<Named<Refractory>>({{"hold", Refractory::hold},
                                                                             {"drop", Refractory::drop},
                                                                             {"resample", Refractory::resample}});
template <>
inline constexpr auto kNames<EdgeModel> = std::to_array<Named<EdgeModel>>({{"area", EdgeModel::area},
                                                                           {"step", EdgeModel::step}});

}  // namespace kairos
