#include "shading/exact_shadows.h"

#include <algorithm>

namespace kairos {

Vec3f RestingLightSteps::look_at_still(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle) {
  lights_.clear();
  ShadingQuery query{ray, mesh, triangle, 0, 0, {}};  // at rest, all times are alike
  shadows.shader().resting_light(query, lights_);
  own_ = {};
  drop_hidden_at_rest(shadows);
  Vec3f sum{};
  for (const RestingLight& light : lights_) sum += light.radiance;
  return sum;
}

bool RestingLightSteps::look_at_all(const ExactShadows& shadows, ShadingQuery query, const TimeRange& window,
                                    Shade& base) {
  lights_.clear();
  if (!shadows.shader().steady_light(query, lights_, base)) return false;
  own_ = base.colour;
  drop_hidden_at_rest(shadows);
  look_at_motion(shadows, window);
  return true;
}

void RestingLightSteps::drop_hidden_at_rest(const ExactShadows& shadows) {
  std::erase_if(lights_, [&](const RestingLight& light) {
    return shadows.scene().occluded(light.way, 0, light.dist, DiscreteLayer::still);
  });
}

void RestingLightSteps::look_at_motion(const ExactShadows& shadows, const TimeRange& window) {
  changes_.clear();
  steps_.clear();
  hidden_.assign(lights_.size(), false);
  for (uint32_t light = 0; light < lights_.size(); ++light) {
    const TraceLimits limits{window.begin, window.end, lights_[light].dist};
    for (const TimeRange& hidden : shadows.tracer().occluded(lights_[light].way, workspace_, limits)) {
      changes_.push_back({hidden.begin, light, true});
      changes_.push_back({hidden.end, light, false});
    }
  }
  // A light that is hidden again at the instant at which it appears stays hidden, whichever change comes last.
  std::sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) {
    if (a.time != b.time) return a.time < b.time;
    return a.light != b.light ? a.light < b.light : a.hides < b.hides;
  });
  const auto sum = [&] {
    Vec3f light = own_;
    for (size_t i = 0; i < lights_.size(); ++i)
      if (!hidden_[i]) light += lights_[i].radiance;
    return light;
  };
  float time = window.begin;
  for (const Change& change : changes_) {
    if (change.time > time && change.time < window.end) {
      steps_.push_back({change.time, sum()});
      time = change.time;
    }
    if (change.time < window.end) hidden_[change.light] = change.hides;
  }
  steps_.push_back({window.end, sum()});
}

}  // namespace kairos
