// A shot as Python holds it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include <kairos/render.h>
#include <kairos/scene.h>
#include <kairos/shutter.h>

#include "convert.h"

namespace kairos::python {

/// Immutable but for what is made when it is first needed. Shared by all that is made of it.
class HeldShot {
 public:
  HeldShot(std::shared_ptr<const Scene> scene, ShotOptions options, std::optional<Vec3f> backdrop, bool transparent,
           std::optional<Shutter> shutter);
  /// Of no scene: where things are alone.
  HeldShot(Shot shot, double frame_time, double fps)
      : transparent_(false), frame_time_(frame_time), fps_(fps), shot_(std::move(shot)) {}

  const Shot& shot() const { return shot_; }
  /// What a shading shows: without light a studio that was lent would only be a background.
  const Shot& shot_for(ShadingKind shading) const;
  const ShotOptions& options() const { return options_; }
  bool transparent() const { return transparent_; }
  std::optional<Exposure> exposure() const;
  double frame_time() const { return frame_time_; }
  double fps() const { return fps_; }

 private:
  Shot make(const ShotOptions& options) const;

  std::shared_ptr<const Scene> scene_;  // or null
  ShotOptions options_;
  std::optional<Vec3f> backdrop_;
  bool transparent_;
  std::optional<Shutter> shutter_;
  double frame_time_ = 0, fps_ = 24;
  Shot shot_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const Shot> unlit_;
};

/// Of an object of the Python class.
Shutter shutter_from(py::handle shutter);

/// What asks Python whether to go on: whether a signal has come, and what `callback`, a function or None, says. To be
/// called without Python's lock.
Progress progress_of(py::object callback);

}  // namespace kairos::python
