// Shadows exact in time, where surface, light and camera rest.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <kairos/tracer.h>

#include "shading/shader.h"

namespace kairos {

/// A point that rests and a light that rests are joined by one ray while the shutter is open, so that a
/// time-continuous query tells when anything is in between. docs/method.md, "Shadows exact in time". Immutable.
class ExactShadows {
 public:
  /// tracer: of all the shot's meshes, as is the shader. receivers: [mesh], of Shader::resting_receivers(), on which
  /// shadows are found so.
  ExactShadows(const Shader& shader, const Tracer& tracer, std::vector<bool> receivers)
      : shader_(shader), tracer_(tracer), receivers_(std::move(receivers)) {}

  bool on(uint32_t mesh) const { return receivers_[mesh]; }
  const Shader& shader() const { return shader_; }
  const Tracer& tracer() const { return tracer_; }

 private:
  const Shader& shader_;
  const Tracer& tracer_;
  std::vector<bool> receivers_;
};

/// What resting lights bring to one resting point: constant from step to step. One thread's scratch memory.
class RestingLightSteps {
 public:
  struct Step {
    float end;    ///< shutter time; it begins where the one before ends
    Vec3f light;  ///< radiance to the viewer
  };

  /// Of the point that a ray sees of a mesh that `shadows` are on, over all of the window.
  void look(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle, const TimeRange& window);
  /// They cover the window; at least one.
  std::span<const Step> steps() const { return steps_; }

  size_t lights() const { return lights_.size(); }  ///< that bring anything where nothing hides them
  TraceCounters counters() const { return workspace_.counters(); }

 private:
  struct Change {
    float time;
    uint32_t light;
    bool hides;
  };

  Tracer::Workspace workspace_;
  std::vector<RestingLight> lights_;
  std::vector<Change> changes_;
  std::vector<bool> hidden_;  // [light]
  std::vector<Step> steps_;
};

}  // namespace kairos
