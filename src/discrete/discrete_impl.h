// What is behind DiscreteScene: Embree's scenes, and how they are built (discrete_build.cpp) and asked
// (discrete_rays.cpp).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "discrete/discrete_scene.h"
#include "discrete/embree_device.h"
#include "discrete/placed_object.h"
#include "discrete/uneven_triangles.h"
#include "discrete/uniform_runs.h"

namespace kairos {

/// Geometry that is there in one stretch of the shutter, which is Embree's time from 0 to 1. Embree knows time ranges
/// of geometries too, but where they differ within one scene its version 3.13 loses triangles.
struct DiscreteWindow {
  float begin = 0, end = 1;
  bool moves = false;
  EmbreeScene scene;

  bool is_in(DiscreteLayer layer) const { return layer == DiscreteLayer::all || !moves; }
  bool holds(float time) const { return begin <= time && (time < end || end == 1); }
  float local(float time) const { return std::min((time - begin) / (end - begin), 1.0f); }
};

/// True where the side on which the vertices run counter-clockwise faces the ray's origin.
inline bool faces_ray(Vec3f normal, Vec3f direction) { return dot(to_double(normal), to_double(direction)) < 0; }

struct DiscreteScene::Impl {
  // In this order: scenes are gone before the device is.
  EmbreeDevice device;
  std::vector<DiscreteWindow> windows;  // what stays still comes first, if there is any
  std::vector<uint32_t> mesh_of;        // [Embree's geometry number]; one numbering for all scenes but those of objects
  std::vector<PlacedObject> placed;     // likewise; empty where nothing is an instance
  struct Object {
    const Mesh* mesh;
    bool one_sided, has_holes, is_pane;
    friend bool operator<(const Object& a, const Object& b) {
      return std::tie(a.mesh, a.one_sided, a.has_holes, a.is_pane) <
             std::tie(b.mesh, b.one_sided, b.has_holes, b.is_pane);
    }
  };
  std::map<Object, EmbreeScene> objects;
  std::vector<std::unique_ptr<const UnevenTriangles>> uneven;
  DiscreteStats stats;
  std::shared_ptr<const CutOuts> cut_outs;
  std::vector<bool> panes;  // [mesh]
  int exponent = 0;         // of the size of all of this: see working_exponent

  Impl(std::span<const Mesh> meshes, const DiscreteOptions& options);

  /// Denormals must be zero already, for both.
  std::optional<DiscreteHit> intersect(const Ray& ray, float time, float max_dist, Facing facing) const;
  bool occluded(const Ray& ray, float time, float max_dist, DiscreteLayer layer) const;
  void intersect_all(std::span<const Ray> rays, std::span<const float> times,
                     std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const;
  void occluded_all(std::span<const Ray> rays, std::span<const float> times, std::span<const float> max_dists,
                    std::span<bool> result, DiscreteLayer layer) const;

  uint32_t mesh_of_hit(unsigned geometry, unsigned instance) const {
    return mesh_of[instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance];
  }
  /// The normal of a hit, in the space of the ray, at a time within its scene's window.
  Vec3f normal_of_hit(Vec3f normal, unsigned instance, float time) const {
    return instance == RTC_INVALID_GEOMETRY_ID ? normal : placed[instance].normal(normal, time);
  }

 private:
  void add_window(float begin, float end, bool moves, const DiscreteOptions& options);
  EmbreeScene new_scene(const DiscreteOptions& options);
  /// What is said of a mesh's triangles wherever it lies.
  void set_refusals(RTCGeometry geometry, const Object& object);
  /// The object of an instance, in a scene of its own. Instances whose surfaces are refused in other ways have another.
  RTCScene scene_of(const Object& object, const DiscreteOptions& options);
  /// The next number of a geometry in the windows' scenes.
  unsigned number_for(uint32_t mesh, PlacedObject where);
  void attach_instance(const DiscreteWindow& window, const Mesh& mesh, UniformRun run, size_t parts, uint32_t index,
                       const DiscreteOptions& options);
  /// parts: pieces that each key span is cut into.
  void attach(const DiscreteWindow& window, const Mesh& mesh, UniformRun run, size_t parts, uint32_t index,
              const DiscreteOptions& options);
  void attach_uneven(const DiscreteWindow& window, const Mesh& mesh, uint32_t index, int least_steps);

  /// Embree asks before it takes a hit for one: refuses those on sides that are not there, and on what is missing.
  template <bool kOneSided, bool kHasHoles>
  static void refuse_hits(const RTCFilterFunctionNArguments* hits);
  // Up to Packet::kSize rays; denormals must be zero already.
  template <class Packet>
  void intersect_packet(std::span<const Ray> rays, std::span<const float> times,
                        std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const;
  template <class Packet>
  void occluded_packet(std::span<const Ray> rays, std::span<const float> times, std::span<const float> max_dists,
                       std::span<bool> result, DiscreteLayer layer) const;
};

}  // namespace kairos
