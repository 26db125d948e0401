#include "discrete/discrete_scene.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include <kairos/error.h>

#include "base/parallel.h"
#include "discrete/embree_device.h"
#include "discrete/placed_object.h"
#include "discrete/uneven_triangles.h"
#include "discrete/uniform_runs.h"
#include "kernels/ray_frame.h"
#include "scene/instances.h"
#include "scene/working_scale.h"

namespace kairos {

namespace {

static_assert(kMaxTimeSteps == RTC_MAX_TIME_STEP_COUNT);

/// Rays that go through the scene together. Sixteen are faster by up to a fifth where they stay together (the fan, the
/// hall) and as fast where they don't; of fewer than nine, half of the lanes would be empty.
constexpr size_t kLargePacket = 16, kSmallPacket = 8;

/// Rays begin beyond their origin: a surface in which the eye lies is seen by none, as by no time-continuous one.
constexpr float kNearest = std::numeric_limits<float>::min();

struct LargePacket {
  static constexpr size_t kSize = kLargePacket;
  using Query = RTCRayHit16;
  static constexpr auto kIntersect = rtcIntersect16;
  using ShadowQuery = RTCRay16;
  static constexpr auto kOccluded = rtcOccluded16;
};
struct SmallPacket {
  static constexpr size_t kSize = kSmallPacket;
  using Query = RTCRayHit8;
  static constexpr auto kIntersect = rtcIntersect8;
  using ShadowQuery = RTCRay8;
  static constexpr auto kOccluded = rtcOccluded8;
};

/// Of one ray, into Embree's.
void fill(RTCRay& query, const Ray& ray, float max_dist) {
  query.org_x = ray.origin.x;
  query.org_y = ray.origin.y;
  query.org_z = ray.origin.z;
  query.dir_x = ray.direction.x;
  query.dir_y = ray.direction.y;
  query.dir_z = ray.direction.z;
  query.tnear = kNearest;
  query.tfar = max_dist;
  query.mask = ~0u;
}
/// The same into number `i` of a packet.
template <class Packet>
void fill(Packet& query, size_t i, const Ray& ray, float max_dist) {
  query.org_x[i] = ray.origin.x;
  query.org_y[i] = ray.origin.y;
  query.org_z[i] = ray.origin.z;
  query.dir_x[i] = ray.direction.x;
  query.dir_y[i] = ray.direction.y;
  query.dir_z[i] = ray.direction.z;
  query.tnear[i] = kNearest;
  query.tfar[i] = max_dist;
  query.mask[i] = ~0u;
  query.id[i] = static_cast<unsigned>(i);
}

/// That nothing of a geometry occludes.
void refuse_all(const RTCFilterFunctionNArguments* hits) { std::fill_n(hits->valid, hits->N, 0); }

bool usable(const Ray& ray, float time) {
  return is_finite(ray.origin) && is_finite(ray.direction) && !(ray.direction == Vec3f{}) && time >= 0 && time <= 1;
}

/// True where the side on which the vertices run counter-clockwise faces the ray's origin.
bool faces(Vec3f normal, Vec3f direction) { return dot(to_double(normal), to_double(direction)) < 0; }

template <class Element>
void fill_buffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format,
                 const std::vector<Element>& source, EmbreeDevice& device) {
  void* data = rtcSetNewGeometryBuffer(geometry, type, slot, format, sizeof(Element), source.size());
  device.check();
  std::memcpy(data, source.data(), source.size() * sizeof(Element));
}

/// Into how many pieces each key span of a run is to be cut for it to have `keys` keys.
size_t parts_per_span(UniformRun run, int keys) {
  const size_t spans = run.last - run.first, wanted = keys > 1 ? static_cast<size_t>(keys) - 1 : 1;
  return std::max<size_t>(1, std::min((wanted + spans - 1) / spans, (kMaxTimeSteps - 1) / spans));
}

std::vector<Vec3f> between(const std::vector<Vec3f>& from, const std::vector<Vec3f>& to, float place) {
  std::vector<Vec3f> points(from.size());
  for (size_t i = 0; i < points.size(); ++i)
    points[i] = to_float(lerp(to_double(from[i]), to_double(to[i]), static_cast<double>(place)));
  return points;
}

/// How many sets of key times may have Embree scenes of their own, through each of which every ray goes; all others
/// share one. Embree intersects its own triangles up to twice as fast as it asks others to.
constexpr size_t kOwnSets = 4;

/// When the scenes of a mesh begin and end.
using Stretches = std::vector<std::pair<float, float>>;
Stretches stretches_of(const Mesh& mesh) {
  Stretches stretches;
  for (const UniformRun& run : uniform_runs(mesh.key_times))
    stretches.emplace_back(mesh.key_times[run.first], mesh.key_times[run.last]);
  return stretches;
}

/// The sets that have scenes of their own: those of the most triangles.
std::vector<Stretches> choose_own_sets(std::span<const Mesh> meshes) {
  std::map<Stretches, size_t> triangles;
  for (const Mesh& mesh : meshes)
    if (!mesh.is_static()) triangles[stretches_of(mesh)] += mesh.triangle_count();
  std::vector<std::pair<size_t, Stretches>> sets;
  for (const auto& [stretches, count] : triangles) sets.emplace_back(count, stretches);
  std::stable_sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (sets.size() > kOwnSets) sets.resize(kOwnSets);
  std::vector<Stretches> own;
  for (auto& [count, stretches] : sets) own.push_back(std::move(stretches));
  return own;
}

/// Geometry that is there in one stretch of the shutter, which is Embree's time from 0 to 1. Embree knows time ranges
/// of geometries too, but where they differ within one scene its version 3.13 loses triangles.
struct Window {
  float begin = 0, end = 1;
  bool moves = false;
  EmbreeScene scene;

