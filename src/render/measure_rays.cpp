#include "render/measure_rays.h"

#include <algorithm>
#include <ctime>
#include <deque>
#include <utility>
#include <vector>

#include <kairos/error.h>
#include <kairos/picture.h>

#include "policy/packet_choice.h"
#include "render/bands.h"
#include "shading/spread.h"

namespace kairos {

namespace {

/// Pixels are taken in stretches of a row that may be traced together, as pictures are rendered: what is next to each
/// other is in the caches.
constexpr int kStretch = PacketChoice::kLongestStrip;
constexpr size_t kStretches = 64;            // to be measured
constexpr uint32_t kTries = 4 * kStretches;  // at most, to find stretches in which something moves
constexpr size_t kWays = 3 + Calibration::kRays.size();
constexpr int kRounds = static_cast<int>(kMeasuringSteps / kWays);
constexpr double kShortest = 2e-3;                       // seconds: clocks tick
constexpr int kDiscreteSamples = 64, kFewStillRays = 4;  // in a pixel

/// Processor time of this thread.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

using PixelPlaces = std::vector<std::pair<int, int>>;

/// Pixels in which something moves, or those in which nothing does, spread over a part of the frame.
PixelPlaces find_pixels(const MotionMask& mask, const Crop& part, bool moving) {
  const int width = part.x1 - part.x0, height = part.y1 - part.y0;
  PixelPlaces pixels;
  const Sampler places(SamplerKind::owen_sobol, kTries, 0);
  const auto add_stretch = [&](int x0, int y) {
    const int left = std::max(part.x0, x0 - x0 % kStretch);
    for (int x = left; x < std::min(x0 - x0 % kStretch + kStretch, part.x1); ++x)
      if (mask.moves(x, y) == moving) pixels.emplace_back(x, y);
  };
  for (uint32_t i = 0; i < kTries && pixels.size() < kStretches * kStretch; ++i) {
    const SamplePoint place = places.point(places.pixel(0, 0), i);
    add_stretch(part.x0 + static_cast<int>(place.x * static_cast<float>(width)),
                part.y0 + static_cast<int>(place.y * static_cast<float>(height)));
  }
  // A small figure is easily missed: whatever moves, in the order of the picture.
  const size_t enough = kStretches * 4;
  for (int y = part.y0; y < part.y1 && pixels.size() < enough; ++y)
    for (int x = part.x0; x < part.x1 && pixels.size() < enough; ++x)
      if (mask.moves(x, y) == moving) pixels.emplace_back(x, y);
  return pixels;
}

/// One way to render the pixels, and how long it took each time.
class Way {
 public:
  Way(ShotParts& parts, const RenderParams& params, const Shader& shader, const PixelPlaces& pixels)
      : pixels_(pixels),
        context_{CameraRays(parts.shot().projection),
                 Sampler(params.sampler, static_cast<uint32_t>(std::max(params.spp, params.tc_rays)), params.seed),
                 PixelFilter(params.filter), shader, parts.shot().seen_background()} {
    RenderStats stats;
    integrator_ = params.integrator == IntegratorKind::qmc ? make_qmc_integrator(parts, params, context_)
                                                           : make_mixed_integrator(parts, params, context_, stats);
    worker_ = integrator_->make_worker();
  }
  Way(const Way&) = delete;
  Way& operator=(const Way&) = delete;

  void run(Monitor& monitor) {
    const double start = thread_seconds();
    int times = 0;
    double seconds = 0;
    do {
      for (const auto& [x, y] : pixels_) colours_ += reduce(worker_->render_pixel(x, y, monitor), {}, false).colour;
      ++times;
      seconds = thread_seconds() - start;
    } while (seconds < kShortest);
    nanoseconds_.push_back(seconds * 1e9 / times / static_cast<double>(pixels_.size()));
  }
  /// What the first time brought into the caches is not to count.
  void forget() { nanoseconds_.clear(); }
  /// Of a pixel.
  double nanoseconds() const { return median(nanoseconds_); }

 private:
  const PixelPlaces& pixels_;
  PixelContext context_;
  Vec3f colours_;  // of all, so that none is left out
  std::unique_ptr<Integrator> integrator_;
  std::unique_ptr<Integrator::Worker> worker_;
  std::vector<double> nanoseconds_;
};

}  // namespace

std::vector<double> measure_pixels(ShotParts& parts, const RenderParams& params, std::span<const MeasuredWay> measured,
                                   bool moving, int rounds, Monitor& monitor) {
  parts.choose_instruction_set(params.instruction_set);
  const Projection& frame = parts.shot().projection;
  Crop part;  // the first with any of them: of all but huge frames the whole
  PixelPlaces pixels;
  for (const Crop& band : bands_of({0, frame.width, 0, frame.height})) {
    part = band;
    pixels = find_pixels(parts.motion_mask(PixelFilter(params.filter).radius(), part), part, moving);
    if (!pixels.empty()) break;
  }
  if (pixels.empty()) return {};
  const Shader& shader = parts.shader(params.shading, false, params.max_depth, params.discrete_keys,
                                      clusters_of(params) == Clusters::pixel);
  std::deque<Way> ways;  // they stay where they are
  for (const MeasuredWay& way : measured) {
    RenderParams own = params;
    own.crop = part;
    own.sampler = SamplerKind::owen_sobol;
    own.integrator = way.integrator;
    own.tc_rays = way.tc_rays;
    own.spp = way.spp;
    ways.emplace_back(parts, own, shader, pixels);
  }
  // Interleaved: what else the machine does is to fall on all alike.
  for (int round = 0; round < rounds; ++round)
    for (Way& way : ways) {
      way.run(monitor);
      if (round == 0) way.forget();
      monitor.finish_pixel();
    }
  std::vector<double> result;
  for (const Way& way : ways) result.push_back(way.nanoseconds());
  return result;
}

Calibration measure_rays(ShotParts& parts, const RenderParams& params, Monitor& monitor) {
  std::vector<MeasuredWay> ways{{IntegratorKind::qmc, 1, kDiscreteSamples}};
  for (const int spp : {kFewStillRays, kDiscreteSamples}) ways.push_back({IntegratorKind::mixed, kFewStillRays, spp});
  for (const int rays : Calibration::kRays) ways.push_back({IntegratorKind::mixed, rays, rays});
  const std::vector<double> pixel = measure_pixels(parts, params, ways, true, kRounds, monitor);
  if (pixel.empty())
    throw Error(ErrorCode::bad_input, "",
                "nothing moves relative to the camera in this picture, so there are no rays to choose between; render "
                "it without a calibration");
  Calibration result;
  result.discrete_sample = pixel[0] / kDiscreteSamples;
  result.still_ray = std::max(0.0, (pixel[2] - pixel[1]) / (kDiscreteSamples - kFewStillRays));
  for (size_t i = 0; i < Calibration::kRays.size(); ++i) result.tc_ray[i] = pixel[3 + i] / Calibration::kRays[i];
  return result;
}

}  // namespace kairos
