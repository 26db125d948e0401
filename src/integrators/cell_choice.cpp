#include "integrators/cell_choice.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "integrators/cell_square.h"
#include "math/hash.h"
#include "motion/common_motion.h"
#include "motion/screen_motion.h"
#include "policy/duel.h"
#include "policy/sample_spread.h"
#include "policy/shadow_prices.h"

namespace kairos {

namespace {

/// Where things move among lights cells may differ from one part of the shutter to the next.
constexpr uint32_t kSlices = 4;
/// What is raced. Cells that are too small are seen by few, those that are too large blur light: which comes first
/// depends on how much noise there is, and so on the scene and its budget.
constexpr CellOptions kAsOne[] = {
    {1, 0.25, 1, true}, {2, 0.25, 1, true}, {4, 0.25, 1, true}, {4, 0.125, 1, true}, {8, 0.25, 1, true}};
constexpr CellOptions kAmongLights[] = {
    {4, 0.5, 1, false}, {4, 0.5, kSlices, false}, {4, 0.25, 1, false}, {8, 0.25, 1, false}, {8, 0.5, kSlices, false}};
/// Without a race.
constexpr size_t kUsual = 1;
/// How many times as long as to trace a look-up and to find its cell (in nanoseconds) it takes to shade it.
double shading_price(const Shot& shot, ShadingKind shading) {
  constexpr double kLookUpTime = 900;
  return (lit_sample_time(shot, shading) + weighing_time(shot)) / kLookUpTime;
}

/// What kinds of cells are compared by: time, and error, of which visibility has a part that is half as large as that
/// of light which every look-up asks for. price: see shading_price(). blur: see blur_price().
double cost(const CellOptions& cells, double price, double blur, double shared_error, double alone_error) {
  return (1 + cells.rate * price) * (shared_error + alone_error / 2) * std::pow(cells.side, blur);
}

/// The fainter the noise, the more is seen of the blur of large cells: with many look-ups, smaller ones are taken that
/// are about as good. A power of the side: 0 up to 16 look-ups in a pixel, 0.15 at 64.
double blur_price(double look_ups) { return std::clamp(0.075 * std::log2(look_ups / 16), 0.0, 0.3); }

/// Squares that are raced hold one pixel in so many; of the first of these sizes of which there are `least`.
struct Squares {
  uint64_t side, least, pixels_per_raced;
};
constexpr Squares kSquares[] = {{32, 8, 48}, {24, 6, 48}, {16, 2, 24}};
constexpr uint64_t kMostSquares = 16;
constexpr double kMostRacedLookUps = 1 << 18;
constexpr uint64_t kCellRaceSeed = 0x4352;

/// The squares that are raced: so many of this side; none where the picture is too small.
struct Field {
  uint64_t side = 0, count = 0;
};

Field field_of(const Projection& projection, double look_ups) {
  const auto width = static_cast<uint64_t>(projection.width), height = static_cast<uint64_t>(projection.height);
  const auto number = [&](const Squares& of) { return width * height / (of.pixels_per_raced * of.side * of.side); };
  const auto fits = [&](const Squares& of) { return number(of) >= of.least && std::min(width, height) >= of.side; };
  const auto* const squares = std::find_if(std::begin(kSquares), std::end(kSquares), fits);
  if (squares == std::end(kSquares)) return {};
  Field field{squares->side, std::min(number(*squares), kMostSquares)};
  while (field.side > 1 && look_ups * static_cast<double>(field.side * field.side) > kMostRacedLookUps) field.side /= 2;
  return field;
}

/// Of several kinds of cells against none, in a picture's squares.
class CellRace {
 public:
  CellRace(const PixelContext& context, const Shot& shot, const RenderParams& params, const DiscreteScene& scene,
           double look_ups, const Field& field, std::span<const CellOptions> kinds)
      : context_(context),
        scene_(scene),
        seed_(params.seed),
        field_(field),
        width_(static_cast<uint64_t>(shot.projection.width)),
        height_(static_cast<uint64_t>(shot.projection.height)),
        samples_(static_cast<uint32_t>(std::clamp(std::round(look_ups), 1.0, static_cast<double>(Sampler::kMaxCount)))),
        sampler_(SamplerKind::owen_sobol, samples_, hash(params.seed, kCellRaceSeed)),
        places_(SamplerKind::owen_sobol, static_cast<uint32_t>(field.count), 0) {
    const double price = shading_price(shot, params.shading), blur = blur_price(look_ups);
    for (const CellOptions& kind : kinds) runners_.push_back({kind, price, blur});
  }

