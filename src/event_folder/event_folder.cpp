#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <kairos/error.h>
#include <kairos/event_folder.h>
#include <kairos/flow.h>
#include <kairos/picture.h>

#include "event_folder/folder_layout.h"

namespace kairos {

namespace {

/// Pixels: of pictures and flow, whose keys need not be those by which stamps are exact to a microsecond.
constexpr double kMotionTolerance = 0.1;

int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

void check(const EventFolderOptions& options) {
  const auto need = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorCode::bad_usage, "", what);
  };
  constexpr double kMostRate = 1e6;
  need(options.frame_rate > 0 && options.frame_rate <= kMostRate, "pictures must be above 0 and at most 1e6 a second");
  need(options.pose_rate > 0 && options.pose_rate <= kMostRate, "poses must be above 0 and at most 1e6 a second");
  need(options.exposure >= 0 && options.exposure <= 60, "pictures must be exposed for 0 to 60 seconds");
  need(options.samples >= 1 && options.samples <= 1 << 20, "samples of pictures must be 1 to 2^20 a pixel");
}

/// What the scene shows while the shutter is open, in scene time.
Shot shot_between(const Scene& scene, const EventOptions& recording, double open, double close, double tolerance) {
  ShotOptions options = recording.shot;
  options.space = ShotOptions::Space::camera;
  options.frame = 0;
  options.fps = 1;  // so that times are seconds
  options.shutter = std::array<double, 2>{open, close};
  options.motion_tolerance = tolerance;
  Shot shot = make_shot(scene, options);
  if (recording.change_shot) recording.change_shot(shot);
  return shot;
}

std::unique_ptr<FolderLayout> make_layout(EventLayout kind, const FolderPlan& plan) {
  switch (kind) {
    case EventLayout::rpg:
      return make_rpg_layout(plan);
    case EventLayout::dsec:
      return make_dsec_layout(plan);
    case EventLayout::evimo2:
      return make_evimo2_layout(plan);
    case EventLayout::eventnerf:
      break;
  }
  return make_eventnerf_layout(plan);
}

/// What the file of events in the folder is told.
EventFileOptions file_of(const EventFolderOptions& options, const EventOptions& recording) {
  EventFileOptions file;
  file.epoch = options.epoch;
  file.duration = nanoseconds(recording.to - recording.from);
  file.kinds = options.layout == EventLayout::eventnerf && has_kinds(recording);
  file.labels = recording.labels && keeps_labels(options.layout);
  return file;
}

}  // namespace

class EventFolder::Maker {
 public:
  Maker(const std::string& path, const EventFolderOptions& options, const Scene& scene, const EventOptions& recording)
      : options_(options), scene_(scene), recording_(recording) {
    check(options);
    // Of the camera alone, which turns as exactly whatever the meshes' keys are.
    ShotOptions whole = recording.shot;
    whole.textures = false;
    EventOptions of_camera = recording;
    of_camera.shot = whole;
    camera_ = shot_between(scene, of_camera, recording.from, recording.to, 1e9);
    const size_t meshes = camera_.meshes.size();
    camera_.meshes.clear();
    const auto lens = intrinsics(camera_.projection);
    if (!lens)
      throw Error(ErrorCode::bad_usage, path,
                  "data sets are of pinhole cameras; choose another --camera, or no --layout");
    WriteOptions view;
    view.exposure = -std::log2(recording.sensor.white);
    layout_ = make_layout(options.layout, {path, camera_.projection.width, camera_.projection.height, *lens, meshes,
                                           file_of(options, recording), view, options.exr});
  }

  void add(std::span<const Event> events, std::span<const EventLabel> labels) {
    if (!events.empty()) last_ = events.back().time;
    if (labels.empty())
      layout_->events().add(events);
    else
      layout_->events().add_labelled(events, labels);
  }

  void finish(const Progress& progress) {
    layout_->finish_events();
    const std::vector<double> times = moments();
    for (size_t i = 0; i < times.size(); ++i) {
      const auto part = [&](double fraction) {
        return !progress || progress((static_cast<double>(i) + fraction) / static_cast<double>(times.size()));
      };
      add_moment(times, i, part);
    }
    const auto poses = static_cast<int64_t>(std::floor(length() * options_.pose_rate * (1 + 1e-12)));
    for (int64_t i = 0; i <= poses; ++i) {
      const double time = std::min(static_cast<double>(i) / options_.pose_rate, length());
      layout_->add_pose(nanoseconds(time), camera_pose(camera_, recording_.from + time, CameraAxis::plus_z));
    }
    layout_->finish();
  }

