// One setting, rendered and measured; and what it is measured against.
#pragma once

#include <cstdint>
#include <vector>

#include <kairos/render.h>

#include "study/run_log.h"

namespace kairos::study {

/// Between linear colours, over all pixels and R, G, B. Mean squared difference, and PSNR with a peak of 1, of values
/// of which those above 1 count as 1, as a display shows them: else a few pixels that see a lamp would decide
/// everything. The mean of difference^2 / (reference^2 + 0.01), of the values as they are. Throws Error(bad_input) as
/// difference() does.
PictureError error_of(const Image& reference, const Image& image, const std::string& place);

/// Per pixel, the root of the mean over R, G, B of the squared difference that counts for PSNR, as a code of 8 bits
/// that is even on a logarithmic scale: 0 for 1e-4 and less, 255 for 1 and more.
std::vector<uint8_t> error_codes(const Image& reference, const Image& image);
/// The difference that a code stands for.
double difference_of(uint8_t error_code);

/// How a study's pictures are made, beside their setting.
struct Conditions {
  ShadingKind shading = ShadingKind::normal;
  int keys = 0;
  int threads = 1;
  Clock clock = Clock::cpu;
  std::vector<kairos::Crop>
      parts{};  ///< of the frame, of equal width, that are rendered and measured as one; empty: all of it
};

/// Rows of a frame, spread evenly over it, as parts; none where that would be all of them, or `rows` is 0.
std::vector<kairos::Crop> row_parts(int width, int height, int rows);

struct Measured {
  Image image;
  RenderStats stats;
  double seconds = 0;  ///< as the clock has it
};

/// Renders once or, what takes less than kShortest seconds, some times over and counts the median.
Measured measure(Renderer& renderer, const Setting& setting, const Conditions& conditions, uint64_t seed,
                 const Progress& progress);
inline constexpr double kShortest = 0.15;

struct Reference {
  Image image;         ///< the mean of both halves
  PictureError error;  ///< what it is estimated to be off by: a half of what the halves differ by
  int spp = 0;         ///< of each half
  double seconds = 0;
};

/// Two halves of joint Owen-Sobol' discrete samples with seeds that no run has, on all of the machine's threads.
Reference render_reference(Renderer& renderer, const Conditions& conditions, int spp, const Progress& progress);

struct KeysTime {
  int keys = 0;  ///< RenderParams::discrete_keys
  double seconds = 0;
};

/// How long discrete rays take with each of `candidates`: the least of two short renderings, after one to warm up. The
/// fastest comes first.
std::vector<KeysTime> time_keys(Renderer& renderer, const Conditions& conditions, const std::vector<int>& candidates,
                                const Progress& progress);

}  // namespace kairos::study