  /// forced: cells of some kind are wanted.
  CellChoice run(bool forced, Monitor& monitor) {
    // The worse half drops out after the first quarter of the squares, and all do where none is ahead then.
    const uint64_t heats = (field_.count + 3) / 4;
    race(0, heats, monitor);
    if (heats < field_.count && (forced || !is_lost())) {
      std::stable_sort(runners_.begin(), runners_.end(),
                       [](const Runner& a, const Runner& b) { return a.costs() < b.costs(); });
      runners_.resize((runners_.size() + 1) / 2);
      race(heats, field_.count, monitor);
    }
    const auto is_won = [](const Runner& runner) { return runner.duel.is_won(); };
    if (!forced && (is_lost() || std::none_of(runners_.begin(), runners_.end(), is_won))) return {};
    const Runner* best = nullptr;
    for (const Runner& runner : runners_)
      if ((forced || runner.is_ahead()) && (best == nullptr || runner.costs() < best->costs())) best = &runner;
    const double brighter = lit_ > 0 ? unlit_ / lit_ : 0;
    return {best->cells, std::max(0.0, best->duel.mean_ours()) * brighter * brighter};
  }

 private:
  /// What is known of a kind.
  struct Runner {
    CellOptions cells;
    double price = 1, blur = 0;  // see cost()
    Duel duel{};
    double costs() const { return cost(cells, price, blur, duel.mean_ours(), duel.mean_theirs()); }
    bool is_ahead() const { return duel.mean_ours() < duel.mean_theirs(); }
  };

  /// In squares of these numbers.
  void race(uint64_t first, uint64_t last, Monitor& monitor) {
    std::vector<CellOptions> running;
    for (const Runner& runner : runners_) running.push_back(runner.cells);
    std::vector<std::vector<CellErrors>> errors(last - first);
    const Sampler::Pixel everywhere = places_.pixel(0, 0);
    parallel_for(errors.size(), 1, [&](size_t begin, size_t end) {
      CellSquare square(context_, scene_, sampler_);
      CellSquareRace race_in(context_.shader, samples_);
      for (size_t i = begin; i < end; ++i) {
        const SamplePoint at = places_.point(everywhere, static_cast<uint32_t>(first + i));
        const auto place = [&](float share, uint64_t length) {
          return static_cast<int>(share * static_cast<float>(length - field_.side + 1));
        };
        square.look(place(at.x, width_), place(at.y, height_), static_cast<int>(field_.side), monitor);
        errors[i] = race_in(square, field_.side, running, hash(seed_, kCellRaceSeed, first + i));
      }
    });
    for (const auto& of_square : errors)
      for (const CellErrors& pixel : of_square) {
        lit_ += pixel.lit;
        unlit_ += pixel.unlit;
        for (size_t c = 0; c < runners_.size(); ++c) runners_[c].duel.add(pixel.shared[c], pixel.alone);
      }
  }

  /// Is it better to do without, as far as is known?
  bool is_lost() const {
    return std::none_of(runners_.begin(), runners_.end(), [](const Runner& runner) { return runner.is_ahead(); });
  }

  const PixelContext& context_;
  const DiscreteScene& scene_;
  uint64_t seed_;
  Field field_;
  uint64_t width_, height_;  // of the picture
  uint32_t samples_;         // look-ups of a pixel
  Sampler sampler_, places_;
  std::vector<Runner> runners_;
  double lit_ = 0, unlit_ = 0;  // sums over all pixels that are looked at
};

/// Where more of a picture shows mirrors or glass, samples that go where they are needed are worth more than cells,
/// with which all pixels get the same number: `glass` (0.19 of it) loses 6 dB of 64 samples by cells.
constexpr double kMostOthers = 1.0 / 16;

/// By rays all over the frame.
bool shows_many_others(const PixelContext& context, const Projection& frame, const DiscreteScene& scene,
                       Monitor& monitor) {
  constexpr size_t kRays = kLeastLookPixels;
  constexpr SamplePoint kMiddle{0.5f, 0.5f, 0.5f};
  const std::vector<LookPixel> pixels = look_pixels(frame);
  size_t count = 0;
  for (const LookPixel& pixel : std::span(pixels).first(kRays)) {
    monitor.poll();
    const auto hit = scene.intersect(context.ray(pixel.x, pixel.y, kMiddle), kMiddle.time);
    if (hit && context.shader.shows_others(hit->mesh)) ++count;
  }
  return static_cast<double>(count) > kMostOthers * kRays;
}

}  // namespace

CellChoice choose_cells(const PixelContext& context, const Shot& shot, const RenderParams& params,
                        const DiscreteScene& scene, double look_ups, Monitor& monitor) {
  if (params.cells == Cells::off || !is_lit(params.shading) || context.needs.over_time()) return {};
  const bool forced = params.cells == Cells::on;
  if (!forced && params.integrator == IntegratorKind::qmc) return {};
  const bool as_one = common_motion(shot).has_value();
  if (!forced && !context.shader.shares_light(as_one)) return {};
  const std::span<const CellOptions> kinds = as_one ? std::span<const CellOptions>(kAsOne) : kAmongLights;
  const Field field = field_of(shot.projection, look_ups);
  if (field.count == 0) return forced ? CellChoice{kinds[kUsual]} : CellChoice{};
  if (!forced && spreads_samples(params) && shows_many_others(context, shot.projection, scene, monitor)) return {};
  return CellRace(context, shot, params, scene, look_ups, field, kinds).run(forced, monitor);
}

}  // namespace kairos
