// Shadows exact in time, where surface, light and camera rest.
#pragma once

#include <cstdint>
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

/// What resting lights bring to resting points: constant from step to step. Points beside each other are looked at
/// together: their rays to one light far away are parallel, and go in packets. One thread's scratch memory.
class RestingLightSteps {
 public:
  struct Step {
    float end;    ///< shutter time; it begins where the one before ends
    Vec3f light;  ///< radiance to the viewer
  };

  /// Forgets all points.
  void clear();
  /// Adds the point that a ray sees of a mesh that `shadows` are on.
  void add(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle);
  /// Adds one with all the light that leaves it with the query's key, its own with it. False: that is more than light
  /// of resting lights, and no point is added. base: see Shader::steady_light; its colour is in the steps.
  bool add_with_all(const ExactShadows& shadows, ShadingQuery query, Shade& base);
  /// Finds the steps of all points, over all of the window.
  void look(const ExactShadows& shadows, const TimeRange& window);
  /// All of it for one point.
  void look(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle, const TimeRange& window) {
    clear();
    add(shadows, ray, mesh, triangle);
    look(shadows, window);
  }

  size_t points() const { return points_.size(); }
  /// Of a point, by the order in which they were added. They cover the window; at least one.
  std::span<const Step> steps(size_t point = 0) const {
    const uint32_t first = point == 0 ? 0 : points_[point - 1].end_of_steps;
    return std::span(steps_).subspan(first, points_[point].end_of_steps - first);
  }
  /// What the lights bring to it if nothing hides them but what stands still; radiance to the viewer.
  Vec3f unhidden(size_t point = 0) const { return points_[point].unhidden; }
  /// Lights that bring anything to it where nothing that stands still hides them.
  size_t lights(size_t point = 0) const { return points_[point].lights; }
  /// Does anything that moves pass before a light of any point?
  bool changes() const { return !changes_.empty(); }
  TraceCounters counters() const { return workspace_.counters(); }

 private:
  struct Point {
    Vec3f own;     // what it sends in any light
    double width;  // of the cone of the ray that sees it
    Vec3f unhidden{};
    uint32_t lights = 0, end_of_steps = 0;
  };
  /// A light and a point, joined.
  struct Link {
    uint32_t point;
    RestingLight light;
    bool done = false, hidden = false;
  };
  struct Change {
    uint32_t point;
    float time;
    uint32_t link;
    bool hides;
  };

  void add_point(Vec3f own, double width);
  bool go_together(const Link& a, const Link& b) const;
  /// Of links whose rays go together: which are hidden by what stands still, and when the others are by what moves.
  void trace(const ExactShadows& shadows, std::span<const uint32_t> links, const TimeRange& window);
  void make_steps(const TimeRange& window);

  Tracer::Workspace workspace_;
  std::vector<RestingLight> found_;
  std::vector<Point> points_;
  std::vector<Link> links_;  // in order of points
  std::vector<Change> changes_;
  std::vector<Step> steps_;  // point by point
};

}  // namespace kairos
