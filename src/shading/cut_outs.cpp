#include "shading/cut_outs.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/hash.h"
#include "shading/surface.h"

namespace kairos {

namespace {
constexpr float kTimeTolerance = 1e-4f;  // shutter time
constexpr int kMostProbes = 256;
constexpr float kLeastProbes = 2;
// Alpha of vertices goes over a triangle without a bend; what a ray passes of it while the triangle moves crosses the
// cut-off a few times at most.
constexpr float kVertexProbes = 16;

uint64_t bits_of(float a, float b) {
  return static_cast<uint64_t>(std::bit_cast<uint32_t>(a)) << 32 | std::bit_cast<uint32_t>(b);
}
}  // namespace

AlphaCutOuts::AlphaCutOuts(const Shot& shot, const Looks& looks) : shot_(shot), looks_(looks), cone_(shot.projection) {
  for (uint32_t m = 0; m < shot.meshes.size(); ++m) {
    kinds_.push_back(kind_of(m));
    any_ = any_ || has(m);
  }
}

AlphaCutOuts::Kind AlphaCutOuts::kind_of(uint32_t mesh) const {
  const Material& material = looks_.material(mesh);
  const bool varies = looks_.alpha_varies(mesh);
  switch (material.alpha_mode) {
    case Material::AlphaMode::opaque:
      break;
    case Material::AlphaMode::mask:
      return varies || material.alpha < material.alpha_cutoff ? Kind::cut_out : Kind::whole;
    case Material::AlphaMode::blend:  // many exporters say so of all materials
      return varies || material.alpha < 1 ? Kind::blended : Kind::whole;
  }
  return Kind::whole;
}

AlphaPoint AlphaCutOuts::at(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const {
  const std::array<Vec3d, 3> vertices = triangle_at(shot_.meshes[mesh], triangle, time);
  const std::array<float, 3> weights = barycentrics(vertices, ray);
  return looks_.alpha_at(mesh, triangle, vertices, weights, cone_.width_at(point_of(vertices, weights), ray));
}

float AlphaCutOuts::opacity(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const {
  const float alpha = at(ray, mesh, triangle, time).alpha;
  return alpha > 0 ? std::min(alpha, 1.0f) : 0;
}

bool AlphaCutOuts::solid(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const {
  if (is_blended(mesh)) {
    const Vec3f &from = ray.origin, &way = ray.direction;
    const uint64_t chance = hash(bits_of(from.x, from.y), bits_of(from.z, time), bits_of(way.x, way.y),
                                 bits_of(way.z, 0), static_cast<uint64_t>(mesh) << 32 | triangle);
    return unit_float(chance) < opacity(ray, mesh, triangle, time);
  }
  return at(ray, mesh, triangle, time).alpha >= looks_.material(mesh).alpha_cutoff;
}

void AlphaCutOuts::solid_times(const Ray& ray, const Segment& hit, std::vector<float>& times) const {
  times.clear();
  const float cutoff = looks_.material(hit.mesh).alpha_cutoff;
  const AlphaPoint first = at(ray, hit.mesh, hit.triangle, hit.begin), last = at(ray, hit.mesh, hit.triangle, hit.end);
  const float texels = std::hypot(last.place.x - first.place.x, last.place.y - first.place.y);
  const float wanted =  // which may be no number
      2 * texels + (looks_.has_vertex_alpha(hit.mesh) ? kVertexProbes : kLeastProbes);
  const int probes = wanted < static_cast<float>(kMostProbes) ? static_cast<int>(wanted) : kMostProbes;

  bool was_solid = first.alpha >= cutoff;
  float before = hit.begin;
  if (was_solid) times.push_back(hit.begin);
  for (int i = 1; i <= probes; ++i) {
    const float time =
        i == probes ? hit.end : hit.begin + hit.duration() * (static_cast<float>(i) / static_cast<float>(probes));
    const bool is_solid = i == probes ? last.alpha >= cutoff : solid(ray, hit.mesh, hit.triangle, time);
    if (is_solid != was_solid) {
      float low = before, high = time;
      while (high - low > kTimeTolerance) {
        const float middle = 0.5f * (low + high);
        (solid(ray, hit.mesh, hit.triangle, middle) == was_solid ? low : high) = middle;
      }
      times.push_back(0.5f * (low + high));
    }
    was_solid = is_solid;
    before = time;
  }
  if (was_solid) times.push_back(hit.end);
}

}  // namespace kairos
