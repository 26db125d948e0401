#include "math/sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <kairos/error.h>

#include "math/hash.h"

namespace kairos {

namespace {

// Element `index` of a random permutation of [0, size). A bijection of the next power of two, made of odd
// multiplications, additions and shifted exclusive-ors, is walked along its cycle until it falls into the range.
uint32_t permute(uint32_t index, uint32_t size, uint64_t seed) {
  if (size < 2) return 0;
  const uint32_t mask = std::bit_ceil(size) - 1;
  const int half = std::max(1, static_cast<int>(std::bit_width(mask)) / 2);
  const auto add = static_cast<uint32_t>(seed), multiply = static_cast<uint32_t>(seed >> 32) | 1u;
  const uint64_t more = mix64(seed);
  const auto add_2 = static_cast<uint32_t>(more), multiply_2 = static_cast<uint32_t>(more >> 32) | 1u;
  uint32_t v = index;
  do {
    v = (v + add) & mask;
    v ^= v >> half;
    v = (v * multiply) & mask;
    v ^= v >> half;
    v = ((v + add_2) * multiply_2) & mask;
    v ^= v >> half;
    v = (v * 0x9e3779b1u + (add_2 >> 16)) & mask;
    v ^= v >> half;
  } while (v >= size);
  return v;
}

}  // namespace

Sampler::Sampler(SamplerKind kind, uint32_t count, uint64_t seed) : kind_(kind), count_(count), seed_(seed) {
  if (count == 0 || count > kMaxCount)
    throw Error(ErrorCode::bad_usage, "", "samples per pixel must be 1 to " + std::to_string(kMaxCount));
  if (kind == SamplerKind::owen_sobol) {
    sobol_.resize(count);
    for (uint32_t i = 0; i < count; ++i) sobol_[i] = sobol_reversed(i);
  }
  columns_ = std::max(1u, static_cast<uint32_t>(std::sqrt(static_cast<double>(count))));
  rows_ = (count + columns_ - 1) / columns_;
}

Sampler::Pixel Sampler::pixel(int x, int y) const {
  Pixel pixel;
  pixel.seed = hash(static_cast<uint32_t>(x), static_cast<uint32_t>(y), seed_);
  if (kind_ == SamplerKind::owen_sobol)
    for (size_t dimension = 0; dimension < 3; ++dimension)
      pixel.owen[dimension] = make_owen_key(hash(pixel.seed, dimension));
  return pixel;
}

// A. Kensler, "Correlated Multi-Jittered Sampling" (2013): each sample is jittered in a cell of a coarse grid and, in x
// and in y, in a stratum of a fine one; all rows of cells are shuffled alike. Time is stratified apart from (x, y).
SamplePoint Sampler::multi_jittered(uint64_t seed, uint32_t index) const {
  const auto number = [](uint32_t v) { return static_cast<double>(v); };
  // Of more cells than samples a random choice stays empty, which keeps the mean unbiased.
  const uint32_t shuffled = permute(index, columns_ * rows_, hash(seed, 0));
  const uint32_t column = shuffled % columns_, row = shuffled / columns_;
  const uint32_t stratum_x = permute(row, rows_, hash(seed, 1)), stratum_y = permute(column, columns_, hash(seed, 2));
  const double jitter_x = unit_float(hash(seed, 3, index)), jitter_y = unit_float(hash(seed, 4, index));
  const double jitter_time = unit_float(hash(seed, 5, index));
  const double x = (number(column) + (number(stratum_x) + jitter_x) / rows_) / columns_;
  const double y = (number(row) + (number(stratum_y) + jitter_y) / columns_) / rows_;
  const double time = (number(permute(index, count_, hash(seed, 6))) + jitter_time) / count_;
  const auto below_one = [](double v) { return std::min(static_cast<float>(v), 1 - 0x1p-24f); };
  return {below_one(x), below_one(y), below_one(time)};
}

SamplePoint Sampler::point(const Pixel& pixel, uint32_t index) const {
  switch (kind_) {
    case SamplerKind::owen_sobol: {
      const ReversedPoint& p = sobol_[index];
      return {unit_float(owen_scramble(p[0], pixel.owen[0])), unit_float(owen_scramble(p[1], pixel.owen[1])),
              unit_float(owen_scramble(p[2], pixel.owen[2]))};
    }
    case SamplerKind::multi_jitter:
      return multi_jittered(pixel.seed, index);
    case SamplerKind::random:
      break;
  }
  return {unit_float(hash(pixel.seed, index, 0)), unit_float(hash(pixel.seed, index, 1)),
          unit_float(hash(pixel.seed, index, 2))};
}

}  // namespace kairos
