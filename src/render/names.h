// The names by which parameters are known on the command line and in files' headers.
#pragma once

#include <string_view>
#include <utility>

#include <kairos/render.h>

namespace kairos {

inline constexpr std::pair<std::string_view, IntegratorKind> kIntegratorNames[] = {{"tc", IntegratorKind::tc},
                                                                                   {"qmc", IntegratorKind::qmc},
                                                                                   {"mixed", IntegratorKind::mixed},
                                                                                   {"auto", IntegratorKind::automatic}};
inline constexpr std::pair<std::string_view, SamplerKind> kSamplerNames[] = {
    {"owen-sobol", SamplerKind::owen_sobol},
    {"multi-jitter", SamplerKind::multi_jitter},
    {"random", SamplerKind::random}};
inline constexpr std::pair<std::string_view, ShadingKind> kShadingNames[] = {
    {"normal", ShadingKind::normal}, {"flat", ShadingKind::flat}, {"whitted", ShadingKind::whitted}};
/// With those that show no surfaces.
inline constexpr std::pair<std::string_view, ShadingKind> kAllShadingNames[] = {
    {"normal", ShadingKind::normal},
    {"flat", ShadingKind::flat},
    {"whitted", ShadingKind::whitted},
    {"bounds", ShadingKind::bounds},
    {"bounds-exact", ShadingKind::bounds_exact}};
inline constexpr std::pair<std::string_view, FilterKind> kFilterNames[] = {
    {"box", FilterKind::box}, {"gaussian", FilterKind::gaussian}, {"blackman-harris", FilterKind::blackman_harris}};
inline constexpr std::pair<std::string_view, Aov> kAovNames[] = {
    {"depth", Aov::depth},       {"normal", Aov::normal},     {"albedo", Aov::albedo},
    {"coverage", Aov::coverage}, {"segments", Aov::segments}, {"mesh", Aov::mesh}};

inline constexpr std::pair<std::string_view, Clusters> kClustersNames[] = {
    {"auto", Clusters::automatic}, {"on", Clusters::on}, {"pixel", Clusters::pixel}, {"off", Clusters::off}};

template <class Value, size_t N>
constexpr std::string_view name_of(const std::pair<std::string_view, Value> (&names)[N], Value value) {
  for (const auto& [name, known] : names)
    if (known == value) return name;
  return {};
}

}  // namespace kairos
