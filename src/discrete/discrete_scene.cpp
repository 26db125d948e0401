#include "discrete/discrete_scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <kairos/error.h>

#include "base/parallel.h"
#include "discrete/embree_device.h"
#include "discrete/uniform_runs.h"

namespace kairos {

namespace {

static_assert(kMaxTimeSteps == RTC_MAX_TIME_STEP_COUNT);

constexpr size_t kPacket = 8;

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

}  // namespace

struct DiscreteScene::Impl {
  // In this order: scenes are gone before the device is.
  EmbreeDevice device;
  EmbreeScene still, moving;      // null where there is nothing of the kind
  std::vector<uint32_t> mesh_of;  // [Embree's geometry number]; one numbering for both scenes
  DiscreteStats stats;

  Impl(std::span<const Mesh> meshes, const DiscreteOptions& options) {
    const auto begin = std::chrono::steady_clock::now();
    for (size_t m = 0; m < meshes.size(); ++m) {
      const Mesh& mesh = meshes[m];
      validate_mesh(mesh);
      stats.triangles += mesh.triangles.size();
      if (mesh.triangles.empty()) continue;
      if (mesh.is_static()) {
        attach(still, options, mesh, {0, 0}, static_cast<uint32_t>(m));
        ++stats.static_geometries;
        continue;
      }
      for (const UniformRun& run : uniform_runs(mesh.key_times)) {
        attach(moving, options, mesh, run, static_cast<uint32_t>(m));
        ++stats.moving_geometries;
      }
    }
    // A thread that waits for Embree's locks must not take up work that waits for them too.
    isolate([&] {
      for (const EmbreeScene* scene : {&still, &moving})
        if (*scene) rtcCommitScene(scene->get());
    });
    device.check();
    stats.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  void attach(EmbreeScene& scene, const DiscreteOptions& options, const Mesh& mesh, UniformRun run, uint32_t index) {
    if (!scene) {
      scene.reset(rtcNewScene(device.get()));
      device.check();
      rtcSetSceneFlags(scene.get(), options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    }
    const EmbreeGeometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    device.check();
    fill_buffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles, device);
    rtcSetGeometryTimeStepCount(geometry.get(), static_cast<unsigned>(run.last - run.first + 1));
    if (run.last > run.first) {
      // Embree takes a range as half-open, but for one that ends at 1: just as jumps ask for.
      const float begin = mesh.key_times[run.first], end = mesh.key_times[run.last];
      if (begin != 0 || end != 1) rtcSetGeometryTimeRange(geometry.get(), begin, end);
    }
    for (size_t key = run.first; key <= run.last; ++key)
      fill_buffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(key - run.first), RTC_FORMAT_FLOAT3,
                  mesh.positions[key], device);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene.get(), geometry.get(), static_cast<unsigned>(mesh_of.size()));
    device.check();
    mesh_of.push_back(index);
  }

  /// Denormals must be zero already.
  std::optional<DiscreteHit> intersect(const Ray& ray, float time) const {
    if (!usable(ray, time)) return std::nullopt;
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x;
    query.ray.org_y = ray.origin.y;
    query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x;
    query.ray.dir_y = ray.direction.y;
    query.ray.dir_z = ray.direction.z;
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.time = time;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (const EmbreeScene* scene : {&still, &moving})  // the second looks no farther than the first one's hit
      if (*scene) rtcIntersect1(scene->get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const Vec3f normal{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
    return DiscreteHit{query.ray.tfar, mesh_of[query.hit.geomID],   query.hit.primID, query.hit.u,
                       query.hit.v,    faces(normal, ray.direction)};
  }

  /// Up to kPacket rays; denormals must be zero already.
  void intersect_packet(std::span<const Ray> rays, std::span<const float> times,
                        std::span<std::optional<DiscreteHit>> hits) const {
    RTCRayHit8 query{};
    alignas(32) int valid[kPacket]{};
    for (size_t i = 0; i < rays.size(); ++i) {
      if (!usable(rays[i], times[i])) continue;
      valid[i] = -1;
      query.ray.org_x[i] = rays[i].origin.x;
      query.ray.org_y[i] = rays[i].origin.y;
      query.ray.org_z[i] = rays[i].origin.z;
      query.ray.dir_x[i] = rays[i].direction.x;
      query.ray.dir_y[i] = rays[i].direction.y;
      query.ray.dir_z[i] = rays[i].direction.z;
      query.ray.tfar[i] = std::numeric_limits<float>::infinity();
      query.ray.time[i] = times[i];
      query.ray.mask[i] = ~0u;
    }
    std::fill(std::begin(query.hit.geomID), std::end(query.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (const EmbreeScene* scene : {&still, &moving})
      if (*scene) rtcIntersect8(valid, scene->get(), &context, &query);
    for (size_t i = 0; i < rays.size(); ++i) {
      hits[i].reset();
      const uint32_t geometry = query.hit.geomID[i];
      if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
      const Vec3f normal{query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]};
      hits[i] = DiscreteHit{query.ray.tfar[i], mesh_of[geometry], query.hit.primID[i],
                            query.hit.u[i],    query.hit.v[i],    faces(normal, rays[i].direction)};
    }
  }
};

DiscreteScene::DiscreteScene(std::span<const Mesh> meshes, const DiscreteOptions& options)
    : impl_(std::make_unique<Impl>(meshes, options)) {}
DiscreteScene::~DiscreteScene() = default;
DiscreteScene::DiscreteScene(DiscreteScene&&) noexcept = default;
DiscreteScene& DiscreteScene::operator=(DiscreteScene&&) noexcept = default;

std::optional<DiscreteHit> DiscreteScene::intersect(const Ray& ray, float time) const {
  const DenormalsAreZero guard;
  return impl_->intersect(ray, time);
}

void DiscreteScene::intersect(std::span<const Ray> rays, std::span<const float> times,
                              std::span<std::optional<DiscreteHit>> hits) const {
  if (rays.size() != times.size() || rays.size() != hits.size())
    throw Error(ErrorCode::bad_usage, "DiscreteScene", "as many rays as times and hits are needed");
  const DenormalsAreZero guard;
  for (size_t i = 0; i < rays.size(); i += kPacket) {
    const size_t count = std::min(kPacket, rays.size() - i);
    impl_->intersect_packet(rays.subspan(i, count), times.subspan(i, count), hits.subspan(i, count));
  }
}

const DiscreteStats& DiscreteScene::stats() const { return impl_->stats; }
size_t DiscreteScene::memory_bytes() const {
  return impl_->device.memory_bytes() + impl_->mesh_of.capacity() * sizeof(uint32_t);
}

}  // namespace kairos