 private:
  double length() const { return recording_.to - recording_.from; }

  /// Seconds from the recording's begin: the middles of exposures, which lie within it.
  std::vector<double> moments() const {
    std::vector<double> times;
    if (layout_->spans_events()) {
      const double end = last_ ? static_cast<double>(*last_) * 1e-9 : length();
      const double steps = std::max(std::round(end * options_.frame_rate), 1.0);
      for (double i = 0; i <= steps; ++i) times.push_back(end * i / steps);
      return times;
    }
    const double half = options_.exposure / 2;
    for (double i = 0;; ++i) {
      const double time = half + i / options_.frame_rate;
      if (time + half > length() * (1 + 1e-12) && i > 0) return times;
      times.push_back(std::min(time, length()));
    }
  }

  void add_moment(const std::vector<double>& times, size_t index, const Progress& progress) {
    const double time = times[index], half = options_.exposure / 2, scene_time = recording_.from + time;
    RenderParams params = recording_.render;
    params.spp = options_.samples;
    params.exposure.reset();
    params.filter = FilterKind::box;
    params.crop.reset();
    // Of the sharp one; the blurred one takes most of the time.
    params.integrator = IntegratorKind::qmc;
    params.aovs = {Aov::mesh};
    const Image sharp = render(scene_time, scene_time, params, [&](double part) { return progress(0.2 * part); });
    params.aovs.clear();
    params.integrator = IntegratorKind::automatic;
    std::optional<Image> blurred;
    if (half > 0)
      blurred =
          render(scene_time - half, scene_time + half, params, [&](double part) { return progress(0.2 + 0.8 * part); });
    const bool is_last = index + 1 == times.size();
    const double next = is_last ? time + 1 / options_.frame_rate : times[index + 1];
    const Image flow_image = flow_between(scene_time, recording_.from + next, progress);
    layout_->add({static_cast<int>(index), nanoseconds(time), nanoseconds(time - half), nanoseconds(time + half),
                  camera_pose(camera_, scene_time, CameraAxis::plus_z),
                  camera_matrix(camera_, scene_time, CameraAxis::plus_z), sharp, blurred ? &*blurred : nullptr,
                  flow_image, is_last ? nullptr : &flow_image, nanoseconds(next)});
  }

  Image render(double open, double close, const RenderParams& params, const Progress& progress) const {
    const Shot shot = shot_between(scene_, recording_, open, close, kMotionTolerance);
    Picture picture(shot.projection, params);
    PixelConsumer* const consumer = &picture;
    Renderer(shot).render(params, {&consumer, 1}, nullptr, progress);
    return picture.take_shown();
  }

  Image flow_between(double from, double to, const Progress& progress) const {
    EventOptions untextured = recording_;
    untextured.shot.textures = false;
    FlowOptions flow_options;
    flow_options.threads = recording_.render.threads;
    flow_options.instruction_set = recording_.render.instruction_set;
    flow_options.progress = [&](double) { return progress(1); };
    return flow(shot_between(scene_, untextured, from, to, kMotionTolerance), flow_options);
  }

  EventFolderOptions options_;
  const Scene& scene_;
  EventOptions recording_;
  Shot camera_;  // over all of the recording, without meshes
  std::unique_ptr<FolderLayout> layout_;
  std::optional<int64_t> last_;  // nanoseconds: the last event
};

EventFolder::EventFolder(const std::string& path, const EventFolderOptions& options, const Scene& scene,
                         const EventOptions& recording)
    : maker_(std::make_unique<Maker>(path, options, scene, recording)) {}
EventFolder::~EventFolder() = default;

void EventFolder::add(std::span<const Event> events) { maker_->add(events, {}); }
void EventFolder::add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) {
  maker_->add(events, labels);
}
void EventFolder::finish(const Progress& progress) { maker_->finish(progress); }

}  // namespace kairos
