#include <algorithm>
#include <array>
#include <cmath>

#include <kairos/error.h>
#include <kairos/tracer.h>

#include "accel/accel.h"
#include "base/parallel.h"
#include "kernels/dispatch.h"
#include "kernels/ray_frame.h"
#include "scene/instances.h"
#include "scene/working_scale.h"

namespace kairos {

TraceCounters& TraceCounters::operator+=(const TraceCounters& other) {
  rays += other.rays;
  nodes += other.nodes;
  triangles += other.triangles;
  root_solves += other.root_solves;
  hits += other.hits;
  segments += other.segments;
  return *this;
}

namespace {

void check(const TraceLimits& limits) {
  if (!(limits.window_begin >= 0 && limits.window_begin < limits.window_end && limits.window_end <= 1))
    throw Error(ErrorCode::bad_usage, "time window", "give 0 <= begin < end <= 1, in shutter time");
  if (!(limits.max_dist > 0)) throw Error(ErrorCode::bad_usage, "largest distance", "give a positive one");
}

float largest_coordinate(std::span<const Mesh> meshes) {
  float largest = 0;
  const auto include = [&](const Vec3f& p) {
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  };
  ObjectCorners corners;
  for (const Mesh& mesh : meshes) {
    for (const std::vector<Vec3f>& key : mesh.positions)
      for (const Vec3f& p : key) include(p);
    for (const AffineMap& map : mesh.placements)
      for (const Vec3f& corner : corners.of(*mesh.object)) include(map.point(corner));
  }
  return largest;
}

/// Parallel rays that are farther apart than this share of the largest coordinate see different things; and the smaller
/// what they meet is against how far they are apart, the worse it is resolved from their middle.
constexpr float kWidestParallel = 1.0f / 64;

RayMode mode_of(Visibility visibility) { return visibility == Visibility::visible ? RayMode::visible : RayMode::all; }

}  // namespace

struct Tracer::Impl {
  Accel accel;
  uint32_t depth = 0;
  InstructionSet instruction_set = InstructionSet::scalar;
  CollectHits collect = nullptr;
  CollectPacketHits collect_packet = nullptr;
  std::shared_ptr<const CutOuts> cut_outs;
  std::vector<uint8_t> one_sided;  // [mesh]; empty where none is
  int threads = 0;
  int exponent = 0;  // of the trees' size: see working_exponent
  float extent = 0;  // of the trees: their largest coordinate

