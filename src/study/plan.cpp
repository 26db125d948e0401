#include "study/plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace kairos::study {

namespace {

bool is_qmc(Method method) {
  return method == Method::random || method == Method::multi_jitter || method == Method::owen_sobol;
}

SamplerKind sampler_of(Method method) {
  if (method == Method::random) return SamplerKind::random;
  return method == Method::multi_jitter ? SamplerKind::multi_jitter : SamplerKind::owen_sobol;
}

/// mixed: discrete rays per time-continuous one. Four of them cost less than a tenth of it.
constexpr int kStillRaysPerTcRay = 4;

void add_tc(const StudyOptions& options, std::vector<Series>& all) {
  const int ladder_samples =
      *std::min_element(options.shading_samples.begin(), options.shading_samples.end(), [](int a, int b) {
        return std::abs(std::log2(a) - std::log2(kLadderSamples)) < std::abs(std::log2(b) - std::log2(kLadderSamples));
      });
  Series ladder{std::string(kTcLadder), fmt::format("tc, growing rays, N = {}", ladder_samples), {}};
  for (const int rays : options.tc_rays) {
    ladder.settings.push_back({Method::tc, 0, rays, ladder_samples});
    if (rays > kMostDetailRays) continue;
    Series series{fmt::format("tc-{}", rays), fmt::format("tc, {} ray{}, growing N", rays, rays == 1 ? "" : "s"), {}};
    for (const int samples : options.shading_samples) series.settings.push_back({Method::tc, 0, rays, samples});
    all.push_back(series);
  }
  all.push_back(ladder);
}

}  // namespace

std::string name_of(const Setting& s) {
  const std::string_view method = to_string(s.method);
  if (s.method == Method::tc) return fmt::format("{}-{}-{}", method, s.tc_rays, s.shading_samples);
  if (s.method == Method::mixed) return fmt::format("{}-{}-{}", method, s.tc_rays, s.spp);
  return fmt::format("{}-{}", method, s.spp);
}

std::string label_of(const Setting& s) {
  const char* const plural = s.tc_rays == 1 ? "" : "s";
  if (s.method == Method::tc) return fmt::format("{} TC ray{}, N = {}", s.tc_rays, plural, s.shading_samples);
  if (s.method == Method::mixed) return fmt::format("{} TC ray{}, {} spp", s.tc_rays, plural, s.spp);
  return fmt::format("{} spp", s.spp);
}

RenderParams params_of(const Setting& setting) {
  RenderParams params;
  params.filter = FilterKind::box;
  params.sampler = sampler_of(setting.method);
  params.integrator = IntegratorKind::qmc;
  if (setting.method == Method::tc) params.integrator = IntegratorKind::tc;
  if (setting.method == Method::mixed) params.integrator = IntegratorKind::mixed;
  if (setting.method == Method::automatic) params.integrator = IntegratorKind::automatic;
  if (setting.spp > 0) params.spp = setting.spp;
  if (setting.tc_rays > 0) params.tc_rays = setting.tc_rays;
  if (setting.shading_samples > 0) params.shading_samples = setting.shading_samples;
  return params;
}

std::vector<Series> series_of(const StudyOptions& options) {
  std::vector<Series> all;
  for (const Method method : options.methods) {
    const std::string name(to_string(method));
    if (method == Method::tc) {
      add_tc(options, all);
      continue;
    }
    Series series{name, is_qmc(method) ? "qmc, " + name : name, {}};
    if (method == Method::mixed)
      for (const int rays : options.tc_rays) series.settings.push_back({method, kStillRaysPerTcRay * rays, rays, 0});
    else
      for (const int spp : options.budgets) series.settings.push_back({method, spp, 0, 0});
    all.push_back(series);
  }
  return all;
}

double rough_cost(const Setting& s) {
  constexpr double kTcRay = 8, kShadingSample = 0.25, kStillRay = 0.3;
  return s.tc_rays * (kTcRay + kShadingSample * s.shading_samples) +
         s.spp * (s.method == Method::mixed ? kStillRay : 1);
}

std::vector<Setting> settings_of(const std::vector<Series>& all) {
  std::vector<Setting> settings;
  for (const Series& series : all)
    for (const Setting& setting : series.settings)
      if (std::find(settings.begin(), settings.end(), setting) == settings.end()) settings.push_back(setting);
  std::stable_sort(settings.begin(), settings.end(),
                   [](const Setting& a, const Setting& b) { return rough_cost(a) < rough_cost(b); });
  return settings;
}

}  // namespace kairos::study
