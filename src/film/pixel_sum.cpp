#include "film/pixel_sum.h"

#include <algorithm>

namespace kairos {

void PixelSum::add(const ShadedRay& ray) {
  double filled = 0;
  for (const ShadedSegment& segment : ray.segments) {
    const double weight = ray.kind == ShadedRay::Kind::discrete
                              ? 1
                              : static_cast<double>(segment.end) - static_cast<double>(segment.begin);
    filled += weight;
    covered_ += weight * static_cast<double>(segment.coverage);
    colour_ += to_double(segment.colour) * weight;
    normal_ += to_double(segment.normal) * weight;
    albedo_ += to_double(segment.albedo) * weight;
    if (segment.mesh == kNoMesh) continue;
    depth_ = std::min({depth_, segment.dist_begin, segment.dist_end});
    if (!count_meshes_) continue;
    auto entry = std::find_if(mesh_weights_.begin(), mesh_weights_.end(),
                              [&](const auto& known) { return known.first == segment.mesh; });
    if (entry == mesh_weights_.end()) entry = mesh_weights_.insert(entry, {segment.mesh, 0});
    entry->second += weight;
  }
  colour_ += background_ * std::max(0.0, 1 - filled);
  visibility_segments_ += ray.visibility_segments;
  ++rays_;
}

void PixelSum::clear() {
  rays_ = visibility_segments_ = 0;
  colour_ = normal_ = albedo_ = {};
  covered_ = 0;
  depth_ = std::numeric_limits<float>::infinity();
  mesh_weights_.clear();
}

float PixelSum::visibility_segments() const {
  return rays_ == 0 ? 0 : static_cast<float>(static_cast<double>(visibility_segments_) / static_cast<double>(rays_));
}

uint32_t PixelSum::mesh_id() const {
  const auto most = std::max_element(mesh_weights_.begin(), mesh_weights_.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second < b.second : a.first > b.first;
  });
  return most == mesh_weights_.end() ? 0 : most->first + 1;
}

}  // namespace kairos
