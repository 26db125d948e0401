// The kernel on its own: moving triangles and rays in, visibility segments out.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <kairos/export.h>
#include <kairos/mesh.h>

namespace kairos {

/// A ray held fixed while the shutter is open: points origin + dist * direction, dist > 0.
/// The direction is of any finite length but zero; where that is very small, distances may overflow to infinity.
struct Ray {
  Vec3f origin;
  Vec3f direction;
};

/// The stretch of shutter time [begin, end) in which a ray sees (or, unresolved, meets) one triangle.
struct Segment {
  float begin = 0, end = 0;            ///< shutter time, 0 <= begin < end <= 1
  float dist_begin = 0, dist_end = 0;  ///< distance along the ray at both ends, in units of |direction|
  uint32_t mesh = 0;                   ///< index into the meshes the tracer was made of
  uint32_t triangle = 0;               ///< index into that mesh's triangles
  bool front = false;                  ///< the side on which the vertices run counter-clockwise faces the origin

  float duration() const { return end - begin; }
};

enum class InstructionSet { scalar, sse4, avx2, avx512, neon };

KAIROS_API std::string_view to_string(InstructionSet set);
/// What this machine can run, best last; `scalar` is always among them.
KAIROS_API std::span<const InstructionSet> supported_instruction_sets();

/// Arithmetic of the triangle kernel. Both read the same float geometry.
enum class Precision {
  fast,   ///< float: for images
  exact,  ///< double: times within 1e-6 of the shutter for well-conditioned triangles
};

enum class Visibility {
  visible,  ///< disjoint segments in time order: what is nearest, and when
  all,      ///< every triangle met, hidden or not; ordered by begin, then mesh, then triangle
};

/// A stretch of shutter time, [begin, end).
struct TimeRange {
  float begin = 0, end = 1;
};

/// When a ray looks, and how far. Of what it meets only the part inside is given, cut exactly. Throws Error(bad_usage)
/// wherever it is given: when it isn't 0 <= window_begin < window_end <= 1 and max_dist > 0.
struct TraceLimits {
  float window_begin = 0, window_end = 1;                   ///< shutter time
  float max_dist = std::numeric_limits<float>::infinity();  ///< in units of the direction's length

  /// True when nothing is left out.
  bool is_everything() const {
    return window_begin == 0 && window_end == 1 && max_dist == std::numeric_limits<float>::infinity();
  }
};

/// Work done, summed over rays. Exact: the same for any number of threads.
struct TraceCounters {
  uint64_t rays = 0;
  uint64_t nodes = 0;        ///< inner nodes whose children were tested
  uint64_t triangles = 0;    ///< triangles tested (filled lanes of leaf blocks)
  uint64_t root_solves = 0;  ///< edge quadratics solved
  uint64_t hits = 0;         ///< hit intervals put into the list before it is resolved
  uint64_t segments = 0;     ///< segments returned

  KAIROS_API TraceCounters& operator+=(const TraceCounters& other);
};

/// Says where surfaces are missing, as leaves are outside of what is painted on their triangles, and which of them are
/// blended: seen, but hiding nothing. Must be safe to use from many threads at once.
class KAIROS_API CutOuts {
 public:
  virtual ~CutOuts() = default;
  /// False when nothing of the mesh is ever missing and it is not blended.
  virtual bool has(uint32_t mesh) const = 0;
  /// Blended meshes hide nothing from time-continuous rays, which hand over what they meet of them apart: see
  /// Workspace::blended.
  virtual bool is_blended(uint32_t /*mesh*/) const { return false; }
  /// Is the point there in which the ray meets the triangle at `time`? Of a blended mesh, which only discrete rays ask
  /// about: by chance, as often as its opacity says, and the same whenever asked.
  virtual bool solid(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const = 0;
  /// Replaces `times` by when, during a hit, it is: begin, end, begin, end, ..., ascending.
  virtual void solid_times(const Ray& ray, const Segment& hit, std::vector<float>& times) const = 0;
};

struct TracerOptions {
  Precision precision = Precision::exact;
  std::optional<InstructionSet> instruction_set;      ///< unset: the best one
  std::shared_ptr<const CutOuts> cut_outs = nullptr;  ///< null: all surfaces are whole
  bool moving_meshes_only = false;  ///< leave out meshes with a single key: the caller knows what rays see of them
  int threads = 0;                  ///< that build trees and trace many rays; 0: as many as the machine has
};

/// Segments of many rays: those of ray i are segments[offsets[i]] to segments[offsets[i + 1]].
struct SegmentBatch {
  std::vector<size_t> offsets;
  std::vector<Segment> segments;

