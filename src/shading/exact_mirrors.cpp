#include "shading/exact_mirrors.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "discrete/occluder_hint.h"
#include "math/hash.h"
#include "shading/layers.h"
#include "shading/reflectance.h"

namespace kairos {

namespace {

constexpr uint64_t kPassingBranch = 22;  // of a sample's key, beside those of shading

}  // namespace

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
    if (weight < kLeastExact) continue;
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

void PassingInMirrors::look(const ExactMirrors& mirrors, const Ray& ray, uint32_t mesh, uint32_t triangle, float dist,
                            SampleKey key, const TimeRange& window, StepSum& sum) {
  changes_ = false;
  open_.clear();
  open_.push_back({{ray, mesh, triangle, window.begin, mirrors.shader().width_at(dist), key.branch(kPassingBranch)},
                   {1, 1, 1},
                   window.begin,
                   window.end});
  while (!open_.empty()) {
    const Seen seen = open_.back();
    open_.pop_back();
    onwards_.clear();
    mirrors.shader().lit().followed_rays(seen.query, onwards_);
    for (const FollowedRay& onwards : onwards_)
      if (seen.query.weight * largest(onwards.share) >= kLeastExact) follow(mirrors, seen, onwards, sum);
  }
}

void PassingInMirrors::follow(const ExactMirrors& mirrors, const Seen& seen, const FollowedRay& onwards, StepSum& sum) {
  const Shader& shader = mirrors.shader();
  const Vec3f share = seen.share * onwards.share;
  std::optional<DiscreteHit> still;
  mirrors.scene().intersect({&onwards.ray, 1}, {&seen.begin, 1}, {&still, 1}, DiscreteLayer::still);
  const Segment hint = occluder_hint(still);
  const auto all = mirrors.tracer().trace_packet({&onwards.ray, 1}, Visibility::visible, workspace_, {&hint, 1}, false,
                                                 {seen.begin, seen.end});
  uint64_t number = 0;
  for (const Segment& segment : all[0].segments) {
    const auto query_of = [&](uint32_t mesh, uint32_t triangle, float time, float dist) {
      ShadingQuery query{
          onwards.ray, mesh, triangle, time, shader.width_beyond(onwards.width, dist), seen.query.key.branch(number)};
      query.depth = seen.query.depth + 1;
      query.weight = seen.query.weight * largest(onwards.share);
      return query;
    };
    ++number;
    if (shader.shot().meshes[segment.mesh].is_static()) {
      if (mirrors.on(segment.mesh))
        open_.push_back({query_of(segment.mesh, segment.triangle, segment.begin, segment.dist_begin), share,
                         segment.begin, segment.end});
      continue;
    }
    changes_ = true;
    // Where the pixel's sample lies in its own shutter, this one lies in the segment.
    const float place = unit_float(hash(seen.query.key.seed, seen.query.key.index, kPassingBranch, number));
    const float time = std::min(segment.begin + segment.duration() * place, std::nextafter(segment.end, 0.0f));
    const ShadingQuery moving = query_of(segment.mesh, segment.triangle, time, distance_at(segment, time));
    Vec3f there, behind;
    shader.lit().radiance({&moving, 1}, {&there, 1});
    if (still) {
      ShadingQuery resting = query_of(still->mesh, still->triangle, time, still->dist);
      resting.still_in = &mirrors.meshes();
      shader.lit().radiance({&resting, 1}, {&behind, 1});
    } else {
      behind = shader.lit().beyond(onwards.ray, time);
    }
    evaluations_ += 2;
    sum.add(segment.begin, segment.end, share * (there - behind));
  }
}

}  // namespace kairos
