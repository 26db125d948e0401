// What pixels of a square would show if light were shared through cells of several kinds, and if it were not.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "discrete/discrete_scene.h"
#include "integrators/discrete_samples.h"
#include "math/hash.h"
#include "shading/look_ups.h"
#include "shading/pixel_context.h"
#include "shading/surface_cells.h"

namespace kairos {

/// All that a square's pixels see.
class CellSquare {
 public:
  CellSquare(const PixelContext& context, const DiscreteScene& scene, const Sampler& sampler)
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
struct CellErrors {
  double alone = 0;
  std::vector<double> shared;  // [kind of cells]
  double lit = 0, unlit = 0;   // how bright the pixel is, and would be with colours that are not lit
};

/// What is looked up in a square, answered by cells of each kind, and by light that each look-up asks for itself. See
/// choose_cells(). One thread's scratch memory.
class CellSquareRace {
 public:
  /// samples: look-ups of a pixel.
  CellSquareRace(const Shader& shader, uint32_t samples) : shader_(shader), samples_(samples) {}

  /// Of the square's pixels that are looked at. seed: of the square.
  std::vector<CellErrors> operator()(const CellSquare& square, uint64_t side, std::span<const CellOptions> kinds,
                                     uint64_t seed) {
    choose_pixels(side, seed);
    alone_.resize(pixels_.size());
    std::vector<CellErrors> errors(pixels_.size());
    for (size_t i = 0; i < pixels_.size(); ++i) {
      alone_[i] = {shaded_alone(square, pixels_[i], 0), shaded_alone(square, pixels_[i], 1)};
      errors[i].alone = product(alone_[i][0] - alone_[i][1], alone_[i][0] - alone_[i][1]) / 2;
      errors[i].lit = sum_of(alone_[i][0]);
      errors[i].unlit = sum_of(unlit(square, pixels_[i]));
    }
    surfaces_.resize(square.look_ups().count());
    shader_.own_light(square.look_ups().queries(), kinds.front().share_asked, surfaces_);
    for (const CellOptions& kind : kinds) add(kind, square, seed, errors);
    return errors;
  }

 private:
  /// Of a square's pixels so many are looked at, along either side.
  static constexpr uint64_t kLooksAlong = 8;
  static constexpr uint64_t kAloneDimension = 0x4341;

  /// As a display shows it: of so many samples, those given and others that are dark.
  static Vec3f shown(Vec3f sum, uint32_t samples) {
    sum = sum / static_cast<float>(samples);
    for (int c = 0; c < 3; ++c) sum[c] = std::clamp(sum[c], 0.0f, 1.0f);
    return sum;
  }

  static double sum_of(Vec3f v) { return static_cast<double>(v.x + v.y + v.z); }
  static double product(Vec3f a, Vec3f b) { return static_cast<double>(dot(a, b)); }

  void choose_pixels(uint64_t side, uint64_t seed) {
    pixels_.clear();
    const uint64_t step = std::max<uint64_t>(1, side / kLooksAlong), shift = hash(seed) % (step * step);
    for (uint64_t y = shift / step; y < side; y += step)
      for (uint64_t x = shift % step; x < side; x += step) pixels_.push_back(y * side + x);
  }

  /// What a pixel shows if each of its look-ups asks for light by itself.
  Vec3f shaded_alone(const CellSquare& square, size_t pixel, uint64_t half) {
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

  Vec3f unlit(const CellSquare& square, size_t pixel) const {
    const auto [begin, end] = square.of(pixel);
    Vec3f sum{};
    for (const ShadingQuery& query : square.look_ups().queries().subspan(begin, end - begin))
      sum += shader_.unlit_colour(query);
    return shown(sum, samples_);
  }

  void add(const CellOptions& kind, const CellSquare& square, uint64_t seed, std::vector<CellErrors>& errors) {
    SurfaceCells cells(shader_, kind);
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

}  // namespace kairos
