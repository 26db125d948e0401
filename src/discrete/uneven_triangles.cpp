#include "discrete/uneven_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "discrete/uniform_runs.h"

namespace kairos {

namespace {

/// What Embree may err by where it interpolates boxes: a few roundings of places, in units of the largest coordinate,
/// and of the time between two of up to 129 steps, in units of what is swept in between.
constexpr double kPlaceRounding = 5e-7, kTimeRounding = 2e-5;

Vec3d least(Vec3d a, Vec3d b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3d most(Vec3d a, Vec3d b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

double largest(Vec3d a) { return std::max({a.x, a.y, a.z}); }

}  // namespace

/// In double precision, and without a gap between triangles that share two corners: what is subtracted at their common
/// edge are the same products.
bool UnevenTriangles::intersect(const Corners& corners, const Ray& ray, Hit& hit) {
  const Vec3d origin = to_double(ray.origin), way = to_double(ray.direction);
  const Vec3d a = corners[0] - origin, b = corners[1] - origin, c = corners[2] - origin;
  const double wa = dot(way, cross(b, c)), wb = dot(way, cross(c, a)), wc = dot(way, cross(a, b));
  if (!((wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0))) return false;
  const double sum = wa + wb + wc;
  if (sum == 0) return false;
  hit.u = wb / sum;
  hit.v = wc / sum;
  hit.dist = dot(a * (wa / sum) + b * hit.u + c * hit.v, way) / dot(way, way);
  hit.normal = cross(b - a, c - a);
  return true;
}

UnevenTriangles::UnevenTriangles(const Mesh& mesh, uint32_t index, const CutOuts* cut_outs, int least_steps,
                                 bool is_pane)
    : triangles_(mesh.triangles),
      key_times_(mesh.key_times),
      index_(index),
      cut_outs_(cut_outs),
      one_sided_(mesh.one_sided),
      is_pane_(is_pane) {
  positions_.reserve(mesh.key_count() * mesh.vertex_count());
  for (size_t v = 0; v < mesh.vertex_count(); ++v)
    for (const auto& key : mesh.positions) positions_.push_back(key[v]);
  // As many as there are keys: twice as many make tighter boxes, yet a tree of twice the bytes in which rays are
  // slower.
  const size_t wanted = std::max(key_times_.size(), static_cast<size_t>(std::max(0, least_steps)));
  steps_ = static_cast<uint32_t>(std::min(wanted, kMaxTimeSteps));
  pair_triangles();
}

/// By the boxes when the shutter opens: two are one where that has no more surface than both have.
void UnevenTriangles::pair_triangles() {
  const auto surface = [](const Box& box) {
    const Vec3d size = box.high - box.low;
    return size.x * size.y + size.y * size.z + size.z * size.x;
  };
  const auto count = static_cast<uint32_t>(triangles_.size());
  const auto box_of = [&](uint32_t triangle) { return box_at(triangles_[triangle], 0); };
  first_of_.reserve(count / 2 + 1);
  for (uint32_t t = 0; t < count;) {
    first_of_.push_back(t++);
    if (t == count) break;
    const Box a = box_of(t - 1), b = box_of(t);
    if (surface({least(a.low, b.low), most(a.high, b.high)}) <= surface(a) + surface(b)) ++t;
  }
  first_of_.push_back(count);
  first_of_.shrink_to_fit();
}

void UnevenTriangles::fill(RTCGeometry geometry) const {
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(first_of_.size() - 1));
  rtcSetGeometryTimeStepCount(geometry, steps_);
  rtcSetGeometryUserData(geometry, const_cast<UnevenTriangles*>(this));  // handed back to us as const again
  rtcSetGeometryBoundsFunction(geometry, bounds_function, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_function);
  rtcSetGeometryOccludedFunction(geometry, is_pane_ ? occluded_by_none : occluded_function);
}

size_t UnevenTriangles::memory_bytes() const {
  return sizeof(*this) + triangles_.capacity() * sizeof(Triangle) + first_of_.capacity() * sizeof(uint32_t) +
         key_times_.capacity() * sizeof(float) + positions_.capacity() * sizeof(Vec3f);
}

UnevenTriangles::Corners UnevenTriangles::corners_at(const Triangle& triangle, Place place) const {
  Corners corners;
  for (size_t i = 0; i < 3; ++i) {
    const Vec3f* here = &positions_[triangle[i] * key_times_.size() + place.key];
    corners[i] = place.weight > 0 ? lerp(to_double(here[0]), to_double(here[1]), place.weight) : to_double(here[0]);
  }
  return corners;
}

UnevenTriangles::Place UnevenTriangles::place_of(float time) const {
  const auto begin = key_times_.begin(), end = key_times_.end();
  // When the shutter closes, the mesh is where it was until then.
  const auto next = time < 1 ? std::upper_bound(begin, end, time) : std::lower_bound(begin, end, time);
  const double first = *(next - 1), last = *next;
  return {static_cast<size_t>(next - begin) - 1, (time - first) / (last - first)};
}

UnevenTriangles::Box UnevenTriangles::box_at(const Triangle& triangle, double time) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  const auto add = [&](const Corners& corners) {
    for (const Vec3d& corner : corners) {
      box.low = least(box.low, corner);
      box.high = most(box.high, corner);
    }
  };
  const auto begin = key_times_.begin(), end = key_times_.end();
  const auto first = std::lower_bound(begin, end, time), behind = std::upper_bound(first, end, time);
  for (auto key = first; key != behind; ++key) add(corners_at(triangle, Place{static_cast<size_t>(key - begin), 0}));
  if (first == behind) {
    const double before = *(first - 1), after = *first;
    add(corners_at(triangle, Place{static_cast<size_t>(first - begin) - 1, (time - before) / (after - before)}));
  }
  return box;
}

RTCBounds UnevenTriangles::bounds(const Triangle& triangle, uint32_t step) const {
  const Box here = box_at(triangle, time_of(step));
  Box swept = here;
  const auto sweep = [&](const Box& box) {
    swept.low = least(swept.low, box.low);
    swept.high = most(swept.high, box.high);
  };
  Vec3d below, above;  // how far a bend between this step and a neighbouring one lies outside of the straight line
  for (const uint32_t other : {step - 1, step + 1}) {  // the one before the first is as large as a number can be
    if (other >= steps_) continue;
    const Box there = box_at(triangle, time_of(other));
    sweep(there);
    const double from = time_of(std::min(step, other)), to = time_of(std::max(step, other));
    auto key = std::upper_bound(key_times_.begin(), key_times_.end(), from);
    for (; key != key_times_.end() && *key < to; ++key) {
      const double weight = (*key - time_of(step)) / (time_of(other) - time_of(step));
      const Box bend = box_at(triangle, static_cast<double>(*key));
      sweep(bend);
      below = most(below, lerp(here.low, there.low, weight) - bend.low);
      above = most(above, bend.high - lerp(here.high, there.high, weight));
    }
  }
  const double slack =
      kPlaceRounding * largest(most(-swept.low, swept.high)) + kTimeRounding * largest(swept.high - swept.low);
  const Vec3f low = to_float(here.low - below - Vec3d{slack, slack, slack});
  const Vec3f high = to_float(here.high + above + Vec3d{slack, slack, slack});
  return {low.x, low.y, low.z, 0, high.x, high.y, high.z, 0};
}

void UnevenTriangles::bounds_function(const RTCBoundsFunctionArguments* args) {
  const auto& self = *static_cast<const UnevenTriangles*>(args->geometryUserPtr);
  const uint32_t first = self.first_of(args->primID), last = self.first_of(args->primID + 1);
  RTCBounds& all = *args->bounds_o;
  all = self.bounds(self.triangles_[first], args->timeStep);
  for (uint32_t t = first + 1; t < last; ++t) {
    const RTCBounds one = self.bounds(self.triangles_[t], args->timeStep);
    all.lower_x = std::min(all.lower_x, one.lower_x);
    all.lower_y = std::min(all.lower_y, one.lower_y);
    all.lower_z = std::min(all.lower_z, one.lower_z);
    all.upper_x = std::max(all.upper_x, one.upper_x);
    all.upper_y = std::max(all.upper_y, one.upper_y);
    all.upper_z = std::max(all.upper_z, one.upper_z);
  }
}

bool UnevenTriangles::meets(uint32_t triangle, const DiscreteContext& context, unsigned ray_number, Place place,
                            float nearest, Hit& hit) const {
  const Ray& ray = context.rays[ray_number];
  if (!intersect(corners_at(triangles_[triangle], place), ray, hit)) return false;
  const auto dist = static_cast<float>(hit.dist);
  if (!(dist > 0 && dist < nearest)) return false;
  const bool front = dot(hit.normal, to_double(ray.direction)) < 0;
  if (one_sided_ && front != (context.facing == Facing::origin)) return false;
  return cut_outs_ == nullptr || cut_outs_->solid(ray, index_, triangle, context.times[ray_number]);
}

void UnevenTriangles::intersect_function(const RTCIntersectFunctionNArguments* args) {
  const auto& self = *static_cast<const UnevenTriangles*>(args->geometryUserPtr);
  const auto& context = *reinterpret_cast<const DiscreteContext*>(args->context);
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const unsigned ray = RTCRayN_id(rays, args->N, i);
    const Place place = self.place_of(context.times[ray]);
    for (uint32_t t = self.first_of(args->primID); t < self.first_of(args->primID + 1); ++t) {
      Hit hit;
      if (!self.meets(t, context, ray, place, RTCRayN_tfar(rays, args->N, i), hit)) continue;
      const Vec3f normal = to_float(normalize(hit.normal));
      RTCRayN_tfar(rays, args->N, i) = static_cast<float>(hit.dist);
      RTCHitN_u(hits, args->N, i) = static_cast<float>(hit.u);
      RTCHitN_v(hits, args->N, i) = static_cast<float>(hit.v);
      RTCHitN_Ng_x(hits, args->N, i) = normal.x;
      RTCHitN_Ng_y(hits, args->N, i) = normal.y;
      RTCHitN_Ng_z(hits, args->N, i) = normal.z;
      RTCHitN_primID(hits, args->N, i) = t;
      RTCHitN_geomID(hits, args->N, i) = args->geomID;
    }
  }
}

void UnevenTriangles::occluded_function(const RTCOccludedFunctionNArguments* args) {
  const auto& self = *static_cast<const UnevenTriangles*>(args->geometryUserPtr);
  const auto& context = *reinterpret_cast<const DiscreteContext*>(args->context);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const unsigned ray = RTCRayN_id(args->ray, args->N, i);
    const Place place = self.place_of(context.times[ray]);
    float& nearest = RTCRayN_tfar(args->ray, args->N, i);
    for (uint32_t t = self.first_of(args->primID); t < self.first_of(args->primID + 1); ++t) {
      Hit hit;
      if (!self.meets(t, context, ray, place, nearest, hit)) continue;
      nearest = -std::numeric_limits<float>::infinity();  // as Embree asks for
      break;
    }
  }
}

}  // namespace kairos
