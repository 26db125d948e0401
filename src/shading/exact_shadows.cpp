#include "shading/exact_shadows.h"

#include <algorithm>

namespace kairos {

void RestingLightSteps::look(const ExactShadows& shadows, const Ray& ray, uint32_t mesh, uint32_t triangle,
                             const TimeRange& window) {
  lights_.clear();
  changes_.clear();
  steps_.clear();
  ShadingQuery query{ray, mesh, triangle, window.begin, 0, {}, false};
  shadows.shader().resting_light(query, lights_);
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
    Vec3f light{};
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
