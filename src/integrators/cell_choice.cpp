#include "integrators/cell_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "integrators/discrete_samples.h"
#include "math/hash.h"
#include "motion/common_motion.h"
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

/// What the candidates are compared by: time, and error, of which visibility has a part that is half as large as that
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
/// Of a square's pixels so many are looked at, along either side.
constexpr uint64_t kLooksAlong = 8;
/// Where more of the look-ups see mirrors or glass, samples that go where they are needed are worth more than cells,
/// with which all pixels get the same number: `glass` (0.19 of them) loses 6 dB of 64 samples by cells.
constexpr double kMostOthers = 1.0 / 16;
constexpr double kMostRacedLookUps = 1 << 18;
constexpr uint64_t kCellRaceSeed = 0x4352, kAloneDimension = 0x4341;

/// All that a square's pixels see.
class Square {
 public:
  Square(const PixelContext& context, const DiscreteScene& scene, const Sampler& sampler)
      : context_(context), scene_(scene), sampler_(sampler) {}

  void look(int left, int top, int side, Monitor& monitor) {
    look_ups_.clear();
    first_.clear();
    for (int y = top; y < top + side; ++y)
      for (int x = left; x < left + side; ++x) {
        first_.push_back(look_ups_.count());
        look(x, y, monitor);
      }
    first_.push_back(look_ups_.count());
  }

  const LookUps& look_ups() const { return look_ups_; }
  /// [begin, end) of a pixel's look-ups.
  std::pair<uint32_t, uint32_t> of(size_t pixel) const { return {first_[pixel], first_[pixel + 1]}; }

 private:
  void look(int x, int y, Monitor& monitor) {
    const Sampler::Pixel pixel = sampler_.pixel(x, y);
    const PixelTimes times = context_.times(x, y);
    for (uint32_t begin = 0; begin < sampler_.count(); begin += kRaysPerPoll) {
      monitor.poll();
      const uint32_t size = std::min(kRaysPerPoll, sampler_.count() - begin);
      for (uint32_t i = 0; i < size; ++i) {
        const SamplePoint point = sampler_.point(pixel, begin + i);
        rays_[i] = context_.ray(x, y, point);
        times_[i] = times.instant(point.time);
      }
      scene_.intersect(std::span(rays_).first(size), std::span(times_).first(size), std::span(hits_).first(size),
                       DiscreteLayer::all);
      for (uint32_t i = 0; i < size; ++i)
        if (const auto& hit = hits_[i])
          look_ups_.add({rays_[i], hit->mesh, hit->triangle, times_[i], context_.shader.width_at(hit->dist),
                         SampleKey{pixel.seed, begin + i}});
    }
  }

  const PixelContext& context_;
  const DiscreteScene& scene_;
  const Sampler& sampler_;
  LookUps look_ups_;
  std::vector<uint32_t> first_;  // [pixel, and the end]
  std::array<Ray, kRaysPerPoll> rays_;
  std::array<float, kRaysPerPoll> times_{};
  std::array<std::optional<DiscreteHit>, kRaysPerPoll> hits_;
};

/// Squared errors of a pixel.
struct Errors {
  double alone = 0;
  std::vector<double> shared;  // [candidate]
  double lit = 0, unlit = 0;   // how bright the pixel is, and would be with colours that are not lit
  double others = 0;           // the share of its look-ups that see what shows others
};

/// As a display shows it: of so many samples, those given and others that are dark.
Vec3f shown(Vec3f sum, uint32_t samples) {
  sum = sum / static_cast<float>(samples);
  for (int c = 0; c < 3; ++c) sum[c] = std::clamp(sum[c], 0.0f, 1.0f);
  return sum;
}

double sum_of(Vec3f v) { return static_cast<double>(v.x + v.y + v.z); }
double product(Vec3f a, Vec3f b) { return static_cast<double>(dot(a, b)); }

class SquareRace {
 public:
  /// samples: look-ups of a pixel.
  SquareRace(const Shader& shader, uint32_t samples) : shader_(shader), samples_(samples) {}