  void begin(RayState& state, RayMode mode, const TraceLimits& limits, const Ray& ray) const {
    ScaledRay scaled(ray, exponent);
    scaled.come_near(extent, limits.max_dist);
    state.begin_ray(mode, limits, depth, scaled, cut_outs.get(), one_sided.empty() ? nullptr : one_sided.data());
  }
  void run(RayState& state, RayMode mode, const TraceLimits& limits, const Ray& ray) const {
    check(limits);
    begin(state, mode, limits, ray);
    if (is_traceable(state.scaled.ray)) collect(accel, state.scaled.ray, state);
    state.end_ray();
  }
  /// In packets where `together` and rays fit into one. states: one per ray.
  void run(std::span<RayState> states, RayMode mode, const TraceLimits& limits, std::span<const Ray> rays,
           std::span<const Segment> occluder_hints, bool together) const {
    check(limits);
    for (size_t i = 0; i < rays.size(); ++i) {
      begin(states[i], mode, limits, rays[i]);
      if (!occluder_hints.empty()) states[i].add_occluder_hint(occluder_hints[i]);
      together = together && is_traceable(states[i].scaled.ray) && states[i].scaled.exponent == exponent &&
                 states[i].scaled.ahead == 0;
    }
    std::optional<RayPacket> packet;
    std::array<Ray, kMaxPacket> scaled;
    if (together && rays.size() > 1 && collect_packet != nullptr) {
      if (exponent != 0) {
        for (size_t i = 0; i < rays.size(); ++i) scaled[i] = states[i].scaled.ray;
        rays = std::span<const Ray>(scaled).first(rays.size());
      }
      packet = make_packet(rays, extent * kWidestParallel);
    }
    if (packet) {
      collect_packet(accel, *packet, states);
    } else {
      for (RayState& state : states)
        if (is_traceable(state.scaled.ray)) collect(accel, state.scaled.ray, state);
    }
    for (RayState& state : states) state.end_ray();
  }
};

struct Tracer::Workspace::State {
  std::array<RayState, kMaxPacket> rays;
  std::array<SeenByRay, kMaxPacket> results;
  std::array<std::span<const TimeRange>, kMaxPacket> covered;
};

Tracer::Workspace::Workspace() : state_(std::make_unique<State>()) {}
Tracer::Workspace::~Workspace() = default;
Tracer::Workspace::Workspace(Workspace&&) noexcept = default;
Tracer::Workspace& Tracer::Workspace::operator=(Workspace&&) noexcept = default;
TraceCounters Tracer::Workspace::counters() const {
  TraceCounters sum;
  for (const RayState& ray : state_->rays) sum += ray.counters;
  return sum;
}
std::span<const Segment> Tracer::Workspace::blended() const { return state_->rays[0].blended; }

Tracer::Tracer(std::span<const Mesh> meshes, const TracerOptions& options) : impl_(std::make_unique<Impl>()) {
  validate_meshes(meshes);
  impl_->instruction_set = options.instruction_set.value_or(supported_instruction_sets().back());
  const Kernels* kernels = find_kernels(impl_->instruction_set);
  if (kernels == nullptr)
    throw Error(ErrorCode::bad_usage, "instruction set",
                std::string(to_string(impl_->instruction_set)) + " is not available on this machine");
  impl_->collect = options.precision == Precision::fast ? kernels->collect_fast : kernels->collect_exact;
  if (options.precision == Precision::fast) impl_->collect_packet = kernels->collect_packet;
  impl_->cut_outs = options.cut_outs;
  if (std::any_of(meshes.begin(), meshes.end(), [](const Mesh& mesh) { return mesh.one_sided; }))
    for (const Mesh& mesh : meshes) impl_->one_sided.push_back(mesh.one_sided ? 1 : 0);
  impl_->threads = options.threads;
  with_threads(options.threads, [&] {
    impl_->exponent = working_exponent(meshes);
    impl_->extent = std::ldexp(largest_coordinate(meshes), impl_->exponent);
    if (impl_->exponent == 0) {
      impl_->accel = build_accel(meshes, options.moving_meshes_only);
    } else {
      impl_->accel = build_accel(scaled_copies(meshes, impl_->exponent), options.moving_meshes_only);
      impl_->cut_outs = scaled_cut_outs(options.cut_outs, impl_->exponent);
    }
  });
  impl_->depth = impl_->accel.depth();
}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

std::span<const Segment> Tracer::trace(const Ray& ray, Visibility visibility, Workspace& workspace,
                                       const TraceLimits& limits) const {
  RayState& state = workspace.state_->rays[0];
  impl_->run(state, mode_of(visibility), limits, ray);
  return state.segments;
}

std::span<const TimeRange> Tracer::occluded(const Ray& ray, Workspace& workspace, const TraceLimits& limits) const {
  RayState& state = workspace.state_->rays[0];
  impl_->run(state, RayMode::occluded, limits, ray);
  return state.covered;
}

std::span<const SeenByRay> Tracer::trace_packet(std::span<const Ray> rays, Visibility visibility, Workspace& workspace,
                                                std::span<const Segment> occluder_hints, bool together,
                                                const TraceLimits& limits) const {
  if (rays.size() > kMaxPacket)
    throw Error(ErrorCode::bad_usage, "Tracer::trace_packet", "more than 16 rays; divide them into several packets");
  if (!occluder_hints.empty() && occluder_hints.size() != rays.size())
    throw Error(ErrorCode::bad_usage, "Tracer::trace_packet", "give as many occluder hints as rays, or none");
  auto& [states, results, covered] = *workspace.state_;
  impl_->run(std::span(states).first(rays.size()), mode_of(visibility), limits, rays, occluder_hints, together);
  for (size_t i = 0; i < rays.size(); ++i) results[i] = {states[i].segments, states[i].blended};
  return std::span(results).first(rays.size());
}

std::span<const std::span<const TimeRange>> Tracer::occluded_packet(std::span<const Ray> rays, Workspace& workspace,
                                                                    const TraceLimits& limits) const {
  if (rays.size() > kMaxPacket)
    throw Error(ErrorCode::bad_usage, "Tracer::occluded_packet", "more than 16 rays; divide them into several packets");
  auto& [states, results, covered] = *workspace.state_;
  impl_->run(std::span(states).first(rays.size()), RayMode::occluded, limits, rays, {}, true);
  for (size_t i = 0; i < rays.size(); ++i) covered[i] = states[i].covered;
  return std::span(covered).first(rays.size());
}

SegmentBatch Tracer::trace(std::span<const Ray> rays, Visibility visibility, TraceCounters* counters,
                           const TraceLimits& limits) const {
  check(limits);
  constexpr size_t kChunk = 256;
  struct Chunk {
    std::vector<size_t> counts;
    std::vector<Segment> segments;
    TraceCounters counters;
  };
  std::vector<Chunk> chunks((rays.size() + kChunk - 1) / kChunk);
  const auto trace_chunks = [&](size_t begin, size_t end) {
    Workspace workspace;
    for (size_t c = begin; c < end; ++c) {
      workspace.state_->rays[0].counters = {};
      for (const Ray& ray : rays.subspan(c * kChunk, std::min(kChunk, rays.size() - c * kChunk))) {
        const auto segments = trace(ray, visibility, workspace, limits);
        chunks[c].counts.push_back(segments.size());
        chunks[c].segments.insert(chunks[c].segments.end(), segments.begin(), segments.end());
      }
      chunks[c].counters = workspace.counters();
    }
  };
  with_threads(impl_->threads, [&] { parallel_for(chunks.size(), 1, trace_chunks); });
  SegmentBatch batch;
  batch.offsets.reserve(rays.size() + 1);
  batch.offsets.push_back(0);
  for (Chunk& chunk : chunks) {
    for (size_t count : chunk.counts) batch.offsets.push_back(batch.offsets.back() + count);
    batch.segments.insert(batch.segments.end(), chunk.segments.begin(), chunk.segments.end());
    if (counters != nullptr) *counters += chunk.counters;
    chunk = {};
  }
  return batch;
}

InstructionSet Tracer::instruction_set() const { return impl_->instruction_set; }
size_t Tracer::memory_bytes() const { return impl_->accel.memory_bytes(); }

}  // namespace kairos
