#include "shading/exact_shadows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace kairos {

namespace {

/// Points farther apart than so many of the pixels that see them share little of what passes before a light.
constexpr double kPixelsApart = 32;

}  // namespace

void RestingLightSteps::clear() {
  points_.clear();
  links_.clear();
}

void RestingLightSteps::add_point(Vec3f own, double width) {
  for (const RestingLight& light : found_) links_.push_back({static_cast<uint32_t>(points_.size()), light});
  points_.push_back({own, width});
}

void RestingLightSteps::add(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle) {
  found_.clear();
  ShadingQuery query{ray, mesh, triangle, 0, 0, {}};  // at rest, all times are alike
  shadows.shader().resting_light(query, found_);
  add_point({}, query.width);
}

bool RestingLightSteps::add_with_all(const ExactShadows& shadows, ShadingQuery query, Shade& base) {
  found_.clear();
  if (!shadows.shader().steady_light(query, found_, base)) return false;
  add_point(base.colour, query.width);
  return true;
}

bool RestingLightSteps::go_together(const Link& a, const Link& b) const {
  if (a.light.way.direction != b.light.way.direction || std::isfinite(a.light.dist) || std::isfinite(b.light.dist))
    return false;
  const double apart = kPixelsApart * points_[a.point].width;
  const Vec3d between = to_double(a.light.way.origin) - to_double(b.light.way.origin);
  return dot(between, between) <= apart * apart;
}

void RestingLightSteps::look(const ExactShadows& shadows, const TimeRange& window) {
  changes_.clear();
  std::array<uint32_t, Tracer::kMaxPacket> together;
  for (uint32_t first = 0; first < links_.size(); ++first) {
    if (links_[first].done) continue;
    size_t count = 0;
    for (uint32_t i = first; i < links_.size() && count < together.size(); ++i) {
      if (links_[i].done || (i != first && !go_together(links_[first], links_[i]))) continue;
      links_[i].done = true;
      together[count++] = i;
    }
    trace(shadows, std::span(together).first(count), window);
  }
  make_steps(window);
}

void RestingLightSteps::trace(const ExactShadows& shadows, std::span<const uint32_t> links, const TimeRange& window) {
  std::array<Ray, Tracer::kMaxPacket> rays;
  std::array<float, Tracer::kMaxPacket> times{}, dists{};  // at rest, all times are alike
  std::array<bool, Tracer::kMaxPacket> hidden{};
  for (size_t i = 0; i < links.size(); ++i) {
    rays[i] = links_[links[i]].light.way;
    dists[i] = links_[links[i]].light.dist;
  }
  const auto first = [&](auto& all) { return std::span(all).first(links.size()); };
  shadows.scene().occluded(first(rays), first(times), first(dists), first(hidden), DiscreteLayer::still);
  std::array<uint32_t, Tracer::kMaxPacket> open;
  size_t count = 0;
  for (size_t i = 0; i < links.size(); ++i) {
    links_[links[i]].hidden = hidden[i];
    if (hidden[i]) continue;
    open[count] = links[i];
    rays[count++] = rays[i];
  }
  if (count == 0 || !(dists[0] > 0)) return;
  const TraceLimits limits{window.begin, window.end, dists[0]};  // of several, all are infinite
  const auto covered = shadows.tracer().occluded_packet(std::span(rays).first(count), workspace_, limits);
  for (size_t i = 0; i < count; ++i)
    for (const TimeRange& range : covered[i]) {
      changes_.push_back({links_[open[i]].point, range.begin, open[i], true});
      changes_.push_back({links_[open[i]].point, range.end, open[i], false});
    }
}

void RestingLightSteps::make_steps(const TimeRange& window) {
  // A light that is hidden again at the instant at which it appears stays hidden, whichever change comes last.
  std::sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) {
    return std::tie(a.point, a.time, a.link, a.hides) < std::tie(b.point, b.time, b.link, b.hides);
  });
  steps_.clear();
  auto change = changes_.begin();
  size_t first = 0;
  for (uint32_t p = 0; p < points_.size(); ++p) {
    Point& point = points_[p];
    size_t end = first;
    for (; end < links_.size() && links_[end].point == p; ++end)
      if (!links_[end].hidden) {
        ++point.lights;
        point.unhidden += links_[end].light.radiance;
      }
    const auto links = std::span(links_).subspan(first, end - first);
    const auto sum = [&] {
      Vec3f light = point.own;
      for (const Link& link : links)
        if (!link.hidden) light += link.light.radiance;
      return light;
    };
    float time = window.begin;
    for (; change != changes_.end() && change->point == p; ++change) {
      if (change->time > time && change->time < window.end) {
        steps_.push_back({change->time, sum()});
        time = change->time;
      }
      if (change->time < window.end) links_[change->link].hidden = change->hides;
    }
    steps_.push_back({window.end, sum()});
    point.end_of_steps = static_cast<uint32_t>(steps_.size());
    first = end;
  }
}

}  // namespace kairos
