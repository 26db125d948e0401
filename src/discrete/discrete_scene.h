// Discrete rays: the nearest triangle along a ray at one instant, by Embree. The only door to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <kairos/mesh.h>
#include <kairos/tracer.h>

namespace kairos {

struct DiscreteHit {
  float dist = 0;         ///< along the ray, in units of |direction|, > 0
  uint32_t mesh = 0;      ///< index into the meshes the scene was made of
  uint32_t triangle = 0;  ///< index into that mesh's triangles
  float u = 0, v = 0;     ///< barycentric: (1-u-v) p0 + u p1 + v p2
  bool front = false;     ///< as Segment::front
};

struct DiscreteOptions {
  /// Avoids that rays slip through between triangles. Rays aimed exactly at vertices may be lost all the same.
  bool robust = true;
  std::shared_ptr<const CutOuts> cut_outs = nullptr;  ///< null: all surfaces are whole
  /// Stretches of even motion get at least this many keys, as far as kMaxTimeSteps allow, by equal parts of each key
  /// span: more and tighter boxes for the same motion. 0: no more than there are.
  int keys = 0;
  std::vector<bool> panes = {};  ///< [mesh]: lets light through, so that occluded() passes it; missing: none does
  std::optional<InstructionSet> instruction_set = std::nullopt;  ///< of Embree's code; unset: the best one
};

/// Embree's code that goes with an instruction set of the kernels: the same, or its oldest for `scalar`; of none the
/// best one. Throws Error(bad_usage) where the machine lacks it.
InstructionSet embree_instruction_set(std::optional<InstructionSet> wanted);

/// Which meshes a ray is to see.
enum class DiscreteLayer {
  all,
  still,  ///< those with a single key: a good deal cheaper where others move
};

/// Whose front a one-sided triangle must turn to be met. A ray of sight comes to its origin; what a shadow ray looks
/// for is light that goes the other way, so that it meets fronts there, too.
enum class Facing {
  origin,   ///< sight
  far_end,  ///< light that comes along the ray to its origin
};

struct DiscreteStats {
  double build_seconds = 0;
  size_t static_geometries = 0, moving_geometries = 0;  ///< Embree's: a mesh may be several
  size_t moving_keys = 0;                               ///< given to Embree, over all of its moving geometries
  size_t trees = 0;      ///< what stays still; few sets of key times, one for each stretch of even keys; all other sets
  size_t triangles = 0;  ///< of all meshes, each counted once
};

/// The same meshes and motion keys as a Tracer's. What stays still has an Embree scene of its own, which makes rays a
/// good deal cheaper where little moves. So have meshes with the few sets of key times that most triangles share; all
/// others are in one, and a ray pays for those that it passes.
///
/// Immutable and safe to use from many threads at once. Copies what it needs of the meshes. While Embree runs in a
/// thread, denormals count as zero there, as it asks for; the thread's setting is put back afterwards.
class DiscreteScene {
 public:
  /// Throws Error(bad_input) when a mesh breaks an invariant or Embree fails.
  explicit DiscreteScene(std::span<const Mesh> meshes, const DiscreteOptions& options = {});
  ~DiscreteScene();
  DiscreteScene(DiscreteScene&&) noexcept;
  DiscreteScene& operator=(DiscreteScene&&) noexcept;

  /// The nearest hit at shutter time `time`, in [0, 1], no farther than `max_dist` along the ray. A ray that is not
  /// finite, or has no direction, meets nothing.
  std::optional<DiscreteHit> intersect(const Ray& ray, float time,
                                       float max_dist = std::numeric_limits<float>::infinity(),
                                       Facing facing = Facing::origin) const;

  /// The same for many rays, all spans of one length. Rays that lie next to each other and go about the same way are
  /// the cheapest: eight or sixteen at a time go through the scene together. Which of two surfaces at exactly the same
  /// distance is hit may then depend on a ray's neighbours.
  void intersect(std::span<const Ray> rays, std::span<const float> times, std::span<std::optional<DiscreteHit>> hits,
                 DiscreteLayer layer = DiscreteLayer::all) const;

  /// Is anything but panes within `max_dist` along the ray, on the side that light from there would meet? Any hit will
  /// do, which is a good deal cheaper than the nearest. Nothing is in the way of a ray that is not finite.
  bool occluded(const Ray& ray, float time, float max_dist, DiscreteLayer layer = DiscreteLayer::all) const;
  /// The same for many rays, all spans of one length; those next to each other go through the scene together. A
  /// `max_dist` that is not above 0 marks a ray that is not asked for: it is not occluded.
  void occluded(std::span<const Ray> rays, std::span<const float> times, std::span<const float> max_dists,
                std::span<bool> result, DiscreteLayer layer = DiscreteLayer::all) const;
  /// Is any mesh a pane?
  bool has_panes() const { return panes_ != nullptr; }
  /// As intersect(), for light that comes along the ray to its origin, through panes alone: they have a scene of their
  /// own, too, so that who knows that nothing else is in the way looks at little.
  std::optional<DiscreteHit> intersect_panes(const Ray& ray, float time, float max_dist) const;

  const DiscreteStats& stats() const;
  /// Of Embree's copies and trees.
  size_t memory_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::unique_ptr<const DiscreteScene> panes_;  // null: there are none
};

}  // namespace kairos
