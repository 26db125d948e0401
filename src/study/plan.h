// What a study measures: which methods, with which parameters, in which order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <kairos/study.h>

namespace kairos::study {

/// One setting of one method.
struct Setting {
  Method method = Method::owen_sobol;
  int spp = 0, tc_rays = 0, shading_samples = 0;  ///< 0: the method has none

  bool operator==(const Setting&) const = default;
};

/// Names a setting in tables and files: "owen-sobol-64", "tc-4-8" (rays, shading samples), "mixed-4-16", "auto-64".
std::string name_of(const Setting& setting);
/// The same to read: "64 spp", "4 rays, N = 8".
std::string label_of(const Setting& setting);
/// With box filter and nothing but colour; seed, shading, keys and threads remain to be filled in.
RenderParams params_of(const Setting& setting);

/// Settings of one method that make a curve, from cheap to dear.
struct Series {
  std::string name, label;
  std::vector<Setting> settings;
};

/// For tc: one series over growing rays, with kLadderSamples shading samples each (or what comes closest in the list);
/// and for each number of rays up to kMostDetailRays one over growing shading samples.
std::vector<Series> series_of(const StudyOptions& options);
inline constexpr int kLadderSamples = 8, kMostDetailRays = 4;
inline constexpr std::string_view kTcLadder = "tc";  ///< name of the former

/// Every setting of these series once, those of about the same cost next to each other, so that no method has a part of
/// the study to itself.
std::vector<Setting> settings_of(const std::vector<Series>& all);

/// Roughly how long a setting takes, in units of one discrete sample per pixel: to say how much time is left.
double rough_cost(const Setting& setting);

}  // namespace kairos::study
