// How a scene for discrete rays is built.
#include <algorithm>
#include <chrono>
#include <cstring>

#include "base/parallel.h"
#include "discrete/discrete_impl.h"
#include "discrete/key_stretches.h"
#include "scene/instances.h"

namespace kairos {

namespace {

static_assert(kMaxTimeSteps == RTC_MAX_TIME_STEP_COUNT);

/// That nothing of a geometry occludes.
void refuse_all(const RTCFilterFunctionNArguments* hits) { std::fill_n(hits->valid, hits->N, 0); }

template <class Element>
void fill_buffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format,
                 const std::vector<Element>& source, EmbreeDevice& device) {
  void* data = rtcSetNewGeometryBuffer(geometry, type, slot, format, sizeof(Element), source.size());
  device.check();
  std::memcpy(data, source.data(), source.size() * sizeof(Element));
}

std::vector<Vec3f> between(const std::vector<Vec3f>& from, const std::vector<Vec3f>& to, float place) {
  std::vector<Vec3f> points(from.size());
  for (size_t i = 0; i < points.size(); ++i)
    points[i] = to_float(lerp(to_double(from[i]), to_double(to[i]), static_cast<double>(place)));
  return points;
}

}  // namespace

template <bool kOneSided, bool kHasHoles>
void DiscreteScene::Impl::refuse_hits(const RTCFilterFunctionNArguments* hits) {
  const auto& self = *static_cast<const Impl*>(hits->geometryUserPtr);
  const auto& context = *reinterpret_cast<const DiscreteContext*>(hits->context);
  for (unsigned i = 0; i < hits->N; ++i) {
    if (hits->valid[i] != -1) continue;
    const unsigned ray = RTCRayN_id(hits->ray, hits->N, i);
    const unsigned instance = RTCHitN_instID(hits->hit, hits->N, i, 0);
    if constexpr (kOneSided) {
      const Vec3f normal = self.normal_of_hit({RTCHitN_Ng_x(hits->hit, hits->N, i), RTCHitN_Ng_y(hits->hit, hits->N, i),
                                               RTCHitN_Ng_z(hits->hit, hits->N, i)},
                                              instance, RTCRayN_time(hits->ray, hits->N, i));
      if (faces_ray(normal, context.rays[ray].direction) != (context.facing == Facing::origin)) {
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

DiscreteScene::Impl::Impl(std::span<const Mesh> meshes, const DiscreteOptions& options)
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
    for (const DiscreteWindow& window : windows) rtcCommitScene(window.scene.get());
  });
  device.check();
  stats.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void DiscreteScene::Impl::add_window(float begin, float end, bool moves, const DiscreteOptions& options) {
  windows.push_back({begin, end, moves, new_scene(options)});
}
EmbreeScene DiscreteScene::Impl::new_scene(const DiscreteOptions& options) {
  EmbreeScene scene(rtcNewScene(device.get()));
  device.check();
  rtcSetSceneFlags(scene.get(), options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  return scene;
}

void DiscreteScene::Impl::set_refusals(RTCGeometry geometry, const Object& object) {
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

RTCScene DiscreteScene::Impl::scene_of(const Object& object, const DiscreteOptions& options) {
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

unsigned DiscreteScene::Impl::number_for(uint32_t mesh, PlacedObject where) {
  if (where.steps() > 0 || !placed.empty()) {
    placed.resize(mesh_of.size());
    placed.push_back(std::move(where));
  }
  mesh_of.push_back(mesh);
  return static_cast<unsigned>(mesh_of.size() - 1);
}

void DiscreteScene::Impl::attach_instance(const DiscreteWindow& window, const Mesh& mesh, UniformRun run, size_t parts,
                                          uint32_t index, const DiscreteOptions& options) {
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

void DiscreteScene::Impl::attach(const DiscreteWindow& window, const Mesh& mesh, UniformRun run, size_t parts,
                                 uint32_t index, const DiscreteOptions& options) {
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

void DiscreteScene::Impl::attach_uneven(const DiscreteWindow& window, const Mesh& mesh, uint32_t index,
                                        int least_steps) {
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

}  // namespace kairos
