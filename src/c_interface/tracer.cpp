// kairos/kairos.h: rays in, segments out.
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "c_interface/handles.h"

// Segments go out as they are.
static_assert(sizeof(kairos_segment) == sizeof(kairos::Segment) && sizeof(kairos_segment) == 28);
static_assert(offsetof(kairos_segment, dist_begin) == offsetof(kairos::Segment, dist_begin) &&
              offsetof(kairos_segment, mesh) == offsetof(kairos::Segment, mesh) &&
              offsetof(kairos_segment, triangle) == offsetof(kairos::Segment, triangle) &&
              offsetof(kairos_segment, front) == offsetof(kairos::Segment, front) && sizeof(bool) == 1);
static_assert(sizeof(kairos_ray) == sizeof(kairos::Ray) && sizeof(kairos_time_range) == sizeof(kairos::TimeRange));

struct kairos_tracer : kairos::c_interface::Counted {
  explicit kairos_tracer(kairos::Tracer made) : tracer(std::move(made)) {}
  kairos::Tracer tracer;
};
struct kairos_workspace : kairos::c_interface::Counted {
  kairos::Tracer::Workspace workspace;
};
struct kairos_hits : kairos::c_interface::Counted {
  kairos::SegmentBatch batch;
};

namespace kairos::c_interface {

namespace {

const kairos_segment* to_c(const Segment* segments) { return reinterpret_cast<const kairos_segment*>(segments); }
const Ray* from_c(const kairos_ray* rays) { return reinterpret_cast<const Ray*>(rays); }

/// Asks a program's functions.
class ForeignCutOuts : public CutOuts {
 public:
  explicit ForeignCutOuts(const kairos_cut_outs& functions) : functions_(functions) {}