  std::span<const Segment> operator[](size_t ray) const {
    return {segments.data() + offsets[ray], segments.data() + offsets[ray + 1]};
  }
};

/// What one ray of a packet sees: as trace() and Workspace::blended() give it.
struct SeenByRay {
  std::span<const Segment> segments, blended;
};

/// Answers, for any ray: what is seen along it, and from when to when.
///
/// Immutable and safe to use from many threads at once. Copies what it needs of the meshes.
class KAIROS_API Tracer {
 public:
  /// Throws Error(bad_input) when a mesh breaks an invariant, Error(bad_usage) when the instruction set is not there.
  explicit Tracer(std::span<const Mesh> meshes, const TracerOptions& options = {});
  ~Tracer();
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;

  /// Scratch memory of one thread; it grows to what the deepest ray needed and is then reused.
  class KAIROS_API Workspace {
   public:
    Workspace();
    ~Workspace();
    Workspace(Workspace&&) noexcept;
    Workspace& operator=(Workspace&&) noexcept;

    TraceCounters counters() const;  ///< work of all rays traced with this workspace so far
    /// What the ray traced last for Visibility::visible meets of blended meshes in front of its segments (where there
    /// is none: at any distance). Ordered by begin, then mesh and triangle; they may overlap. Valid until the next use.
    std::span<const Segment> blended() const;

   private:
    friend class Tracer;
    struct KAIROS_LOCAL State;
    std::unique_ptr<State> state_;
  };

  /// The segments of one ray; the span lives in the workspace until its next use. A ray that is not finite, or has no
  /// direction, meets nothing.
  std::span<const Segment> trace(const Ray& ray, Visibility visibility, Workspace& workspace,
                                 const TraceLimits& limits = {}) const;

  /// When anything is met within the limits: disjoint, in order; the span lives in the workspace until its next use.
  /// Cheaper than trace(): any hit will do, and nothing more is looked for once hits fill the window. What cut-outs
  /// leave out is not there; blended meshes hide nothing and are not met.
  std::span<const TimeRange> occluded(const Ray& ray, Workspace& workspace, const TraceLimits& limits = {}) const;

  /// The most rays that trace_packet takes.
  static constexpr size_t kMaxPacket = 16;

  /// The same for up to 16 rays at once: several times cheaper than one by one where rays come from one origin and go
  /// about the same way, as those of a pixel do, or are parallel and near each other, as those from a surface to the
  /// sun; and no dearer otherwise. Times and distances differ from trace()'s by rounding. Only Precision::fast knows
  /// packets. What the rays share is counted once.
  ///
  /// occluder_hints: none, or for each ray what it is known to see if nothing else is in front: a hit over the whole
  /// shutter; one without duration says that there is nothing. together: false to go through the trees one by one,
  /// which is faster where rays share little. Throws Error(bad_usage) for more than 16 rays, or another number of
  /// occluder_hints.
  std::span<const SeenByRay> trace_packet(std::span<const Ray> rays, Visibility visibility, Workspace& workspace,
                                          std::span<const Segment> occluder_hints = {}, bool together = true,
                                          const TraceLimits& limits = {}) const;

  /// The same of occluded(): when anything is met along each of up to 16 rays. The spans live in the workspace until
  /// its next use. Throws Error(bad_usage) for more than 16 rays.
  std::span<const std::span<const TimeRange>> occluded_packet(std::span<const Ray> rays, Workspace& workspace,
                                                              const TraceLimits& limits = {}) const;

  /// Many rays, in parallel; without blended meshes. The result does not depend on the number of threads.
  SegmentBatch trace(std::span<const Ray> rays, Visibility visibility, TraceCounters* counters = nullptr,
                     const TraceLimits& limits = {}) const;

  InstructionSet instruction_set() const;
  size_t memory_bytes() const;

 private:
  struct KAIROS_LOCAL Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kairos
