#include "policy/ray_prices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <kairos/error.h>

#include "shading/packet_shading.h"

namespace kairos {

namespace {

// Nanoseconds on one thread of a Xeon with AVX-512 at about 2.7 GHz; only their ratios matter. Fitted to pictures of
// scenes of several kinds: docs/method.md, "Static and moving in one pixel".
constexpr double kNode = 20, kTriangle = 15, kHit = 90;  // of a time-continuous ray, see TraceCounters
constexpr double kEvaluation = 30;                       // finding out where to shade, and adding up
// A discrete ray passes what is about it at one instant: more where a time-continuous ray of one key span has more
// hits, up to a limit, since from some speed on more hits are the same things, faster.
constexpr double kDiscrete = 60, kDiscreteMost = 600, kHalfway = 5;  // hits at which half of the limit is reached
constexpr double kStill = 60;

constexpr double kUnlit = 60;

double shading_time(ShadingKind kind) {
  switch (kind) {
    case ShadingKind::flat:
      return 40;
    case ShadingKind::whitted:
      return 1300;
    case ShadingKind::path:
      return 5000;
    default:
      return kUnlit;
  }
}

// Nanoseconds that a ray may take; a clock that says anything else is broken.
constexpr double kLeastTime = 1e-3, kMostTime = 1e9;

// Of 1, 4 and 16 time-continuous rays in a pixel, how much dearer each is than the counts say: the median over the
// scenes of docs/method.md. Light is as dear for one ray as for many.
constexpr std::array<double, Calibration::kRays.size()> kFewAreDearer{2.8, 2.0, 1.25};

constexpr int kPixels = 64;                     // looked at
constexpr uint32_t kRays = Tracer::kMaxPacket;  // in each
constexpr uint32_t kTries = kLeastLookPixels;   // at most, to find pixels in which something moves

}  // namespace

RayWork sample_ray_work(const PixelContext& context, const Shot& shot, const MotionMask& mask, const Tracer& tracer,
                        const ShadingOptions& options) {
  const std::vector<LookPixel> places = look_pixels(shot.projection);
  Tracer::Workspace workspace;
  PacketShading shading(context.shader, options);
  RecordBuilder shaded;
  std::vector<uint32_t> ends;
  std::array<float, kRays> phases;
  phases.fill(0.5f);
  std::array<Ray, kRays> rays;
  int pixels = 0;
  for (uint32_t i = 0; i < kTries && pixels < kPixels; ++i) {
    const auto [x, y] = places[i];
    if (!mask.moves(x, y)) continue;
    ++pixels;
    const Sampler::Pixel pixel = context.sampler.pixel(x, y);
    const uint32_t count = std::min(kRays, context.sampler.count());
    for (uint32_t k = 0; k < count; ++k) rays[k] = context.ray(x, y, context.sampler.point(pixel, k));
    const auto seen = tracer.trace_packet(std::span(rays).first(count), Visibility::visible, workspace);
    shaded.clear();
    ends.clear();
    shading.shade({std::span(rays).first(count), seen, std::span(phases).first(count), pixel.seed, 0}, shaded, ends);
  }
  const TraceCounters& sum = workspace.counters();
  if (sum.rays == 0) return {};
  const auto mean = [&](uint64_t value) { return static_cast<double>(value) / static_cast<double>(sum.rays); };
  return {mean(sum.nodes), mean(sum.triangles), mean(sum.hits), mean(shading.evaluations())};
}

double tracing_time(double nodes, double triangles, double hits) {
  return kNode * nodes + kTriangle * triangles + kHit * hits;
}

RayPrices estimate_prices(const RayWork& work, double key_spans, bool anything_still, ShadingKind shading) {
  if (work.nodes + work.triangles + work.evaluations == 0) return {};  // nothing is known
  const double shade = shading_time(shading);
  const double hits = work.hits / key_spans;
  const double discrete = kDiscrete + kDiscreteMost * hits / (hits + kHalfway) + shade;
  const double still = kStill + shade;
  const double evaluations = std::max(1.0, work.evaluations), cheap = std::min(shade, kUnlit);
  const double tc = tracing_time(work.nodes, work.triangles, work.hits) + (kEvaluation + cheap) * evaluations;
  const double light = (shade - cheap) * evaluations;
  RayPrices prices;
  for (size_t i = 0; i < kFewAreDearer.size(); ++i) prices.tc_ray[i] = (kFewAreDearer[i] * tc + light) / discrete;
  prices.still_ray = anything_still ? std::min(1.0, still / discrete) : 0;
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

double mean_key_spans(const Shot& shot) {
  double triangles = 0, spans = 0;
  for (const Mesh& mesh : shot.meshes) {
    if (mesh.is_static()) continue;
    triangles += static_cast<double>(mesh.triangle_count());
    spans += static_cast<double>(mesh.triangle_count()) * static_cast<double>(mesh.key_count() - 1);
  }
  return triangles > 0 ? spans / triangles : 1;
}

}  // namespace kairos
