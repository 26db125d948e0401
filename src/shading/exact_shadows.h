// Shadows exact in time, where surface, light and camera rest.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <kairos/tracer.h>

#include "discrete/discrete_scene.h"
#include "shading/shader.h"

namespace kairos {

/// A point that rests and a light that rests are joined by one ray while the shutter is open, so that a
/// time-continuous query tells when anything is in between. docs/method.md, "Shadows exact in time". Immutable.
class ExactShadows {
 public:
  /// All of one shot. tracer: of the meshes that move, at least; scene: of all. receivers: [mesh], of
  /// Shader::resting_receivers(), on which shadows are found so.
  ExactShadows(const Shader& shader, const Tracer& tracer, const DiscreteScene& scene, std::vector<bool> receivers)
      : shader_(shader), tracer_(tracer), scene_(scene), receivers_(std::move(receivers)) {}

  bool on(uint32_t mesh) const { return receivers_[mesh]; }
  const Shader& shader() const { return shader_; }
  const Tracer& tracer() const { return tracer_; }
  const DiscreteScene& scene() const { return scene_; }

 private:
  const Shader& shader_;
  const Tracer& tracer_;
  const DiscreteScene& scene_;
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
  void look(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle, const TimeRange& window) {
    look_at_still(shadows, ray, mesh, triangle);
    look_at_motion(shadows, window);
  }
  /// The first half of it: what they bring if nothing hides them but what stands still; radiance to the viewer.
  Vec3f look_at_still(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle);
  /// And the second half, of the same point.
  void look_at_motion(const ExactShadows& shadows, const TimeRange& window);

  /// Of all the light that leaves the point with the query's key, its own with it. False: it is more than that of
  /// resting lights. base: see Shader::steady_light; its colour is in the steps.
  bool look_at_all(const ExactShadows& shadows, ShadingQuery query, const TimeRange& window, Shade& base);

  /// They cover the window; at least one.
  std::span<const Step> steps() const { return steps_; }
  /// Does anything that moves pass before a light?
  bool changes() const { return !changes_.empty(); }

  size_t lights() const { return lights_.size(); }  ///< that bring anything where nothing that stands still hides them
  TraceCounters counters() const { return workspace_.counters(); }

 private:
  /// Of lights_, those that what stands still hides.
  void drop_hidden_at_rest(const ExactShadows& shadows);

  struct Change {
    float time;
    uint32_t light;
    bool hides;
  };

  Tracer::Workspace workspace_;
  Vec3f own_;  // what the point sends in any light
  std::vector<RestingLight> lights_;
  std::vector<Change> changes_;
  std::vector<bool> hidden_;  // [light]
  std::vector<Step> steps_;
};

}  // namespace kairos