  bool has(uint32_t mesh) const override { return functions_.has(functions_.user, mesh) != 0; }
  bool solid(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const override {
    return functions_.solid(functions_.user, reinterpret_cast<const kairos_ray*>(&ray), mesh, triangle, time) != 0;
  }
  void solid_times(const Ray& ray, const Segment& hit, std::vector<float>& times) const override {
    constexpr size_t kUsual = 16;
    times.resize(kUsual);
    size_t count = ask(ray, hit, times);
    if (count > times.size()) {
      times.resize(count);
      count = std::min(ask(ray, hit, times), times.size());
    }
    times.resize(count);
  }

 private:
  size_t ask(const Ray& ray, const Segment& hit, std::vector<float>& times) const {
    return functions_.solid_times(functions_.user, reinterpret_cast<const kairos_ray*>(&ray), to_c(&hit), times.data(),
                                  times.size());
  }

  kairos_cut_outs functions_;
};

TracerOptions options_of(const kairos_tracer_options* given) {
  const kairos_tracer_options from = taken(given, "options");
  TracerOptions options;
  if (from.fast != 0) options.precision = Precision::fast;
  if (from.instruction_set != nullptr)
    options.instruction_set = choice<InstructionSet>("instruction_set", from.instruction_set);
  options.threads = from.threads;
  if (from.cut_outs != nullptr) {
    const kairos_cut_outs functions = taken(from.cut_outs, "cut_outs");
    if (functions.has == nullptr || functions.solid_times == nullptr || functions.solid == nullptr)
      refuse("cut_outs", "needs all three functions");
    options.cut_outs = std::make_shared<const ForeignCutOuts>(functions);
  }
  return options;
}

Visibility visibility_of(int32_t what) {
  if (what != KAIROS_VISIBLE && what != KAIROS_ALL) refuse("what", "is neither KAIROS_VISIBLE nor KAIROS_ALL");
  return what == KAIROS_ALL ? Visibility::all : Visibility::visible;
}

TraceLimits limits_of(const kairos_limits* limits) {
  if (limits == nullptr) return {};
  return {limits->window_begin, limits->window_end, limits->max_dist};
}

}  // namespace

Mesh mesh_of(const kairos_mesh& given) {
  const kairos_mesh from = taken(&given, "mesh");
  Mesh mesh;
  take(from.name, mesh.name);
  const size_t keys = std::max<size_t>(from.key_count, 1);
  const size_t stride = from.stride == 0 ? sizeof(Vec3f) : from.stride;
  if (stride < sizeof(Vec3f) || stride % alignof(float) != 0)
    refuse("mesh", "has a stride that is not 12 bytes or more, in fours");
  if (from.triangle_count > 0) needed(from.triangles, "triangles");
  mesh.triangles.resize(from.triangle_count);
  if (from.triangle_count > 0)
    std::memcpy(mesh.triangles.data(), from.triangles, from.triangle_count * sizeof(Triangle));
  if (keys > 1) mesh.key_times.assign(&needed(from.key_times, "key_times"), from.key_times + keys);
  needed(from.positions, "positions");
  for (size_t k = 0; k < keys; ++k) {
    const auto* vertex = reinterpret_cast<const std::byte*>(from.positions[k]);
    if (from.vertex_count > 0) needed(vertex, "positions");
    std::vector<Vec3f>& key = mesh.positions.emplace_back(from.vertex_count);
    for (Vec3f& position : key) {
      std::memcpy(&position, vertex, sizeof(Vec3f));
      vertex += stride;
    }
  }
  mesh.material = from.material;
  mesh.one_sided = from.one_sided != 0;
  return mesh;
}

}  // namespace kairos::c_interface

using namespace kairos::c_interface;

extern "C" {

void kairos_tracer_retain(kairos_tracer* tracer) { retain(tracer); }
void kairos_tracer_release(kairos_tracer* tracer) { release(tracer); }
void kairos_workspace_release(kairos_workspace* workspace) { release(workspace); }
void kairos_hits_retain(kairos_hits* hits) { retain(hits); }
void kairos_hits_release(kairos_hits* hits) { release(hits); }

kairos_status kairos_make_tracer(const kairos_mesh* meshes, size_t mesh_count, const kairos_tracer_options* options,
                                 kairos_tracer** out) {
  return guarded([&] {
    needed(out, "out");
    std::vector<kairos::Mesh> made;
    for_each(meshes, mesh_count, "meshes", [&](const kairos_mesh& mesh) { made.push_back(mesh_of(mesh)); });
    *out = new kairos_tracer(kairos::Tracer(made, options_of(options)));
  });
}

kairos_status kairos_make_shot_tracer(const kairos_shot* shot, const kairos_tracer_options* options,
                                      kairos_tracer** out) {
  return guarded([&] {
    needed(out, "out");
    *out = new kairos_tracer(kairos::Tracer(needed(shot, "shot").shot.meshes, options_of(options)));
  });
}

kairos_status kairos_make_workspace(kairos_workspace** out) {
  return guarded([&] { needed(out, "out") = new kairos_workspace; });
}

kairos_status kairos_trace(const kairos_tracer* tracer, kairos_workspace* workspace, const kairos_ray* ray,
                           int32_t what, const kairos_limits* limits, const kairos_segment** segments, size_t* count) {
  return guarded([&] {
    needed(segments, "segments");
    needed(count, "count");
    const auto found = needed(tracer, "tracer")
                           .tracer.trace(*from_c(&needed(ray, "ray")), visibility_of(what),
                                         needed(workspace, "workspace").workspace, limits_of(limits));
    *segments = to_c(found.data());
    *count = found.size();
  });
}

kairos_status kairos_trace_packet(const kairos_tracer* tracer, kairos_workspace* workspace, const kairos_ray* rays,
                                  size_t ray_count, int32_t what, const kairos_limits* limits,
                                  const kairos_segment** segments, size_t* counts) {
  return guarded([&] {
    if (ray_count == 0) return;
    needed(rays, "rays");
    needed(segments, "segments");
    needed(counts, "counts");
    const auto found = needed(tracer, "tracer")
                           .tracer.trace_packet({from_c(rays), ray_count}, visibility_of(what),
                                                needed(workspace, "workspace").workspace, {}, true, limits_of(limits));
    for (size_t i = 0; i < ray_count; ++i) {
      segments[i] = to_c(found[i].segments.data());
      counts[i] = found[i].segments.size();
    }
  });
}

kairos_status kairos_occluded(const kairos_tracer* tracer, kairos_workspace* workspace, const kairos_ray* ray,
                              const kairos_limits* limits, const kairos_time_range** ranges, size_t* count) {
  return guarded([&] {
    needed(ranges, "ranges");
    needed(count, "count");
    const auto found =
        needed(tracer, "tracer")
            .tracer.occluded(*from_c(&needed(ray, "ray")), needed(workspace, "workspace").workspace, limits_of(limits));
    *ranges = reinterpret_cast<const kairos_time_range*>(found.data());
    *count = found.size();
  });
}

kairos_status kairos_query(const kairos_tracer* tracer, const kairos_ray* rays, size_t ray_count, int32_t what,
                           const kairos_limits* limits, kairos_hits** out) {
  return guarded([&] {
    needed(out, "out");
    if (ray_count > 0) needed(rays, "rays");
    auto hits = std::make_unique<kairos_hits>();
    hits->batch =
        needed(tracer, "tracer")
            .tracer.trace(std::span(from_c(rays), ray_count), visibility_of(what), nullptr, limits_of(limits));
    *out = hits.release();
  });
}

kairos_status kairos_hits_data(const kairos_hits* hits, const kairos_segment** segments, size_t* segment_count,
                               const size_t** offsets, size_t* ray_count) {
  return guarded([&] {
    const kairos::SegmentBatch& batch = needed(hits, "hits").batch;
    if (segments != nullptr) *segments = to_c(batch.segments.data());
    if (segment_count != nullptr) *segment_count = batch.segments.size();
    if (offsets != nullptr) *offsets = batch.offsets.data();
    if (ray_count != nullptr) *ray_count = batch.offsets.empty() ? 0 : batch.offsets.size() - 1;
  });
}

}  // extern "C"
