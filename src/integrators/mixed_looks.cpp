#include "integrators/mixed_looks.h"

#include <algorithm>
#include <mutex>
#include <vector>

#include "base/parallel.h"
#include "integrators/mixed_worker.h"

namespace kairos {

namespace {

/// Pixels in which the picture is looked at beforehand, for where samples are needed: it takes about a hundredth of the
/// time.
constexpr uint64_t kPixelsPerLook = 64, kLeastLooks = 128, kMostLooks = kMostLookPixels;
/// In smaller pictures than this it would be more than a twentieth.
constexpr uint64_t kLeastPixels = 10 * kLeastLooks;
constexpr size_t kLeastLooksSeen = 16;  // fewer say nothing of the picture
constexpr size_t kLooksPerTask = 64;

/// One in so many of the pixels looked at is raced in: four times the budget each, so a fiftieth of the picture's time.
constexpr size_t kLooksPerRace = 3;

struct LookedAt {
  PixelLook pixel;
  int x = 0, y = 0;
  bool tc_possible = false;
  double still_rays = 0;  // beside time-continuous ones, as a share of the budget
};

/// At pixels all over the frame.
std::vector<LookedAt> look(const MixedFrame& frame, size_t count, Monitor& monitor, RenderStats& stats) {
  const std::vector<LookPixel> places = look_pixels(frame.shot.projection);
  std::vector<LookedAt> looks(count);
  std::mutex mutex;  // of stats
  parallel_for(count, kLooksPerTask, [&](size_t begin, size_t end) {
    MixedWorker worker(frame);
    for (size_t i = begin; i < end; ++i) {
      const auto [x, y] = places[i];
      const bool tc_possible = worker.begin_pixel(x, y, monitor).tc_rays > 0;
      looks[i] = {worker.look_at(x, y, monitor), x, y, tc_possible};
      if (frame.will_race && tc_possible) looks[i].still_rays = worker.still_rays_share(x, y);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    worker.add_ray_counts(stats);
  });
  return looks;
}

/// Between the two kinds of ray.
void race(MixedFrame& frame, const std::vector<LookPixel>& pixels, Monitor& monitor) {
  std::vector<MixedWorker::RaceErrors> errors(pixels.size());
  parallel_for(pixels.size(), kLooksPerTask, [&](size_t begin, size_t end) {
    MixedWorker worker(frame);
    for (size_t i = begin; i < end; ++i) errors[i] = worker.race(pixels[i].x, pixels[i].y, monitor);
  });
  Race& result = frame.plan.race.emplace();
  for (size_t i = 0; i < pixels.size(); ++i)
    result.add(frame.speed(pixels[i].x, pixels[i].y), errors[i].tc, errors[i].discrete);
}

/// Which pixels get time-continuous rays.
void allot(MixedFrame& frame, const std::vector<LookedAt>& looks, Monitor& monitor) {
  std::vector<PixelLook> all, rivals;  // those that could have time-continuous rays instead of discrete ones
  double still_rays = 0;
  for (const LookedAt& look : looks) {
    all.push_back(look.pixel);
    if (look.tc_possible) rivals.push_back(look.pixel);
    still_rays += look.still_rays;
  }
  const uint32_t first = first_samples(frame.budget), most = most_samples(frame.budget);
  const double gain = SampleSpread(first, most, frame.budget, all).gain(frame.budget, rivals);
  const double still_share = frame.will_race && !rivals.empty() ? still_rays / static_cast<double>(rivals.size()) : 1;
  frame.plan.allotment = Allotment(frame.budget, frame.plan.prices, gain, still_share);
  if (frame.will_race && frame.plan.allotment.buys_tc()) {
    std::vector<LookPixel> racing;
    for (size_t i = 0; i < looks.size(); i += kLooksPerRace)
      if (looks[i].tc_possible) racing.push_back({looks[i].x, looks[i].y});
    frame.plan.spread.emplace(first, most, frame.budget, rivals);
    race(frame, racing, monitor);
    frame.plan.spread.reset();
  }
  frame.will_race = false;
}

}  // namespace

void look_around(MixedFrame& frame, Monitor& monitor, RenderStats& stats) {
  if (!spreads_samples(frame.params)) return;
  const Projection& projection = frame.shot.projection;
  const uint64_t pixels = static_cast<uint64_t>(projection.width) * static_cast<uint64_t>(projection.height);
  if (pixels < kLeastPixels) return;
  frame.will_race = frame.automatic && is_lit(frame.params.shading) && !frame.context.needs.over_time();
  const auto count = std::clamp<uint64_t>(pixels / kPixelsPerLook, kLeastLooks, kMostLooks);
  const std::vector<LookedAt> looks = look(frame, count, monitor, stats);
  if (frame.automatic) allot(frame, looks, monitor);
  std::vector<PixelLook> discrete;  // of pixels without time-continuous rays
  double price = 0, without_exact = 0;
  for (const LookedAt& seen : looks)
    if (!seen.tc_possible || frame.plan_pixel(seen.x, seen.y).tc_rays == 0) {
      discrete.push_back(seen.pixel);
      price += seen.pixel.price;
      without_exact += frame.sample_price(frame.mask.moves(seen.x, seen.y) ? DiscreteLayer::all : DiscreteLayer::still);
    }
  // What exact shadows cost is taken from the samples.
  if (discrete.size() >= kLeastLooksSeen)
    frame.plan.spread.emplace(first_samples(frame.budget), most_samples(frame.budget),
                              frame.budget * without_exact / price, discrete);
}

}  // namespace kairos
