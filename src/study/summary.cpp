#include "study/summary.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "study/curve.h"

namespace kairos::study {

namespace {

/// [seed]: the series' runs with that seed.
using RunsBySeed = std::map<int, std::vector<const Run*>>;

RunsBySeed runs_of(const Series& series, const Entry& entry, const std::vector<Run>& runs) {
  RunsBySeed by_seed;
  for (const Setting& setting : series.settings)
    for (const Run& run : runs)
      if (run.entry == entry && run.setting == setting) by_seed[run.seed].push_back(&run);
  return by_seed;
}

Curve curve_of(const std::vector<const Run*>& runs) {
  std::vector<CurvePoint> points;
  for (const Run* run : runs) points.push_back({run->seconds, run->error.psnr});
  return Curve(points);
}

PointSummary summarize_point(const Setting& setting, const std::vector<const Run*>& runs,
                             const std::optional<ReferenceRun>& reference) {
  std::vector<double> psnr, seconds, build, relative;
  for (const Run* run : runs) {
    psnr.push_back(run->error.psnr);
    seconds.push_back(run->seconds);
    build.push_back(run->build_seconds);
    relative.push_back(run->error.relative_mse);
  }
  const Estimate quality = estimate(psnr);
  const bool near_reference = reference && quality.median + kReferenceMargin > reference->error.psnr;
  return {setting, quality, estimate(seconds), estimate(build), estimate(relative), near_reference, *runs.front()};
}

/// What is asked at one place of a comparison, seed by seed.
struct Place {
  Comparison::At at;
  double value;
};

/// A time, and what the baseline has then.
struct Moment {
  double seconds, level;
};

/// Where `place` is among one seed's runs. tc: those of kTcLadder.
std::optional<Moment> moment_of(const Place& place, const std::vector<const Run*>& base, const Curve& base_curve,
                                const std::vector<const Run*>& tc) {
  std::optional<Moment> moment;
  if (place.at == Comparison::At::psnr) {
    if (const auto seconds = base_curve.seconds_at(place.value)) moment = {*seconds, place.value};
  } else if (place.at == Comparison::At::spp) {
    for (const Run* run : base)
      if (run->setting.spp == static_cast<int>(place.value) && std::isfinite(run->error.psnr))
        moment = {run->seconds, run->error.psnr};
  } else {
    for (const Run* run : tc)
      if (run->setting.tc_rays == static_cast<int>(place.value))
        if (const auto psnr = base_curve.psnr_at(run->seconds)) moment = {run->seconds, *psnr};
  }
  return moment;
}

std::optional<Comparison> compare_at(const Place& place, const Series& series, const RunsBySeed& method,
                                     const Series& baseline, const RunsBySeed& base, const RunsBySeed& tc) {
  Comparison result{series.name, baseline.name, place.at, place.value, 0, 0, {}, {}};
  std::vector<double> seconds, levels, gains, speeds;
  size_t seeds = 0;
  for (const auto& [seed, base_runs] : base) {
    const auto found = method.find(seed), found_tc = tc.find(seed);
    if (found == method.end()) continue;
    ++seeds;
    const Curve base_curve = curve_of(base_runs), curve = curve_of(found->second);
    const auto moment =
        moment_of(place, base_runs, base_curve, found_tc == tc.end() ? std::vector<const Run*>() : found_tc->second);
    if (!moment) continue;
    seconds.push_back(moment->seconds);
    levels.push_back(moment->level);
    if (const auto psnr = curve.psnr_at(moment->seconds)) gains.push_back(*psnr - moment->level);
    if (const auto own = curve.seconds_at(moment->level)) speeds.push_back(moment->seconds / *own);
  }
  if (seeds == 0 || seconds.size() < seeds) return std::nullopt;
  result.seconds = median(seconds);
  result.baseline_psnr = median(levels);
  if (gains.size() == seeds) result.gain = estimate(gains);
  if (speeds.size() == seeds) result.speed = estimate_of_ratios(speeds);
  if (!result.gain && !result.speed) return std::nullopt;
  return result;
}

std::vector<Comparison> compare(const Entry& entry, const std::vector<Series>& all, const std::vector<Run>& runs) {
  std::vector<Comparison> comparisons;
  const auto ladder = std::find_if(all.begin(), all.end(), [](const Series& s) { return s.name == kTcLadder; });
  const RunsBySeed tc = ladder == all.end() ? RunsBySeed() : runs_of(*ladder, entry, runs);
  for (const Method method : kBaselines) {
    const auto baseline = std::find_if(all.begin(), all.end(),
                                       [&](const Series& series) { return series.settings.front().method == method; });
    if (baseline == all.end()) continue;
    const RunsBySeed base = runs_of(*baseline, entry, runs);
    std::vector<Place> places;
    for (const int level : kLevels) places.push_back({Comparison::At::psnr, static_cast<double>(level)});
    for (const Setting& s : baseline->settings) places.push_back({Comparison::At::spp, static_cast<double>(s.spp)});
    if (ladder != all.end())
      for (const Setting& s : ladder->settings)
        places.push_back({Comparison::At::tc_rays, static_cast<double>(s.tc_rays)});
    for (const Series& series : all) {
      if (series.name == baseline->name) continue;
      const RunsBySeed own = runs_of(series, entry, runs);
      for (const Place& place : places)
        if (const auto comparison = compare_at(place, series, own, *baseline, base, tc))
          comparisons.push_back(*comparison);
    }
  }
  return comparisons;
}

std::string entry_fields(const EntrySummary& e) {
  return fmt::format("{},{}", e.entry.scene, to_string(e.entry.shading));
}

/// "median,low,high", with nothing for what is not known.
std::string fields(const std::optional<Estimate>& e) {
  if (!e) return ",,";
  if (std::isnan(e->low)) return fmt::format("{:.5g},,", e->median);
  return fmt::format("{:.5g},{:.5g},{:.5g}", e->median, e->low, e->high);
}

}  // namespace

EntrySummary summarize(const Entry& entry, const std::vector<Series>& all, const std::vector<Run>& runs,
                       const std::optional<ReferenceRun>& reference) {
  EntrySummary summary{entry, reference, {}, compare(entry, all, runs)};
  for (const Series& series : all) {
    SeriesSummary of_series{series, {}};
    for (const Setting& setting : series.settings) {
      std::vector<const Run*> own;
      for (const Run& run : runs)
        if (run.entry == entry && run.setting == setting) own.push_back(&run);
      if (!own.empty()) of_series.points.push_back(summarize_point(setting, own, reference));
    }
    summary.series.push_back(of_series);
  }
  return summary;
}

std::string curves_csv(const std::vector<EntrySummary>& entries) {
  std::string text =
      "scene,shading,series,spp,tc_rays,shading_samples,seconds,seconds_low,seconds_high,build_seconds,psnr,psnr_low,"
      "psnr_high,relative_mse,reference_psnr,near_reference\n";
  for (const EntrySummary& entry : entries)
    for (const SeriesSummary& series : entry.series)
      for (const PointSummary& p : series.points)
        text += fmt::format("{},{},{},{},{},{},{:.5g},{},{:.5g},{},{}\n", entry_fields(entry), series.series.name,
                            p.setting.spp, p.setting.tc_rays, p.setting.shading_samples, fields(p.seconds),
                            p.build_seconds.median, fields(p.psnr), p.relative_mse.median,
                            entry.reference ? fmt::format("{:.5g}", entry.reference->error.psnr) : "",
                            p.near_reference ? 1 : 0);
  return text;
}

std::string comparisons_csv(const std::vector<EntrySummary>& entries) {
  std::string text =
      "scene,shading,series,baseline,at,value,seconds,baseline_psnr,gain_db,gain_low,gain_high,speed,speed_low,"
      "speed_high\n";
  for (const EntrySummary& entry : entries)
    for (const Comparison& c : entry.comparisons)
      text += fmt::format("{},{},{},{},{:.5g},{:.5g},{:.5g},{},{}\n", entry_fields(entry), c.series, c.baseline,
                          to_string(c.at), c.value, c.seconds, c.baseline_psnr, fields(c.gain), fields(c.speed));
  return text;
}

}  // namespace kairos::study
