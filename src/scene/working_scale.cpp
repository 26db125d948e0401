#include "scene/working_scale.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "scene/instances.h"

namespace kairos {

namespace {

/// Binary exponents of mean coordinates that are left as they are: a millimetre to ten kilometres, in metres.
constexpr int64_t kLeastExponent = -10, kMostExponent = 14;
constexpr int kMostScale = 126;  // the reciprocal of two to this power is still a float with all of its digits
constexpr size_t kVerticesAtOnce = 1 << 16;

struct ExponentSum {
  int64_t sum = 0, count = 0;
};

ExponentSum exponents_of(std::span<const Vec3f> positions) {
  ExponentSum exponents;
  for (const Vec3f& p : positions) {
    const float size = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    if (!(size > 0)) continue;
    exponents.sum += std::ilogb(size);
    ++exponents.count;
  }
  return exponents;
}

class ScaledCutOuts : public CutOuts {
 public:
  ScaledCutOuts(std::shared_ptr<const CutOuts> cut_outs, int exponent)
      : cut_outs_(std::move(cut_outs)), back_(std::ldexp(1.0f, -exponent)) {}
  bool has(uint32_t mesh) const override { return cut_outs_->has(mesh); }
  bool is_blended(uint32_t mesh) const override { return cut_outs_->is_blended(mesh); }
  bool solid(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const override {
    return cut_outs_->solid(as_given(ray), mesh, triangle, time);
  }
  void solid_times(const Ray& ray, const Segment& hit, std::vector<float>& times) const override {
    cut_outs_->solid_times(as_given(ray), hit, times);
  }

 private:
  Ray as_given(const Ray& ray) const { return {ray.origin * back_, ray.direction}; }

  std::shared_ptr<const CutOuts> cut_outs_;
  float back_;
};

}  // namespace

int working_exponent(std::span<const Mesh> meshes) {
  ExponentSum all;
  ObjectCorners corners;
  for (const Mesh& mesh : meshes) {
    for (const AffineMap& map : mesh.placements) {  // in place of all vertices, the corners of their box
      std::array<Vec3f, 8> placed = corners.of(*mesh.object);
      for (Vec3f& corner : placed) corner = map.point(corner);
      const ExponentSum sum = exponents_of(placed);
      const int64_t weight = static_cast<int64_t>(mesh.vertex_count() / placed.size()) + 1;
      all.sum += sum.sum * weight;
      all.count += sum.count * weight;
    }
    for (const std::vector<Vec3f>& key : mesh.positions) {
      std::vector<ExponentSum> pieces((key.size() + kVerticesAtOnce - 1) / kVerticesAtOnce);
      parallel_for(pieces.size(), 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
          pieces[i] = exponents_of(
              std::span(key).subspan(i * kVerticesAtOnce, std::min(kVerticesAtOnce, key.size() - i * kVerticesAtOnce)));
      });
      for (const ExponentSum& piece : pieces) {
        all.sum += piece.sum;
        all.count += piece.count;
      }
    }
  }
  if (all.count == 0) return 0;
  // Rounded down: the mean of a scene that is 2^k times as large is k more, exactly.
  const int64_t mean = all.sum / all.count - (all.sum % all.count < 0 ? 1 : 0);
  if (mean >= kLeastExponent && mean <= kMostExponent) return 0;
  return static_cast<int>(std::clamp<int64_t>(-mean, -kMostScale, kMostScale));
}

namespace {
/// Without what tracing has no use for.
Mesh scaled_copy(const Mesh& mesh, float scale) {
  Mesh copy;
  copy.name = mesh.name;
  copy.triangles = mesh.triangles;
  copy.key_times = mesh.key_times;
  copy.positions = mesh.positions;
  copy.material = mesh.material;
  copy.one_sided = mesh.one_sided;
  copy.placements = mesh.placements;
  for (std::vector<Vec3f>& key : copy.positions)
    parallel_for(key.size(), kVerticesAtOnce, [&](size_t first, size_t last) {
      for (size_t v = first; v < last; ++v) key[v] = key[v] * scale;
    });
  // The object is scaled itself.
  for (AffineMap& map : copy.placements)
    for (Vec4f& row : map.rows) row.w *= scale;
  return copy;
}
}  // namespace

std::vector<Mesh> scaled_copies(std::span<const Mesh> meshes, int exponent) {
  const float scale = std::ldexp(1.0f, exponent);
  std::map<const Mesh*, std::shared_ptr<const Mesh>> objects;
  std::vector<Mesh> copies;
  copies.reserve(meshes.size());
  for (const Mesh& mesh : meshes) {
    Mesh& copy = copies.emplace_back(scaled_copy(mesh, scale));
    if (!mesh.object) continue;
    std::shared_ptr<const Mesh>& object = objects[mesh.object.get()];
    if (!object) object = std::make_shared<const Mesh>(scaled_copy(*mesh.object, scale));
    copy.object = object;
  }
  return copies;
}

std::shared_ptr<const CutOuts> scaled_cut_outs(std::shared_ptr<const CutOuts> cut_outs, int exponent) {
  if (!cut_outs) return nullptr;
  return std::make_shared<const ScaledCutOuts>(std::move(cut_outs), exponent);
}

}  // namespace kairos
