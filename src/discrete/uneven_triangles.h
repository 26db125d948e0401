// Triangles whose motion keys lie at times of their own: Embree sorts their moving boxes and asks here for hits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <embree3/rtcore.h>

#include <kairos/mesh.h>
#include <kairos/tracer.h>

#include "discrete/discrete_scene.h"

namespace kairos {

/// What Embree hands through to the functions that it calls back.
struct DiscreteContext {
  RTCIntersectContext embree;  // first, so that a pointer to it is one to the whole
  const Ray* rays;             // [number of the ray]
  const float* times;
  Facing facing;
};

/// One moving mesh as Embree's user geometry. Embree takes only evenly spaced time steps; their boxes are widened by
/// what the motion between them strays from a straight line, and the triangle itself is interpolated at the ray's own
/// time. All such meshes fit into one Embree scene, whatever their key times, so that a ray meets those that it passes.
/// To Embree, two triangles that follow on each other in the mesh and lie together are one thing: that is half the
/// tree.
///
/// Not to be moved once Embree knows of it.
class UnevenTriangles {
 public:
  /// mesh: valid and moving; copied. index: what hits call it. cut_outs: null, or outlives this. least_steps: of time,
  /// between which boxes move straight; there are at most kMaxTimeSteps.
  /// is_pane: lets light through, and so occludes nothing.
  UnevenTriangles(const Mesh& mesh, uint32_t index, const CutOuts* cut_outs, int least_steps, bool is_pane);

  /// Into a geometry of the type RTC_GEOMETRY_TYPE_USER, before it is committed. Rays must come with a DiscreteContext.
  void fill(RTCGeometry geometry) const;
  uint32_t steps() const { return steps_; }
  size_t memory_bytes() const;

 private:
  struct Box {
    Vec3d low, high;
  };
  using Corners = std::array<Vec3d, 3>;

  /// The key at or before an instant, and the weight of the one that follows.
  struct Place {
    size_t key;
    double weight;
  };
  Place place_of(float time) const;
  Corners corners_at(const Triangle& triangle, Place place) const;
  void pair_triangles();
  /// The triangles of one of Embree's primitives: from the first of them to the first of the next.
  uint32_t first_of(uint32_t primitive) const { return first_of_[primitive]; }
  /// Where the triangle is at an instant, before a jump and after it.
  Box box_at(const Triangle& triangle, double time) const;
  RTCBounds bounds(const Triangle& triangle, uint32_t step) const;
  double time_of(uint32_t step) const { return static_cast<double>(step) / (steps_ - 1); }

  static void bounds_function(const RTCBoundsFunctionArguments* args);
  static void intersect_function(const RTCIntersectFunctionNArguments* args);
  static void occluded_function(const RTCOccludedFunctionNArguments* args);
  static void occluded_by_none(const RTCOccludedFunctionNArguments* /*args*/) {}
  struct Hit {
    double dist, u, v;
    Vec3d normal;
  };
  /// Does the ray meet the triangle nearer than `nearest`, on a side that is there, and where it is not cut out?
  /// place: that of the ray's time.
  bool meets(uint32_t triangle, const DiscreteContext& context, unsigned ray, Place place, float nearest,
             Hit& hit) const;
  static bool intersect(const Corners& corners, const Ray& ray, Hit& hit);

  std::vector<Triangle> triangles_;
  std::vector<uint32_t> first_of_;  // [primitive], and one behind the last
  std::vector<float> key_times_;
  std::vector<Vec3f> positions_;  // [vertex][key], so that what a ray needs lies close together
  uint32_t index_, steps_;
  const CutOuts* cut_outs_;
  bool one_sided_, is_pane_;
};

}  // namespace kairos
