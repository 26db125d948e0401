#include "policy/ray_prices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <kairos/error.h>

#include "base/parallel.h"
#include "discrete/occluder_hint.h"
#include "policy/shadow_prices.h"
#include "shading/packet_shading.h"

namespace kairos {

namespace {

// Nanoseconds on one thread of an AMD EPYC (Zen 4) with AVX-512; only their ratios matter. What bench/fit_prices.py
// finds in docs/results/prices.csv. Of a time-continuous ray, see TraceCounters:
constexpr double kRay = 180, kNode = 74, kTriangle = 33, kSolve = 7.4, kHit = 39, kSegment = 0.23;
// Of the time of a node, a triangle and a solve, for rays that are not fresh: see RayWork.
constexpr double kAgain = 0.62;
constexpr double kEvaluation = 140;  // finding out where to shade, shading with normals, and adding up
constexpr double kLayer = 1700;      // of a segment of a blended surface, besides: what is seen through what
// Of a discrete sample, and of what it would pass of what moves on its way at one instant:
constexpr double kSample = 55, kSeen = 100;  // where anything is seen: shading with normals
constexpr double kStill = 0.1;               // asking for what stands still, where anything does
constexpr double kIdle = 18;                 // asking in vain for what moves, of each tree
constexpr double kMoving = 37, kInstantNode = 0.1, kInstantTriangle = 8.3, kInstantHit = 36;
// How much cheaper it passes instances, whose shapes themselves do not move: of the time of the last three.
constexpr double kPlaced = 0.65;
constexpr double kFirst = 1.8;  // by which the first of a pixel's samples is dearer: so many samples
/// Of the light of what shows others, as a multiple of that of other surfaces.
constexpr double kOthers = 3;

constexpr double kShadowNode = 20, kShadowTriangle = 15, kShadowHit = 90;  // of a ray to a light

// Nanoseconds that a ray may take; a clock that says anything else is broken.
constexpr double kLeastTime = 1e-3, kMostTime = 1e9;

constexpr size_t kPixels = 64;                      // looked at
constexpr uint32_t kMostRays = Tracer::kMaxPacket;  // in each
constexpr size_t kPixelsPerTask = 4;
constexpr uint32_t kTries = kLeastLookPixels;  // at most, to find pixels in which something moves

}  // namespace

RayWork::RayWork(const TraceCounters& counters, uint64_t evaluation_count, uint64_t layer_count, bool together,
                 uint32_t in_pixel) {
  if (counters.rays == 0) return;
  const auto mean = [&](uint64_t value) { return static_cast<double>(value) / static_cast<double>(counters.rays); };
  nodes = mean(counters.nodes);
  triangles = mean(counters.triangles);
  root_solves = mean(counters.root_solves);
  hits = mean(counters.hits);
  segments = mean(counters.segments);
  evaluations = mean(evaluation_count);
  layers = mean(layer_count);
  fresh = together ? 1 : 1.0 / in_pixel;
}

WorkSample sample_ray_work(const PixelContext& context, const Shot& shot, const MotionMask& mask, const Tracer& tracer,
                           const DiscreteScene* hints, const PacketChoice& packets, const ShadingOptions& options) {
  constexpr auto kCounts = Calibration::kRays;
  std::vector<LookPixel> pixels;
  const std::vector<LookPixel> places = look_pixels(shot.projection);
  for (uint32_t i = 0; i < kTries && pixels.size() < kPixels; ++i)
    if (mask.moves(places[i].x, places[i].y)) pixels.push_back(places[i]);

  const Sampler points(SamplerKind::owen_sobol, kMostRays, 0);
  std::array<TraceCounters, kCounts.size()> together{}, alone{};
  std::array<uint64_t, kCounts.size()> evaluations{}, layers{};  // of the rays alone
  TraceCounters instant;
  uint64_t placed = 0;  // segments
  uint64_t seen_rays = 0;
  std::mutex mutex;  // of these sums
  parallel_for(pixels.size(), kPixelsPerTask, [&](size_t begin, size_t end) {
    std::array<Tracer::Workspace, kCounts.size()> strips, workspaces;
    Tracer::Workspace instants;
    std::array<uint64_t, kCounts.size()> layers_here{};
    uint64_t placed_here = 0, seen_here = 0;
    std::array<PacketShading, kCounts.size()> shadings{PacketShading(context.shader, options),
                                                       PacketShading(context.shader, options),
                                                       PacketShading(context.shader, options)};
    RecordBuilder shaded;
    std::vector<uint32_t> ends;
    std::array<float, kMostRays> phases;
    phases.fill(0.5f);
    std::array<Ray, kMostRays> rays, strip;
    std::array<std::optional<DiscreteHit>, kMostRays> still;
    std::vector<Segment> seen_still, seen_by_strip;
    const auto see_still = [&](std::span<const Ray> of, std::vector<Segment>& seen) {
      seen.clear();
      if (hints == nullptr) return;
      const auto hits = std::span(still).first(of.size());
      hints->intersect(of, std::span(phases).first(of.size()), hits, DiscreteLayer::still);
      for (const auto& hit : hits) seen.push_back(occluder_hint(hit));
    };
    const auto hints_of = [&](size_t first, size_t count) {
      return hints == nullptr ? std::span<const Segment>() : std::span<const Segment>(seen_still).subspan(first, count);
    };
    for (size_t i = begin; i < end; ++i) {
      const auto [x, y] = pixels[i];
      const Sampler::Pixel pixel = points.pixel(x, y);
      for (uint32_t k = 0; k < kMostRays; ++k) rays[k] = context.ray(x, y, points.point(pixel, k));
      see_still(rays, seen_still);
      for (size_t n = 0; n < kCounts.size(); ++n) {
        const auto count = static_cast<uint32_t>(kCounts[n]);
        const std::span<const Ray> first = std::span(rays).first(count);
        const auto seen =
            tracer.trace_packet(first, Visibility::visible, workspaces[n], hints_of(0, count), packets.together(count));
        for (const SeenByRay& ray : seen) layers_here[n] += ray.blended.size();
        shaded.clear();
        ends.clear();
        shadings[n].shade({first, seen, std::span(phases).first(count), pixel.seed, 0}, shaded, ends);
        const int wide = packets.strip(count);
        if (wide == 1) continue;
        const int left = x - x % wide, right = std::min(left + wide, shot.projection.width);
        uint32_t size = 0;
        for (int px = left; px < right; ++px) {
          const Sampler::Pixel beside = points.pixel(px, y);
          for (uint32_t k = 0; k < count; ++k) strip[size++] = context.ray(px, y, points.point(beside, k));
        }
        const std::span<const Ray> all = std::span(strip).first(size);
        see_still(all, seen_by_strip);
        tracer.trace_packet(all, Visibility::visible, strips[n], seen_by_strip, true);
      }
      for (uint32_t k = 0; k < kInstants; ++k) {
        const auto seen = tracer.trace_packet(std::span(rays).subspan(k, 1), Visibility::visible, instants,
                                              hints_of(k, 1), false, instant_limits(k));
        seen_here += !seen.front().segments.empty() || !seen.front().blended.empty() ||
                     (hints != nullptr && still[k].has_value());
        for (const Segment& segment : seen.front().segments) placed_here += shot.meshes[segment.mesh].object != nullptr;
      }
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (size_t n = 0; n < kCounts.size(); ++n) {
      together[n] += strips[n].counters();
      alone[n] += workspaces[n].counters();
      evaluations[n] += shadings[n].evaluations();
      layers[n] += layers_here[n];
    }
    instant += instants.counters();
    placed += placed_here;
    seen_rays += seen_here;
  });
  WorkSample sum;
  for (size_t n = 0; n < kCounts.size(); ++n) {
    const auto count = static_cast<uint32_t>(kCounts[n]);
    sum.tc[n] = sum.alone[n] = RayWork(alone[n], evaluations[n], layers[n], packets.together(count), count);
    if (together[n].rays == 0) continue;
    sum.tc[n] = RayWork(together[n], 0, 0);
    sum.tc[n].evaluations = sum.alone[n].evaluations;
    sum.tc[n].layers = sum.alone[n].layers;
  }
  sum.sample.instant = RayWork(instant, 0, 0);
  if (instant.rays > 0) sum.sample.seen = static_cast<double>(seen_rays) / static_cast<double>(instant.rays);
  if (instant.segments > 0) sum.sample.placed = static_cast<double>(placed) / static_cast<double>(instant.segments);
  return sum;
}

double tracing_time(double nodes, double triangles, double hits) {
  return kShadowNode * nodes + kShadowTriangle * triangles + kShadowHit * hits;
}

Surroundings::Surroundings(const Shot& shot, const DiscreteScene& scene, const Shader& shader, ShadingKind shading,
                           uint32_t samples_in_pixel)
    : anything_still(std::any_of(shot.meshes.begin(), shot.meshes.end(), [](const Mesh& m) { return m.is_static(); })),
      still_layer(anything_still || shader.has_sky()),
      moving_trees(scene.stats().trees - (anything_still ? 1 : 0)),
      light(is_lit(shading) ? lit_sample_time(shot, shading) : 0),
      samples(samples_in_pixel) {}

double tc_ray_time(const RayWork& work, const Surroundings& around) {
  const double tracing = kNode * work.nodes + kTriangle * work.triangles + kSolve * work.root_solves;
  return kRay + tracing * (work.fresh + (1 - work.fresh) * kAgain) + kHit * work.hits + kSegment * work.segments +
         (kEvaluation + around.light) * work.evaluations + kLayer * work.layers;
}

namespace {

/// As rays are traced. What they save together with those of other pixels is much less than what their counts say:
/// the median over the benchmark's scenes of the time saved is about this power of that.
double traced_time(const WorkSample& work, const Surroundings& around, size_t i) {
  constexpr double kStripPower = 0.3;
  const double together = tc_ray_time(work.tc[i], around), alone = tc_ray_time(work.alone[i], around);
  return together < alone ? alone * std::pow(together / alone, kStripPower) : together;
}

}  // namespace

double strip_share(const WorkSample& work, const Surroundings& around, uint32_t rays) {
  size_t i = 0;  // what has so many rays or more in a pixel
  while (i + 1 < work.tc.size() && static_cast<uint32_t>(Calibration::kRays[i]) < rays) ++i;
  return traced_time(work, around, i) / tc_ray_time(work.alone[i], around);
}

namespace {

/// A sample of the pixel, in the mean, of one that others have gone before.
double with_first(double sample, const Surroundings& around) { return sample * (1 + kFirst / around.samples); }

double later_resting_sample(const SampleWork& work, const Surroundings& around) {
  const double light = around.light * (1 + (kOthers - 1) * work.others);
  return kSample + (around.anything_still ? kStill : 0) + work.seen * (kSeen + light);
}

}  // namespace

double resting_sample_time(const SampleWork& work, const Surroundings& around) {
  return with_first(later_resting_sample(work, around), around);
}

double idle_sample_time(const SampleWork& work, const Surroundings& around) {
  return with_first(later_resting_sample(work, around) + kIdle * static_cast<double>(around.moving_trees), around);
}

double sample_time(const SampleWork& work, const Surroundings& around) {
  const RayWork& instant = work.instant;
  const double passed =
      kInstantNode * instant.nodes + kInstantTriangle * instant.triangles + kInstantHit * instant.hits;
  return with_first(later_resting_sample(work, around) + kMoving * static_cast<double>(around.moving_trees) +
                        passed * (1 - work.placed + work.placed * kPlaced),
                    around);
}

RayPrices estimate_prices(const WorkSample& work, const Surroundings& around) {
  const RayWork& instant = work.sample.instant;
  if (instant.nodes + instant.triangles + work.tc.back().evaluations == 0) return {};  // nothing is known
  const double sample = sample_time(work.sample, around), still = resting_sample_time({}, around);
  RayPrices prices;
  for (size_t i = 0; i < prices.tc_ray.size(); ++i) {
    prices.tc_ray[i] = traced_time(work, around, i) / sample;
    if (around.anything_still) prices.tc_ray[i] += still / sample;
    if (around.still_layer) prices.tc_ray[i] += static_cast<double>(kShareRays) / Calibration::kRays[i];
  }
  prices.still_ray = around.still_layer ? std::min(1.0, still / sample) : 0;
  return prices;
}

RayPrices without_shares(RayPrices prices) {
  constexpr double kLeast = 0.2;  // of a price that somebody has measured
  for (size_t i = 0; i < prices.tc_ray.size(); ++i) {
    double& price = prices.tc_ray[i];
    price = std::max(kLeast * price, price - static_cast<double>(kShareRays) / Calibration::kRays[i]);
  }
  return prices;
}

double tc_ray_price(const RayPrices& prices, double rays) {
  constexpr auto kKnown = Calibration::kRays;
  if (rays <= kKnown.front()) return prices.tc_ray.front();
  for (size_t i = 1; i < kKnown.size(); ++i)
    if (rays <= kKnown[i]) {
      const double place = std::log2(rays / kKnown[i - 1]) / std::log2(static_cast<double>(kKnown[i]) / kKnown[i - 1]);
      return prices.tc_ray[i - 1] + (prices.tc_ray[i] - prices.tc_ray[i - 1]) * place;
    }
  return prices.tc_ray.back();
}

RayPrices prices_of(const Calibration& calibration) {
  const auto check = [](double time, double least, const char* what) {
    if (!(time >= least && time <= kMostTime))
      throw Error(ErrorCode::bad_usage, "",
                  std::string("a calibration's time of a ") + what + " must be " + (least > 0 ? "1e-3" : "0") +
                      " to 1e9 nanoseconds");
  };
  check(calibration.discrete_sample, kLeastTime, "discrete sample");
  check(calibration.still_ray, 0, "still ray");
  RayPrices prices;
  prices.still_ray = calibration.still_ray / calibration.discrete_sample;
  for (size_t i = 0; i < prices.tc_ray.size(); ++i) {
    check(calibration.tc_ray[i], kLeastTime, "time-continuous ray");
    prices.tc_ray[i] = calibration.tc_ray[i] / calibration.discrete_sample;
  }
  return prices;
}

}  // namespace kairos
