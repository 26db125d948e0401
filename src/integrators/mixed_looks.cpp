#include "integrators/mixed_looks.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "integrators/mixed_worker.h"
#include "policy/time_split.h"

namespace kairos {

namespace {

/// Pixels in which the picture is looked at beforehand, for where samples are needed: it takes about a hundredth of the
/// time.
constexpr uint64_t kPixelsPerLook = 64, kLeastLooks = 128, kMostLooks = kMostLookPixels;
/// In smaller pictures than this it would be more than a twentieth.
constexpr uint64_t kLeastPixels = 10 * kLeastLooks;
constexpr size_t kLooksPerTask = 64;

/// One in so many of the pixels looked at is raced in at most, which takes about twelve times the budget there: with
/// the looks 2 to 5 % of the time of a picture of 960x540 with 16 samples.
constexpr size_t kLooksPerRace = 4, kMostRaced = 512;
/// A ray of more than so many times the pixel's budget is too dear anywhere.
constexpr double kDearest = 2;

/// All of this comes out of the picture's time, but no more than a tenth of that: the smallest pictures take longer.
constexpr double kLeastLeft = 0.9;

struct LookedAt {
  PixelLook pixel;
  double asked = 0;  // see MixedWorker::Look
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
    LookUps look_ups;
    MixedWorker worker(frame, frame.plan.cells ? &look_ups : nullptr);
    for (size_t i = begin; i < end; ++i) {
      const auto [x, y] = places[i];
      const bool tc_possible = worker.begin_pixel(x, y, monitor).tc_rays > 0;
      const MixedWorker::Look look = worker.look_at(x, y, monitor);
      looks[i] = {look.pixel, look.asked, x, y, tc_possible};
      if (frame.will_race && tc_possible) looks[i].still_rays = worker.still_rays_share(x, y);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    worker.add_ray_counts(stats);
  });
  return looks;
}

/// Between the two kinds of ray. still_share: see Allotment. Returns what it took, as sample_time() counts it.
double race(MixedFrame& frame, const std::vector<LookPixel>& pixels, double still_share, Monitor& monitor) {
  std::vector<RacedPixel> raced(pixels.size());
  parallel_for(pixels.size(), kLooksPerTask, [&](size_t begin, size_t end) {
    LookUps look_ups;
    MixedWorker worker(frame, frame.plan.cells ? &look_ups : nullptr);
    for (size_t i = begin; i < end; ++i) raced[i] = worker.race(pixels[i].x, pixels[i].y, monitor);
  });
  Race& result = frame.plan.race.emplace(frame.budget, frame.plan.prices, frame.params.calibration.has_value(),
                                         frame.still_layer_is_empty ? std::nullopt : std::optional(still_share));
  double time = 0;
  for (const RacedPixel& pixel : raced) {
    result.add(pixel);
    time += 2 * frame.budget * pixel.sample_time;  // each is rendered twice in each way
    for (const RacedPixel::Rays& rays : pixel.tc) time += 2 * rays.time;
  }
  return time;
}

/// What looks and races took, as a share of what is asked for the whole picture.
double share_of_time(const MixedFrame& frame, const std::vector<LookedAt>& looks, double races) {
  double looked = 0, asked = 0;
  for (const LookedAt& look : looks) {
    looked += first_samples(frame.budget) * look.pixel.price;
    asked += frame.budget * look.asked;
  }
  const Projection& projection = frame.shot.projection;
  const double pixels = static_cast<double>(projection.width) * static_cast<double>(projection.height);
  return asked > 0 ? (looked + races) / (asked / static_cast<double>(looks.size()) * pixels) : 0;
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
  const bool spreads = frame.spreads();
  const double gain = spreads ? SampleSpread(first, most, frame.budget, all).gain(frame.budget, rivals) : 1;
  const double still_share = frame.will_race && !rivals.empty() ? still_rays / static_cast<double>(rivals.size()) : 1;
  frame.plan.allotment = Allotment(frame.budget, frame.plan.prices, gain, still_share);
  frame.will_race = frame.will_race && !rivals.empty();
  double races = 0;
  if (frame.will_race) {
    const size_t seats = std::min(kMostRaced, looks.size() / kLooksPerRace);
    const size_t step = (rivals.size() + seats - 1) / seats;
    std::vector<LookPixel> racing;
    size_t possible = 0;
    for (const LookedAt& look : looks)
      if (look.tc_possible && possible++ % step == 0) racing.push_back({look.x, look.y});
    if (spreads) frame.plan.spread.emplace(first, most, frame.budget, rivals);
    races = race(frame, racing, still_share, monitor);
    frame.will_race = false;
  }
  const double left = std::max(kLeastLeft, 1 - share_of_time(frame, looks, races));
  if (!frame.plan.race) {
    std::vector<PixelLook> discrete;
    double price = 0, asked = 0;
    for (const LookedAt& look : looks)
      if (!look.tc_possible || frame.plan_pixel(look.x, look.y).tc_rays == 0) {
        discrete.push_back(look.pixel);
        price += look.pixel.price;
        asked += left * look.asked;
      }
    if (spreads && price > 0) frame.plan.spread = spread_rest(frame.budget, frame.budget * asked / price, discrete);
    return;
  }
  Race& decided = *frame.plan.race;
  if (!spreads) {
    for (size_t lane = 0; lane < Race::kLanes; ++lane) decided.give(lane, 1);
    return;
  }
  const double raced = frame.plan.spread->error(rivals) / static_cast<double>(rivals.size());
  std::vector<Contestant> contestants;
  for (const LookedAt& look : looks)
    contestants.push_back(
        {look.pixel, look.tc_possible ? std::optional(frame.speed(look.x, look.y)) : std::nullopt, left * look.asked});
  frame.plan.spread = split_time(decided, frame.budget, raced > 0 ? decided.discrete_error() / raced : 0, contestants);
}

/// Are pixels with discrete samples better off with the budget for each? What exact looks take comes out of the
/// samples: there the rule stays.
bool is_better_alike(const MixedFrame& frame, const std::vector<LookedAt>& looks) {
  const std::optional<SampleSpread>& spread = frame.plan.spread;
  if (frame.plan.still_rays_per_exact > 0 || !spread || !is_lit(frame.params.shading) ||
      spread->first() != first_samples(frame.budget))
    return false;
  std::vector<PixelLook> discrete;
  for (const LookedAt& look : looks)
    if (!look.tc_possible || frame.plan_pixel(look.x, look.y).tc_rays == 0) discrete.push_back(look.pixel);
  return !spread->pays_if_lit(frame.budget, discrete);
}

}  // namespace

void look_around(MixedFrame& frame, Monitor& monitor, RenderStats& stats) {
  const Projection& projection = frame.shot.projection;
  const uint64_t pixels = static_cast<uint64_t>(projection.width) * static_cast<uint64_t>(projection.height);
  if (pixels < kLeastPixels) return;
  frame.will_race = frame.automatic && !frame.mask.empty() && !frame.context.needs.over_time() &&
                    frame.plan.prices.tc_ray.front() <= kDearest * frame.budget;
  if (!frame.will_race && !frame.spreads()) return;
  const auto count = std::clamp<uint64_t>(pixels / kPixelsPerLook, kLeastLooks, kMostLooks);
  const std::vector<LookedAt> looks = look(frame, count, monitor, stats);
  allot(frame, looks, monitor);
  if (is_better_alike(frame, looks)) frame.plan.spread.reset();
}

}  // namespace kairos