  /// Of the square's pixels that are looked at. seed: of the square.
  std::vector<Errors> operator()(const Square& square, uint64_t side, std::span<const CellOptions> candidates,
                                 uint64_t seed) {
    choose_pixels(side, seed);
    alone_.resize(pixels_.size());
    std::vector<Errors> errors(pixels_.size());
    for (size_t i = 0; i < pixels_.size(); ++i) {
      alone_[i] = {shaded_alone(square, pixels_[i], 0), shaded_alone(square, pixels_[i], 1)};
      errors[i].alone = product(alone_[i][0] - alone_[i][1], alone_[i][0] - alone_[i][1]) / 2;
      errors[i].lit = sum_of(alone_[i][0]);
      errors[i].unlit = sum_of(unlit(square, pixels_[i]));
      errors[i].others = others(square, pixels_[i]);
    }
    surfaces_.resize(square.look_ups().count());
    shader_.own_light(square.look_ups().queries(), candidates.front().share_asked, surfaces_);
    for (const CellOptions& candidate : candidates) add(candidate, square, seed, errors);
    return errors;
  }

 private:
  void choose_pixels(uint64_t side, uint64_t seed) {
    pixels_.clear();
    const uint64_t step = std::max<uint64_t>(1, side / kLooksAlong), shift = hash(seed) % (step * step);
    for (uint64_t y = shift / step; y < side; y += step)
      for (uint64_t x = shift % step; x < side; x += step) pixels_.push_back(y * side + x);
  }

  /// What a pixel shows if each of its look-ups asks for light by itself.
  Vec3f shaded_alone(const Square& square, size_t pixel, uint64_t half) {
    const auto [begin, end] = square.of(pixel);
    const std::span<const ShadingQuery> queries = square.look_ups().queries().subspan(begin, end - begin);
    own_.assign(queries.begin(), queries.end());
    for (ShadingQuery& query : own_) query.key = query.key.branch(kAloneDimension + half);
    shades_.resize(own_.size());
    shader_.shade(own_, shades_);
    Vec3f sum{};
    for (const Shade& shade : shades_) sum += shade.colour;
    return shown(sum, samples_);
  }

  Vec3f unlit(const Square& square, size_t pixel) const {
    const auto [begin, end] = square.of(pixel);
    Vec3f sum{};
    for (const ShadingQuery& query : square.look_ups().queries().subspan(begin, end - begin))
      sum += shader_.unlit_colour(query);
    return shown(sum, samples_);
  }

  double others(const Square& square, size_t pixel) const {
    const auto [begin, end] = square.of(pixel);
    const std::span<const ShadingQuery> queries = square.look_ups().queries().subspan(begin, end - begin);
    const auto count = std::count_if(queries.begin(), queries.end(),
                                     [&](const ShadingQuery& query) { return shader_.shows_others(query.mesh); });
    return static_cast<double>(count) / samples_;
  }

  void add(const CellOptions& candidate, const Square& square, uint64_t seed, std::vector<Errors>& errors) {
    SurfaceCells cells(shader_, candidate);
    const std::span<const Vec3f> seen = cells.answer(square.look_ups(), surfaces_, seed);
    for (size_t i = 0; i < pixels_.size(); ++i) {
      const auto [begin, end] = square.of(pixels_[i]);
      Vec3f sum{};
      for (uint32_t j = begin; j < end; ++j) sum += cells.limited(seen[j]);
      const Vec3f by_cells = shown(sum, samples_);
      errors[i].shared.push_back(product(by_cells - alone_[i][0], by_cells - alone_[i][1]));
    }
  }

  const Shader& shader_;
  uint32_t samples_;
  std::vector<size_t> pixels_;
  std::vector<std::array<Vec3f, 2>> alone_;
  std::vector<SharedSurface> surfaces_;
  std::vector<ShadingQuery> own_;
  std::vector<Shade> shades_;
};

/// What is known of a candidate.
struct Runner {
  CellOptions cells;
  double price = 1, blur = 0;  // see cost()
  Duel duel{};
  double costs() const { return cost(cells, price, blur, duel.mean_ours(), duel.mean_theirs()); }
};

}  // namespace

