// From single runs to curves and comparisons.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/plan.h"
#include "study/run_log.h"
#include "study/statistics.h"

namespace kairos::study {

/// The reference should be better than what is measured against it by so many dB.
inline constexpr double kReferenceMargin = 10;

/// The runs of one setting, over seeds.
struct PointSummary {
  Setting setting;
  Estimate psnr, seconds, build_seconds, relative_mse;
  bool near_reference = false;  ///< less than kReferenceMargin worse than the reference is: not to be trusted
  Run first;                    ///< the run of the first seed, for its counters
};

struct SeriesSummary {
  Series series;
  std::vector<PointSummary> points;  ///< of the settings that have runs
};

/// A method against a baseline in equal time, and in equal quality.
struct Comparison {
  enum class At {
    psnr,     ///< the time at which the baseline has so many dB
    spp,      ///< the time of the baseline's so many samples per pixel
    tc_rays,  ///< the time of so many time-continuous rays per pixel, of the series kTcLadder
  };
  std::string series, baseline;
  At at = At::psnr;
  double value = 0;               ///< dB, samples or rays
  double seconds = 0;             ///< the time meant, median
  double baseline_psnr = 0;       ///< the baseline's then, median
  std::optional<Estimate> gain;   ///< dB more than the baseline in that time
  std::optional<Estimate> speed;  ///< time of the baseline over time of the method, for the baseline's PSNR then
};

struct EntrySummary {
  Entry entry;
  std::optional<ReferenceRun> reference;
  std::vector<SeriesSummary> series;
  std::vector<Comparison> comparisons;
};

/// The baselines' qualities at which methods are compared, dB.
inline constexpr int kLevels[] = {25, 30, 35, 38, 40, 45, 50};
inline constexpr Method kBaselines[] = {Method::owen_sobol, Method::multi_jitter};

/// runs: of any entries; those of `entry` are taken. Seeds are paired: a difference is taken within each seed, and its
/// interval is over seeds. What a curve does not reach in every seed is left out.
EntrySummary summarize(const Entry& entry, const std::vector<Series>& all, const std::vector<Run>& runs,
                       const std::optional<ReferenceRun>& reference);

/// CSV with a header.
std::string curves_csv(const std::vector<EntrySummary>& entries);
std::string comparisons_csv(const std::vector<EntrySummary>& entries);

}  // namespace kairos::study

namespace kairos {

template <>
inline constexpr auto kNames<study::Comparison::At> =
    std::to_array<Named<study::Comparison::At>>({{"psnr", study::Comparison::At::psnr},
                                                 {"spp", study::Comparison::At::spp},
                                                 {"tc_rays", study::Comparison::At::tc_rays}});

}  // namespace kairos
