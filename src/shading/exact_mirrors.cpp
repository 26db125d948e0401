#include "shading/exact_mirrors.h"

#include <algorithm>
#include <optional>

#include "discrete/occluder_hint.h"
#include "shading/reflectance.h"

namespace kairos {

float MirrorSights::follow(const ExactMirrors& mirrors, const Ray& ray, const Segment& seen) {
  const Shader& shader = mirrors.shader();
  size_t next = sights_.size();
  const float own =
      follow_one(mirrors, {ray, seen.mesh, seen.triangle, seen.begin, shader.width_at(seen.dist_begin), {}}, {1, 1, 1},
                 seen.begin, seen.end);
  for (; next < sights_.size(); ++next) {
    const Sight sight = sights_[next];
    for (uint32_t i = sight.first; i < sight.first + sight.count; ++i) {
      const Segment segment = seen_[i].segment;
      if (!mirrors.on(segment.mesh)) continue;
      const double width = shader.width_beyond(sight.width, segment.dist_begin);
      const ShadingQuery query{sight.ray, segment.mesh,         segment.triangle, segment.begin, width,
                               {},        RestingLights::as_is, sight.depth,      sight.weight};
      const float weight = follow_one(mirrors, query, sight.share, segment.begin, segment.end);
      seen_[i].weight = weight;
    }
  }
  return own;
}

float MirrorSights::follow_one(const ExactMirrors& mirrors, const ShadingQuery& query, Vec3f share, float begin,
                               float end) {
  onwards_.clear();
  float left = query.weight;
  mirrors.shader().lit().followed_rays(query, onwards_);
  for (const FollowedRay& onwards : onwards_) {
    const float weight = query.weight * largest(onwards.share);
    if (weight < kLeastWeight) continue;
    std::optional<DiscreteHit> still;
    mirrors.scene().intersect({&onwards.ray, 1}, {&begin, 1}, {&still, 1}, DiscreteLayer::still);
    const Segment hint = occluder_hint(still);
    const auto seen = mirrors.tracer().trace_packet({&onwards.ray, 1}, Visibility::visible, workspace_, {&hint, 1},
                                                    false, {begin, end});
    const auto first = static_cast<uint32_t>(seen_.size());
    for (const Segment& segment : seen[0].segments) seen_.push_back({segment, weight});
    sights_.push_back({onwards.ray, share * onwards.share, weight, onwards.width, query.depth + 1, begin, end, first,
                       static_cast<uint32_t>(seen[0].segments.size())});
    left -= weight;
  }
  return std::max(left, kLeastOwn * query.weight);
}

}  // namespace kairos