CellChoice choose_cells(const PixelContext& context, const Shot& shot, const RenderParams& params,
                        const DiscreteScene& scene, double look_ups, Monitor& monitor) {
  if (params.cells == Cells::off || !is_lit(params.shading) || context.needs.over_time()) return {};
  const bool open = params.cells == Cells::automatic;
  if (open && params.integrator == IntegratorKind::qmc) return {};
  const bool as_one = common_motion(shot).has_value();
  if (open && !context.shader.shares_light(as_one)) return {};

  const std::span<const CellOptions> candidates = as_one ? std::span<const CellOptions>(kAsOne) : kAmongLights;
  const auto width = static_cast<uint64_t>(shot.projection.width),
             height = static_cast<uint64_t>(shot.projection.height);
  const auto number = [&](const Squares& of) { return width * height / (of.pixels_per_raced * of.side * of.side); };
  const auto fits = [&](const Squares& of) { return number(of) >= of.least && std::min(width, height) >= of.side; };
  const auto* const squares = std::find_if(std::begin(kSquares), std::end(kSquares), fits);
  if (squares == std::end(kSquares)) return open ? CellChoice{} : CellChoice{candidates[kUsual]};
  uint64_t side = squares->side;
  const uint64_t count = std::min(number(*squares), kMostSquares);
  while (side > 1 && look_ups * static_cast<double>(side * side) > kMostRacedLookUps) side /= 2;
  const auto samples =
      static_cast<uint32_t>(std::clamp(std::round(look_ups), 1.0, static_cast<double>(Sampler::kMaxCount)));
  const Sampler sampler(SamplerKind::owen_sobol, samples, hash(params.seed, kCellRaceSeed));
  const Sampler places(SamplerKind::owen_sobol, static_cast<uint32_t>(count), 0);
  const Sampler::Pixel everywhere = places.pixel(0, 0);

  const double price = shading_price(shot, params.shading);
  double lit = 0, unlit = 0, others = 0, pixels = 0;  // sums over all pixels that are looked at
  std::vector<Runner> runners;
  for (const CellOptions& candidate : candidates) runners.push_back({candidate, price, blur_price(look_ups)});
  const auto race = [&](uint64_t first, uint64_t last) {  // squares
    std::vector<CellOptions> running;
    for (const Runner& runner : runners) running.push_back(runner.cells);
    std::vector<std::vector<Errors>> errors(last - first);
    parallel_for(errors.size(), 1, [&](size_t begin, size_t end) {
      Square square(context, scene, sampler);
      SquareRace race_in(context.shader, samples);
      for (size_t i = begin; i < end; ++i) {
        const SamplePoint at = places.point(everywhere, static_cast<uint32_t>(first + i));
        const auto place = [&](float share, uint64_t length) {
          return static_cast<int>(share * static_cast<float>(length - side + 1));
        };
        square.look(place(at.x, width), place(at.y, height), static_cast<int>(side), monitor);
        errors[i] = race_in(square, side, running, hash(params.seed, kCellRaceSeed, first + i));
      }
    });
    for (const auto& of_square : errors)
      for (const Errors& pixel : of_square) {
        lit += pixel.lit;
        unlit += pixel.unlit;
        others += pixel.others;
        ++pixels;
        for (size_t c = 0; c < runners.size(); ++c) runners[c].duel.add(pixel.shared[c], pixel.alone);
      }
  };
  // The worse half drops out after the first quarter of the squares.
  const uint64_t heats = (count + 3) / 4;
  race(0, heats);
  if (heats < count) {
    std::stable_sort(runners.begin(), runners.end(),
                     [](const Runner& a, const Runner& b) { return a.costs() < b.costs(); });
    runners.resize((runners.size() + 1) / 2);
    race(heats, count);
  }
  if (open && spreads_samples(params) && others > kMostOthers * pixels) return {};
  CellChoice best;
  double least = std::numeric_limits<double>::infinity();
  bool any_wins = false;
  for (const Runner& runner : runners) {
    any_wins = any_wins || runner.duel.is_won();
    if ((open && !(runner.duel.mean_ours() < runner.duel.mean_theirs())) || !(runner.costs() < least)) continue;
    const double brighter = lit > 0 ? unlit / lit : 0;
    best = {runner.cells, std::max(0.0, runner.duel.mean_ours()) * brighter * brighter};
    least = runner.costs();
  }
  return any_wins || !open ? best : CellChoice{};
}

}  // namespace kairos
