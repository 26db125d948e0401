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

namespace kairos {

namespace {

/// Where things move among lights cells may differ from one part of the shutter to the next.
constexpr uint32_t kSlices = 4;
/// What is raced. Cells that are too small are seen by few, those that are too large blur light: which comes first
/// depends on how much noise there is, and so on the scene and its budget.
constexpr CellOptions kAsOne[] = {{1, 0.5, 1, true}, {2, 0.25, 1, true}, {4, 0.25, 1, true}, {8, 0.25, 1, true}};
constexpr CellOptions kAmongLights[] = {
    {4, 0.5, 1, false}, {4, 0.5, kSlices, false}, {8, 0.25, 1, false}, {8, 0.5, kSlices, false}};
/// Without a race.
constexpr size_t kUsual = 1;
/// What the candidates are compared by: time, as if to trace a look-up cost as much as to shade it, and error, of which
/// visibility has a part that is half as large as that of light which every look-up asks for.
double cost(const CellOptions& cells, double shared_error, double alone_error) {
  return (1 + cells.rate) * (shared_error + alone_error / 2);
}

/// Squares that are raced hold about one pixel in 48; of the largest of these sizes of which there are so many.
constexpr uint64_t kPixelsPerRaced = 48, kMostSquares = 16;
struct Squares {
  uint64_t side, least;
};
constexpr Squares kSquares[] = {{32, 8}, {24, 6}, {16, 3}};
/// Of whose pixels one in so many, along either side, is looked at.
constexpr int kStep = 4;
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

  LookUps& look_ups() { return look_ups_; }
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
};

/// As a display shows it: of so many samples, those given and others that are dark.
Vec3f shown(std::span<const Vec3f> colours, uint32_t samples) {
  Vec3f sum{};
  for (const Vec3f& colour : colours) sum += colour;
  sum = sum / static_cast<float>(samples);
  for (int c = 0; c < 3; ++c) sum[c] = std::clamp(sum[c], 0.0f, 1.0f);
  return sum;
}

double product(Vec3f a, Vec3f b) { return static_cast<double>(dot(a, b)); }

/// Of a square's pixels that are looked at. seed: of the square.
std::vector<Errors> race(const Shader& shader, Square& square, int side, uint32_t samples,
                         std::span<const CellOptions> candidates, uint64_t seed) {
  const std::span<const ShadingQuery> queries = square.look_ups().queries();
  std::vector<size_t> pixels;
  const auto shift = static_cast<int>(hash(seed) % (uint64_t{kStep} * uint64_t{kStep}));
  for (int y = shift / kStep; y < side; y += kStep)
    for (int x = shift % kStep; x < side; x += kStep)
      pixels.push_back(static_cast<size_t>(y) * static_cast<size_t>(side) + static_cast<size_t>(x));
  std::vector<Errors> errors(pixels.size());
  std::vector<std::array<Vec3f, 2>> alone(pixels.size());
  std::vector<ShadingQuery> own;
  std::vector<Shade> shades;
  std::vector<Vec3f> colours;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const auto [begin, end] = square.of(pixels[i]);
    for (uint64_t half = 0; half < 2; ++half) {
      own.assign(queries.begin() + begin, queries.begin() + end);
      for (ShadingQuery& query : own) query.key = query.key.branch(kAloneDimension + half);
      shades.resize(own.size());
      shader.shade(own, shades);
      colours.clear();
      for (const Shade& shade : shades) colours.push_back(shade.colour);
      alone[i][half] = shown(colours, samples);
    }
    errors[i].alone = product(alone[i][0] - alone[i][1], alone[i][0] - alone[i][1]) / 2;
  }
  for (const CellOptions& candidate : candidates) {
    SurfaceCells cells(shader, candidate);
    const std::span<const Vec3f> seen = cells.answer(square.look_ups(), seed);
    for (size_t i = 0; i < pixels.size(); ++i) {
      const auto [begin, end] = square.of(pixels[i]);
      colours.clear();
      for (uint32_t j = begin; j < end; ++j) colours.push_back(cells.limited(seen[j]));
      const Vec3f by_cells = shown(colours, samples);
      errors[i].shared.push_back(product(by_cells - alone[i][0], by_cells - alone[i][1]));
    }
  }
  return errors;
}

}  // namespace

std::optional<CellOptions> choose_cells(const PixelContext& context, const Shot& shot, const RenderParams& params,
                                        const DiscreteScene& scene, double look_ups, Monitor& monitor) {
  if (params.cells == Cells::off || !is_lit(params.shading) || context.needs.over_time()) return std::nullopt;
  const bool open = params.cells == Cells::automatic;
  if (open && params.integrator == IntegratorKind::qmc) return std::nullopt;
  const bool as_one = common_motion(shot).has_value();
  if (open && !context.shader.shares_light(as_one)) return std::nullopt;

  const std::span<const CellOptions> candidates = as_one ? std::span(kAsOne) : std::span(kAmongLights);
  const auto width = static_cast<uint64_t>(shot.projection.width),
             height = static_cast<uint64_t>(shot.projection.height);
  const uint64_t raced = width * height / kPixelsPerRaced;
  const auto fits = [&](const Squares& squares) {
    return raced >= squares.least * squares.side * squares.side && std::min(width, height) >= squares.side;
  };
  const auto* const squares = std::find_if(std::begin(kSquares), std::end(kSquares), fits);
  if (squares == std::end(kSquares)) return open ? std::nullopt : std::optional(candidates[kUsual]);
  uint64_t side = squares->side;
  const uint64_t count = std::min(raced / (side * side), kMostSquares);
  while (side > 1 && look_ups * static_cast<double>(side * side) > kMostRacedLookUps) side /= 2;
  const auto samples =
      static_cast<uint32_t>(std::clamp(std::round(look_ups), 1.0, static_cast<double>(Sampler::kMaxCount)));
  const Sampler sampler(SamplerKind::owen_sobol, samples, hash(params.seed, kCellRaceSeed));
  const Sampler places(SamplerKind::owen_sobol, static_cast<uint32_t>(count), 0);
  const Sampler::Pixel everywhere = places.pixel(0, 0);
  std::vector<std::vector<Errors>> errors(count);
  parallel_for(count, 1, [&](size_t begin, size_t end) {
    Square square(context, scene, sampler);
    for (size_t i = begin; i < end; ++i) {
      const SamplePoint at = places.point(everywhere, static_cast<uint32_t>(i));
      const auto place = [&](float share, uint64_t length) {
        return static_cast<int>(share * static_cast<float>(length - side + 1));
      };
      square.look(place(at.x, width), place(at.y, height), static_cast<int>(side), monitor);
      errors[i] = race(context.shader, square, static_cast<int>(side), samples, candidates,
                       hash(params.seed, kCellRaceSeed, i));
    }
  });
  std::optional<CellOptions> best;
  double least = std::numeric_limits<double>::infinity();
  bool any_wins = false;
  for (size_t c = 0; c < candidates.size(); ++c) {
    Duel duel;
    for (const auto& of_square : errors)
      for (const Errors& pixel : of_square) duel.add(pixel.shared[c], pixel.alone);
    any_wins = any_wins || duel.is_won();
    const double costs = cost(candidates[c], duel.mean_ours(), duel.mean_theirs());
    if ((open && !(duel.mean_ours() < duel.mean_theirs())) || !(costs < least)) continue;
    best = candidates[c];
    least = costs;
  }
  return any_wins || !open ? best : std::nullopt;
}

}  // namespace kairos
