#include "study/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <kairos/compare.h>

#include "study/statistics.h"

namespace kairos::study {

namespace {

constexpr std::array<const char*, 3> kColours{"R", "G", "B"};
constexpr double kRelativeFloor = 0.01;  // added to the squared reference: black would count for infinitely much
constexpr double kDecades = 4;           // that error codes span, up to 1
constexpr uint64_t kReferenceSeeds[] = {0x5eed0001, 0x5eed0002};  // runs have small ones

double clock_seconds(const RenderStats& stats, Clock clock) {
  return clock == Clock::wall ? stats.render_seconds : stats.render_cpu_seconds / stats.threads;
}

/// The squared difference, as a display shows it.
double square_shown(float expected, float got) {
  const double off = static_cast<double>(std::min(got, 1.0f)) - static_cast<double>(std::min(expected, 1.0f));
  return off * off;
}

RenderParams params_under(const Conditions& conditions, const Setting& setting, uint64_t seed) {
  RenderParams params = params_of(setting);
  params.shading = conditions.shading;
  params.discrete_keys = conditions.keys;
  params.threads = conditions.threads;
  params.seed = seed;
  return params;
}

/// One picture below the other.
void append(const Image& below, Image& image) {
  for (Channel& channel : image.channels) {
    const std::vector<float>& values = below.find(channel.name)->values;
    channel.values.insert(channel.values.end(), values.begin(), values.end());
  }
  image.height += below.height;
}

/// What is done once for a whole frame counts by the share of it that is rendered.
void charge_by_share(const Crop& part, const Image& image, RenderStats& stats) {
  const double share = static_cast<double>(part.x1 - part.x0) * static_cast<double>(part.y1 - part.y0) /
                       (static_cast<double>(image.frame_width) * static_cast<double>(image.frame_height));
  stats.render_seconds -= (1 - share) * stats.prepare_seconds;
  stats.render_cpu_seconds -= (1 - share) * stats.prepare_cpu_seconds;
}

/// What the conditions say is rendered, as one picture, and the sum of its costs.
Image render_parts(Renderer& renderer, const Conditions& conditions, RenderParams params, RenderStats& stats,
                   const Progress& progress) {
  if (conditions.parts.empty()) return renderer.render(params, &stats, progress);
  Image image;
  const double count = static_cast<double>(conditions.parts.size());
  for (size_t part = 0; part < conditions.parts.size(); ++part) {
    params.crop = conditions.parts[part];
    RenderStats own;
    Image below = renderer.render(params, &own, [&](double fraction) {
      return !progress || progress((static_cast<double>(part) + fraction) / count);
    });
    charge_by_share(*params.crop, below, own);
    if (part == 0) {
      image = std::move(below);
      stats = own;
      continue;
    }
    append(below, image);
    stats.render_seconds += own.render_seconds;
    stats.render_cpu_seconds += own.render_cpu_seconds;
    stats.rays += own.rays;
    stats.segments += own.segments;
    stats.shading_samples += own.shading_samples;
    stats.counters += own.counters;
  }
  image.left = image.top = 0;
  image.frame_width = image.width;
  image.frame_height = image.height;
  return image;
}

}  // namespace

std::vector<kairos::Crop> row_parts(int width, int height, int rows) {
  std::vector<kairos::Crop> parts;
  if (rows >= height) return parts;
  for (int row = 0; row < rows; ++row) {
    const int y = static_cast<int>((2 * int64_t{row} + 1) * height / (2 * int64_t{rows}));
    parts.push_back({0, width, y, y + 1});
  }
  return parts;
}

PictureError error_of(const Image& reference, const Image& image, const std::string& place) {
  difference(reference, image, place);  // do they fit each other?
  double sum = 0, relative = 0;
  for (const char* name : kColours) {
    const std::vector<float>&expected = reference.find(name)->values, &got = image.find(name)->values;
    for (size_t i = 0; i < got.size(); ++i) {
      const auto right = static_cast<double>(expected[i]), off = static_cast<double>(got[i]) - right;
      sum += square_shown(expected[i], got[i]);
      relative += off * off / (right * right + kRelativeFloor);
    }
  }
  const double count = 3.0 * static_cast<double>(image.find("R")->values.size()), mse = sum / count;
  const double psnr = mse > 0 ? -10 * std::log10(mse) : std::numeric_limits<double>::infinity();
  return {mse, psnr, relative / count};
}

std::vector<uint8_t> error_codes(const Image& reference, const Image& image) {
  std::vector<double> squares(image.find("R")->values.size());
  for (const char* name : kColours) {
    const std::vector<float>&expected = reference.find(name)->values, &got = image.find(name)->values;
    for (size_t i = 0; i < squares.size(); ++i) squares[i] += square_shown(expected[i], got[i]) / 3;
  }
  std::vector<uint8_t> codes;
  for (const double square : squares) {
    const double place = square > 0 ? 1 + std::log10(square) / 2 / kDecades : 0;
    codes.push_back(static_cast<uint8_t>(std::lround(std::clamp(place, 0.0, 1.0) * 255)));
  }
  return codes;
}

double difference_of(uint8_t error_code) {
  return error_code == 0 ? 0 : std::pow(10, (error_code / 255.0 - 1) * kDecades);
}

Measured measure(Renderer& renderer, const Setting& setting, const Conditions& conditions, uint64_t seed,
                 const Progress& progress) {
  constexpr size_t kMostTimes = 9;
  const RenderParams params = params_under(conditions, setting, seed);
  Measured result;
  std::vector<double> seconds;
  double sum = 0;
  do {
    result.image = render_parts(renderer, conditions, params, result.stats, progress);
    seconds.push_back(clock_seconds(result.stats, conditions.clock));
    sum += seconds.back();
  } while (sum < kShortest && seconds.size() < kMostTimes);
  // A clock that stands still would give a time of zero, which no curve can show.
  result.seconds = std::max(median(seconds), 1e-6);
  return result;
}

Reference render_reference(Renderer& renderer, const Conditions& conditions, int spp, const Progress& progress) {
  Conditions all_threads = conditions;
  all_threads.threads = 0;
  Reference result;
  result.spp = spp;
  std::array<Image, 2> halves;
  for (size_t half = 0; half < 2; ++half) {
    RenderStats stats;
    const auto told = [&](double fraction) {
      return !progress || progress((static_cast<double>(half) + fraction) / 2);
    };
    const RenderParams params = params_under(all_threads, {Method::owen_sobol, spp, 0, 0}, kReferenceSeeds[half]);
    halves[half] = render_parts(renderer, conditions, params, stats, told);
    result.seconds += stats.render_seconds;
  }
  result.image = halves[0];
  for (Channel& channel : result.image.channels) {
    const std::vector<float>& other = halves[1].find(channel.name)->values;
    for (size_t i = 0; i < other.size(); ++i) channel.values[i] = (channel.values[i] + other[i]) / 2;
  }
  // Half of the difference of two independent halves has the variance of their mean.
  result.error = error_of(result.image, halves[0], "half of the reference");
  return result;
}

std::vector<KeysTime> time_keys(Renderer& renderer, const Conditions& conditions, const std::vector<int>& candidates,
                                const Progress& progress) {
  constexpr int kSpp = 4, kTimes = 2;
  std::vector<KeysTime> times;
  for (const int keys : candidates) {
    Conditions with_keys = conditions;
    with_keys.keys = keys;
    const auto once = [&](uint64_t seed) {
      return measure(renderer, {Method::owen_sobol, kSpp, 0, 0}, with_keys, seed, progress).seconds;
    };
    once(0);
    KeysTime least{keys, once(1)};
    for (uint64_t seed = 2; seed <= kTimes; ++seed) least.seconds = std::min(least.seconds, once(seed));
    times.push_back(least);
  }
  std::stable_sort(times.begin(), times.end(),
                   [](const KeysTime& a, const KeysTime& b) { return a.seconds < b.seconds; });
  return times;
}

}  // namespace kairos::study
