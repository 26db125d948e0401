#include "policy/shadow_race.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "motion/screen_motion.h"
#include "policy/shadow_prices.h"
#include "shading/exact_shadows.h"
#include "shading/luminance.h"

namespace kairos {

namespace {

constexpr size_t kShadowPixels = 512;  // looked at, at most
constexpr int kPhases = 4;             // of samples in time
constexpr int kLeastPixels = 8;        // of a mesh, to say anything of it

/// A point's resting light over the shutter.
struct LightSeen {
  uint32_t mesh;
  double mean;
  std::array<double, kPhases> sampled;  // [phase]: as so many samples a ray find it, evenly spread
};

LightSeen light_seen(uint32_t mesh, std::span<const RestingLightSteps::Step> steps, int samples) {
  LightSeen seen{mesh, 0, {}};
  float begin = 0;
  for (const auto& step : steps) {
    seen.mean += static_cast<double>(luminance(step.light)) * static_cast<double>(step.end - begin);
    begin = step.end;
  }
  for (int phase = 0; phase < kPhases; ++phase)
    for (int i = 0; i < samples; ++i) {
      const auto time = static_cast<float>((i + (phase + 0.5) / kPhases) / samples);
      const auto at = std::find_if(steps.begin(), steps.end() - 1, [&](const auto& step) { return time < step.end; });
      seen.sampled[static_cast<size_t>(phase)] += static_cast<double>(luminance(at->light)) / samples;
    }
  return seen;
}

/// Of one mesh, summed over pixels.
struct Tally {
  int pixels = 0, looks = 0;
  double space = 0;    // squared error of a pixel's rays, that both ways have
  double sampled = 0;  // squared error of samples in time
  double time = 0, lights = 0;

  Tally& operator+=(const Tally& other) {
    pixels += other.pixels;
    looks += other.looks;
    space += other.space;
    sampled += other.sampled;
    time += other.time;
    lights += other.lights;
    return *this;
  }
};

}  // namespace

std::vector<bool> race_shadows(const PixelContext& context, const Shot& shot, ShadingKind shading, const Tracer& tracer,
                               const DiscreteScene& scene, const ShadingOptions& options, uint32_t rays_in_pixel,
                               std::vector<bool> receivers) {
  const ExactShadows shadows(context.shader, tracer, scene, receivers);
  const uint32_t count = std::clamp(rays_in_pixel, 2u, static_cast<uint32_t>(Tracer::kMaxPacket));
  const int samples = std::max(1, static_cast<int>(std::round(options.samples)));
  const Sampler points(SamplerKind::owen_sobol, count, 0);
  Tracer::Workspace workspace;
  RestingLightSteps steps;
  std::map<uint32_t, Tally> tallies;
  std::array<Ray, Tracer::kMaxPacket> rays;
  std::vector<uint32_t> points_on;  // meshes
  std::vector<LightSeen> looks;
  std::vector<LookPixel> pixels = look_pixels(shot.projection);
  pixels.resize(std::min(pixels.size(), kShadowPixels));
  for (const auto& [x, y] : pixels) {
    const Sampler::Pixel pixel = points.pixel(x, y);
    for (uint32_t k = 0; k < count; ++k) rays[k] = context.ray(x, y, points.point(pixel, k));
    points_on.clear();
    steps.clear();
    for (const Ray& ray : std::span(rays).first(count)) {
      const auto seen = tracer.trace(ray, Visibility::visible, workspace);
      const auto on = std::find_if(seen.begin(), seen.end(), [&](const Segment& s) { return receivers[s.mesh]; });
      if (on == seen.end()) continue;
      points_on.push_back(on->mesh);
      steps.add(shadows, ray, on->mesh, on->triangle);
    }
    const TraceCounters before = steps.counters();
    steps.look(shadows, {});
    const double time = exact_look_time(0, steps.counters()) - exact_look_time(0, before);
    looks.clear();
    for (size_t point = 0; point < points_on.size(); ++point) {
      Tally& tally = tallies[points_on[point]];
      ++tally.looks;
      tally.time += exact_look_time(1, {}) + time / static_cast<double>(points_on.size());
      tally.lights += static_cast<double>(steps.lights(point));
      looks.push_back(light_seen(points_on[point], steps.steps(point), samples));
    }
    for (auto& [mesh, tally] : tallies) {
      double n = 0, sum = 0, squares = 0;
      std::array<double, kPhases> errors{};
      for (const LightSeen& look : looks) {
        if (look.mesh != mesh) continue;
        ++n;
        sum += look.mean;
        squares += look.mean * look.mean;
        for (size_t phase = 0; phase < errors.size(); ++phase) errors[phase] += look.sampled[phase] - look.mean;
      }
      if (n < 2) continue;
      ++tally.pixels;
      tally.space += std::max(0.0, squares - sum * sum / n) / (n - 1) / rays_in_pixel;
      for (const double error : errors) tally.sampled += error * error / (n * n * kPhases);
    }
  }
  const TraceCounters& c = workspace.counters();
  const double sight = c.rays > 0 ? tracing_time(static_cast<double>(c.nodes), static_cast<double>(c.triangles),
                                                 static_cast<double>(c.hits)) /
                                        static_cast<double>(c.rays)
                                  : 0;
  const double sample = lit_sample_time(shot, shading);
  const auto exact_wins = [&](const Tally& tally) {
    const double sampled = sight + samples * sample;  // time of a ray
    const double exact = sampled - samples * kLightRayTime * tally.lights / tally.looks + tally.time / tally.looks;
    constexpr double kNothing = 1e-12;  // where neither way has an error, the faster one is taken
    return (tally.space + kNothing) * exact < (tally.space + tally.sampled + kNothing) * sampled;
  };
  Tally all;
  for (const auto& [mesh, tally] : tallies) all += tally;
  if (all.pixels == 0) return std::vector<bool>(receivers.size());
  // Meshes that few looks met do as all together.
  for (uint32_t mesh = 0; mesh < receivers.size(); ++mesh) {
    if (!receivers[mesh]) continue;
    const auto found = tallies.find(mesh);
    const bool is_known = found != tallies.end() && found->second.pixels >= kLeastPixels;
    receivers[mesh] = exact_wins(is_known ? found->second : all);
  }
  return receivers;
}

}  // namespace kairos