  bool holds(float time) const { return begin <= time && (time < end || end == 1); }
  float local(float time) const { return std::min((time - begin) / (end - begin), 1.0f); }
};

}  // namespace

struct DiscreteScene::Impl {
  // In this order: scenes are gone before the device is.
  EmbreeDevice device;
  std::vector<Window> windows;       // what stays still comes first, if there is any
  std::vector<uint32_t> mesh_of;     // [Embree's geometry number]; one numbering for all scenes but those of objects
  std::vector<PlacedObject> placed;  // likewise; empty where nothing is an instance
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

  Impl(std::span<const Mesh> meshes, const DiscreteOptions& options)
      : device(embree_instruction_set(options.instruction_set)) {
    const auto begin = std::chrono::steady_clock::now();
    cut_outs = options.cut_outs;
    panes = options.panes;
    panes.resize(meshes.size());
    validate_meshes(meshes);
    for (size_t m = 0; m < meshes.size(); ++m) {
      const Mesh& mesh = meshes[m];
      stats.triangles += mesh.triangle_count();
      if (mesh.triangle_count() == 0 || !mesh.is_static()) continue;
      if (windows.empty()) add_window(0, 1, false, options);
      attach(windows.front(), mesh, {0, 0}, 1, static_cast<uint32_t>(m), options);
      ++stats.static_geometries;
    }
    const size_t first_moving = windows.size();
    const std::vector<Stretches> own_sets = choose_own_sets(meshes);
    std::vector<uint32_t> others;
    for (size_t m = 0; m < meshes.size(); ++m) {
      const Mesh& mesh = meshes[m];
      if (mesh.triangle_count() == 0 || mesh.is_static()) continue;
      if (std::find(own_sets.begin(), own_sets.end(), stretches_of(mesh)) == own_sets.end()) {
        others.push_back(static_cast<uint32_t>(m));
        continue;
      }
      for (const UniformRun& run : uniform_runs(mesh.key_times)) {
        const float run_begin = mesh.key_times[run.first], run_end = mesh.key_times[run.last];
        size_t w = first_moving;
        while (w < windows.size() && !(windows[w].begin == run_begin && windows[w].end == run_end)) ++w;
        if (w == windows.size()) add_window(run_begin, run_end, true, options);
        attach(windows[w], mesh, run, parts_per_span(run, options.keys), static_cast<uint32_t>(m), options);
        ++stats.moving_geometries;
      }
    }
    if (!others.empty()) add_window(0, 1, true, options);
    for (const uint32_t m : others) attach_uneven(windows.back(), expanded(meshes[m]), m, options.keys);
    stats.trees = windows.size();
    // A thread that waits for Embree's locks must not take up work that waits for them too.
    isolate([&] {
      for (const auto& [object, scene] : objects) rtcCommitScene(scene.get());
      for (const Window& window : windows) rtcCommitScene(window.scene.get());
    });
    device.check();
    stats.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  void add_window(float begin, float end, bool moves, const DiscreteOptions& options) {
    windows.push_back({begin, end, moves, new_scene(options)});
  }
  EmbreeScene new_scene(const DiscreteOptions& options) {
    EmbreeScene scene(rtcNewScene(device.get()));
    device.check();
    rtcSetSceneFlags(scene.get(), options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    return scene;
  }

  /// What is said of a mesh's triangles wherever it lies.
  void set_refusals(RTCGeometry geometry, const Object& object) {
    const RTCFilterFunctionN refusal = !object.one_sided  ? refuse_hits<false, true>
                                       : object.has_holes ? refuse_hits<true, true>
                                                          : refuse_hits<true, false>;
    rtcSetGeometryUserData(geometry, this);
    const bool refuses = object.has_holes || object.one_sided;
    if (refuses) rtcSetGeometryIntersectFilterFunction(geometry, refusal);
    if (object.is_pane)
      rtcSetGeometryOccludedFilterFunction(geometry, refuse_all);
    else if (refuses)
      rtcSetGeometryOccludedFilterFunction(geometry, refusal);
  }

  /// The object of an instance, in a scene of its own. Instances whose surfaces are refused in other ways have another.
  RTCScene scene_of(const Object& object, const DiscreteOptions& options) {
    const auto found = objects.find(object);
    if (found != objects.end()) return found->second.get();
    const EmbreeScene& scene = objects.emplace(object, new_scene(options)).first->second;
    const EmbreeGeometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    device.check();
    fill_buffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, object.mesh->triangles, device);
    fill_buffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, object.mesh->positions.front(), device);
    set_refusals(geometry.get(), object);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene.get(), geometry.get());
    device.check();
    return scene.get();
  }

  /// The next number of a geometry in the windows' scenes.
  unsigned number_for(uint32_t mesh, PlacedObject where) {
    if (where.steps() > 0 || !placed.empty()) {
      placed.resize(mesh_of.size());
      placed.push_back(std::move(where));
    }
    mesh_of.push_back(mesh);
    return static_cast<unsigned>(mesh_of.size() - 1);
  }

  void attach_instance(const Window& window, const Mesh& mesh, UniformRun run, size_t parts, uint32_t index,
                       const DiscreteOptions& options) {
    const Object object{mesh.object.get(), mesh.one_sided, cut_outs && cut_outs->has(index), panes[index]};
    const EmbreeGeometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    device.check();
    PlacedObject where(mesh, run, parts);
    where.fill(geometry.get(), scene_of(object, options));
    if (where.steps() > 1) stats.moving_keys += where.steps();
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(window.scene.get(), geometry.get(), number_for(index, std::move(where)));
    device.check();
  }

  uint32_t mesh_of_hit(unsigned geometry, unsigned instance) const {
    return mesh_of[instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance];
  }
  /// The normal of a hit, in the space of the ray, at a time within its scene's window.
  Vec3f normal_of_hit(Vec3f normal, unsigned instance, float time) const {
    return instance == RTC_INVALID_GEOMETRY_ID ? normal : placed[instance].normal(normal, time);
  }

  /// parts: pieces that each key span is cut into.
  void attach(const Window& window, const Mesh& mesh, UniformRun run, size_t parts, uint32_t index,
              const DiscreteOptions& options) {
    if (mesh.object) return attach_instance(window, mesh, run, parts, index, options);
    const EmbreeGeometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    device.check();
    fill_buffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles, device);
    const size_t steps = (run.last - run.first) * parts + 1;
    if (steps > 1) stats.moving_keys += steps;
    rtcSetGeometryTimeStepCount(geometry.get(), static_cast<unsigned>(steps));
    for (size_t step = 0; step < steps; ++step) {
      const size_t key = run.first + step / parts;
      const float place = static_cast<float>(step % parts) / static_cast<float>(parts);
      fill_buffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(step), RTC_FORMAT_FLOAT3,
                  place == 0 ? mesh.positions[key] : between(mesh.positions[key], mesh.positions[key + 1], place),
                  device);
    }
    set_refusals(geometry.get(), {&mesh, mesh.one_sided, cut_outs && cut_outs->has(index), panes[index]});
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(window.scene.get(), geometry.get(), number_for(index, {}));
    device.check();
  }

  void attach_uneven(const Window& window, const Mesh& mesh, uint32_t index, int least_steps) {
    const CutOuts* cuts = cut_outs && cut_outs->has(index) ? cut_outs.get() : nullptr;
    uneven.push_back(std::make_unique<const UnevenTriangles>(mesh, index, cuts, least_steps, panes[index]));
    const EmbreeGeometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER));
    device.check();
    uneven.back()->fill(geometry.get());
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(window.scene.get(), geometry.get(), number_for(index, {}));
    device.check();
    stats.moving_keys += uneven.back()->steps();
    ++stats.moving_geometries;
  }

  static DiscreteContext context_of(const Ray* rays, const float* times, Facing facing) {
    DiscreteContext context{{}, rays, times, facing};
    rtcInitIntersectContext(&context.embree);
    return context;
  }

  /// Embree asks before it takes a hit for one: refuses those on sides that are not there, and on what is missing.
  template <bool kOneSided, bool kHasHoles>
  static void refuse_hits(const RTCFilterFunctionNArguments* hits) {
    const auto& self = *static_cast<const Impl*>(hits->geometryUserPtr);
    const auto& context = *reinterpret_cast<const DiscreteContext*>(hits->context);
    for (unsigned i = 0; i < hits->N; ++i) {
      if (hits->valid[i] != -1) continue;
      const unsigned ray = RTCRayN_id(hits->ray, hits->N, i);
      const unsigned instance = RTCHitN_instID(hits->hit, hits->N, i, 0);
      if constexpr (kOneSided) {
        const Vec3f normal =
            self.normal_of_hit({RTCHitN_Ng_x(hits->hit, hits->N, i), RTCHitN_Ng_y(hits->hit, hits->N, i),
                                RTCHitN_Ng_z(hits->hit, hits->N, i)},
                               instance, RTCRayN_time(hits->ray, hits->N, i));
        if (faces(normal, context.rays[ray].direction) != (context.facing == Facing::origin)) {
          hits->valid[i] = 0;
          continue;
        }
      }
      if constexpr (!kHasHoles) continue;
      const uint32_t mesh = self.mesh_of_hit(RTCHitN_geomID(hits->hit, hits->N, i), instance);
      const uint32_t triangle = RTCHitN_primID(hits->hit, hits->N, i);
      if (!self.cut_outs->solid(context.rays[ray], mesh, triangle, context.times[ray])) hits->valid[i] = 0;
    }
  }

  void intersect_all(std::span<const Ray> rays, std::span<const float> times,
                     std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const;

  /// Denormals must be zero already.
  std::optional<DiscreteHit> intersect(const Ray& ray, float time, float max_dist, Facing facing) const {
    if (!usable(ray, time) || !(max_dist > 0)) return std::nullopt;
    RTCRayHit query{};
    fill(query.ray, ray, max_dist);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    DiscreteContext context = context_of(&ray, &time, facing);
    float hit_time = 0;                     // in its window
    for (const Window& window : windows) {  // each looks no farther than what the ones before have hit
      if (!window.holds(time)) continue;
      query.ray.time = window.local(time);
      const float farthest = query.ray.tfar;
      rtcIntersect1(window.scene.get(), &context.embree, &query);
      if (query.ray.tfar < farthest) hit_time = query.ray.time;
    }
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const unsigned instance = query.hit.instID[0];
    const Vec3f normal = normal_of_hit({query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}, instance, hit_time);
    return DiscreteHit{query.ray.tfar,   mesh_of_hit(query.hit.geomID, instance),
                       query.hit.primID, query.hit.u,
                       query.hit.v,      faces(normal, ray.direction)};
  }

  /// Denormals must be zero already.
  bool occluded(const Ray& ray, float time, float max_dist) const {
    if (!usable(ray, time) || !(max_dist > 0)) return false;
    RTCRay query{};
    DiscreteContext context = context_of(&ray, &time, Facing::far_end);
    for (const Window& window : windows) {
      if (!window.holds(time)) continue;
      fill(query, ray, max_dist);
      query.time = window.local(time);
      rtcOccluded1(window.scene.get(), &context.embree, &query);
      if (query.tfar < 0) return true;
    }
    return false;
  }

  /// Up to Packet::kSize rays; denormals must be zero already.
  template <class Packet>
  void occluded_packet(std::span<const Ray> rays, std::span<const float> times, std::span<const float> max_dists,
                       std::span<bool> result) const {
    typename Packet::ShadowQuery query{};
    for (size_t i = 0; i < rays.size(); ++i) {
      fill(query, i, rays[i], max_dists[i]);
      result[i] = false;
    }
    DiscreteContext context = context_of(rays.data(), times.data(), Facing::far_end);
    context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (const Window& window : windows) {
      alignas(64) int valid[Packet::kSize]{};
      bool any = false;
      for (size_t i = 0; i < rays.size(); ++i) {
        if (result[i] || !usable(rays[i], times[i]) || !(max_dists[i] > 0) || !window.holds(times[i])) continue;
        valid[i] = -1;
        any = true;
        query.time[i] = window.local(times[i]);
      }
      if (!any) continue;
      Packet::kOccluded(valid, window.scene.get(), &context.embree, &query);
      for (size_t i = 0; i < rays.size(); ++i) result[i] = result[i] || (valid[i] == -1 && query.tfar[i] < 0);
    }
  }

  void occluded_all(std::span<const Ray> rays, std::span<const float> times, std::span<const float> max_dists,
                    std::span<bool> result) const;

  /// Up to Packet::kSize rays; denormals must be zero already.
  template <class Packet>
  void intersect_packet(std::span<const Ray> rays, std::span<const float> times,
                        std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const {
    typename Packet::Query query{};
    for (size_t i = 0; i < rays.size(); ++i) fill(query.ray, i, rays[i], std::numeric_limits<float>::infinity());
    std::fill(std::begin(query.hit.geomID), std::end(query.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    std::fill(std::begin(query.hit.instID[0]), std::end(query.hit.instID[0]), RTC_INVALID_GEOMETRY_ID);
    std::array<float, Packet::kSize> hit_times{};  // in their windows
    DiscreteContext context = context_of(rays.data(), times.data(), Facing::origin);
    context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (const Window& window : windows) {
      if (layer == DiscreteLayer::still && window.moves) continue;
      alignas(64) int valid[Packet::kSize]{};
      bool any = false;
      for (size_t i = 0; i < rays.size(); ++i) {
        if (!usable(rays[i], times[i]) || !window.holds(times[i])) continue;
        valid[i] = -1;
        any = true;
        query.ray.time[i] = window.local(times[i]);
      }
      if (!any) continue;
      std::array<float, Packet::kSize> farthest;
      std::copy_n(query.ray.tfar, Packet::kSize, farthest.begin());
      Packet::kIntersect(valid, window.scene.get(), &context.embree, &query);
      if (placed.empty()) continue;
      for (size_t i = 0; i < rays.size(); ++i)
        if (query.ray.tfar[i] < farthest[i]) hit_times[i] = query.ray.time[i];
    }
    for (size_t i = 0; i < rays.size(); ++i) {
      hits[i].reset();
      const uint32_t geometry = query.hit.geomID[i];
      if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
      const unsigned instance = query.hit.instID[0][i];
      const Vec3f normal =
          normal_of_hit({query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]}, instance, hit_times[i]);
      hits[i] = DiscreteHit{query.ray.tfar[i], mesh_of_hit(geometry, instance), query.hit.primID[i], query.hit.u[i],
                            query.hit.v[i],    faces(normal, rays[i].direction)};
    }
  }
};

InstructionSet embree_instruction_set(std::optional<InstructionSet> wanted) {
  const std::span<const InstructionSet> supported = supported_instruction_sets();
  const InstructionSet set = wanted.value_or(supported.back());
  if (std::find(supported.begin(), supported.end(), set) == supported.end())
    throw Error(ErrorCode::bad_usage, "instruction set " + std::string(to_string(set)),
                "this machine does not have it");
  // Of x86, every machine that Embree runs on has SSE4.
  return set == InstructionSet::scalar && supported.back() != InstructionSet::neon ? InstructionSet::sse4 : set;
}

DiscreteScene::DiscreteScene(std::span<const Mesh> meshes, const DiscreteOptions& options) {
  if (std::find(options.panes.begin(), options.panes.end(), true) != options.panes.end()) {
    std::vector<Mesh> only(meshes.size());
    for (size_t m = 0; m < meshes.size() && m < options.panes.size(); ++m)
      if (options.panes[m]) only[m] = meshes[m];
    DiscreteOptions alone = options;
    alone.panes.clear();
    panes_ = std::make_unique<const DiscreteScene>(only, alone);
  }
  const int exponent = working_exponent(meshes);
  if (exponent == 0) {
    impl_ = std::make_unique<Impl>(meshes, options);
    return;
  }
  validate_meshes(meshes);
  DiscreteOptions scaled = options;
  scaled.cut_outs = scaled_cut_outs(options.cut_outs, exponent);
  impl_ = std::make_unique<Impl>(scaled_copies(meshes, exponent), scaled);
  impl_->exponent = exponent;
}
DiscreteScene::~DiscreteScene() = default;
DiscreteScene::DiscreteScene(DiscreteScene&&) noexcept = default;
DiscreteScene& DiscreteScene::operator=(DiscreteScene&&) noexcept = default;

std::optional<DiscreteHit> DiscreteScene::intersect(const Ray& ray, float time, float max_dist, Facing facing) const {
  const ScaledRay scaled(ray, impl_->exponent);  // before denormals become zero
  const float scaled_max = std::ldexp(max_dist, scaled.exponent);
  std::optional<DiscreteHit> hit;
  {
    const DenormalsAreZero guard;
    hit = impl_->intersect(scaled.ray, time, scaled_max, facing);
  }
  if (hit) hit->dist = scaled.to_given(hit->dist);
  return hit;
}

void DiscreteScene::intersect(std::span<const Ray> rays, std::span<const float> times,
                              std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const {
  if (rays.size() != times.size() || rays.size() != hits.size())
    throw Error(ErrorCode::bad_usage, "DiscreteScene", "as many rays as times and hits are needed");
  if (impl_->exponent != 0 ||
      std::any_of(rays.begin(), rays.end(), [](const Ray& ray) { return ScaledRay(ray).exponent != 0; })) {
    std::vector<ScaledRay> scaled;
    std::vector<Ray> scaled_rays;
    for (const Ray& ray : rays) scaled_rays.push_back(scaled.emplace_back(ray, impl_->exponent).ray);
    impl_->intersect_all(scaled_rays, times, hits, layer);
    for (size_t i = 0; i < rays.size(); ++i)
      if (hits[i]) hits[i]->dist = scaled[i].to_given(hits[i]->dist);
    return;
  }
  impl_->intersect_all(rays, times, hits, layer);
}

void DiscreteScene::Impl::intersect_all(std::span<const Ray> rays, std::span<const float> times,
                                        std::span<std::optional<DiscreteHit>> hits, DiscreteLayer layer) const {
  const DenormalsAreZero guard;
  for (size_t i = 0; i < rays.size();) {
    const size_t left = rays.size() - i, count = std::min(left, left > kSmallPacket ? kLargePacket : kSmallPacket);
    const auto some_rays = rays.subspan(i, count);
    const auto some_times = times.subspan(i, count);
    const auto some_hits = hits.subspan(i, count);
    if (count > kSmallPacket)
      intersect_packet<LargePacket>(some_rays, some_times, some_hits, layer);
    else
      intersect_packet<SmallPacket>(some_rays, some_times, some_hits, layer);
    i += count;
  }
}

bool DiscreteScene::occluded(const Ray& ray, float time, float max_dist) const {
  const ScaledRay scaled(ray, impl_->exponent);  // before denormals become zero
  const float scaled_max = std::ldexp(max_dist, scaled.exponent);
  const DenormalsAreZero guard;
  return impl_->occluded(scaled.ray, time, scaled_max);
}

void DiscreteScene::occluded(std::span<const Ray> rays, std::span<const float> times, std::span<const float> max_dists,
                             std::span<bool> result) const {
  if (rays.size() != times.size() || rays.size() != max_dists.size() || rays.size() != result.size())
    throw Error(ErrorCode::bad_usage, "DiscreteScene", "as many rays as times, distances and results are needed");
  if (impl_->exponent != 0 ||
      std::any_of(rays.begin(), rays.end(), [](const Ray& ray) { return ScaledRay(ray).exponent != 0; })) {
    for (size_t i = 0; i < rays.size(); ++i) result[i] = occluded(rays[i], times[i], max_dists[i]);
    return;
  }
  impl_->occluded_all(rays, times, max_dists, result);
}

void DiscreteScene::Impl::occluded_all(std::span<const Ray> rays, std::span<const float> times,
                                       std::span<const float> max_dists, std::span<bool> result) const {
  const DenormalsAreZero guard;
  for (size_t i = 0; i < rays.size();) {
    const size_t left = rays.size() - i, count = std::min(left, left > kSmallPacket ? kLargePacket : kSmallPacket);
    const auto take = [&](auto whole) { return whole.subspan(i, count); };
    if (left == 1)
      result[i] = occluded(rays[i], times[i], max_dists[i]);
    else if (count > kSmallPacket)
      occluded_packet<LargePacket>(take(rays), take(times), take(max_dists), take(result));
    else
      occluded_packet<SmallPacket>(take(rays), take(times), take(max_dists), take(result));
    i += count;
  }
}

std::optional<DiscreteHit> DiscreteScene::intersect_panes(const Ray& ray, float time, float max_dist) const {
  return panes_ ? panes_->intersect(ray, time, max_dist, Facing::far_end) : std::nullopt;
}

const DiscreteStats& DiscreteScene::stats() const { return impl_->stats; }
size_t DiscreteScene::memory_bytes() const {
  size_t bytes = impl_->device.memory_bytes() + impl_->mesh_of.capacity() * sizeof(uint32_t);
  for (const auto& triangles : impl_->uneven) bytes += triangles->memory_bytes();
  for (const PlacedObject& object : impl_->placed) bytes += sizeof(object) + object.memory_bytes();
  return bytes + (panes_ ? panes_->memory_bytes() : 0);
}

}  // namespace kairos
