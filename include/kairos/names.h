// The names by which the values of enums are known on the command line, in files' headers and in scene files.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include <kairos/render.h>

namespace kairos {

template <class Enum>
using Named = std::pair<std::string_view, Enum>;

/// Names of an enum's values, each once. Specialised for every enum that has names.
template <class Enum>
inline constexpr std::array<Named<Enum>, 0> kNames{};

template <>
inline constexpr auto kNames<IntegratorKind> = std::to_array<Named<IntegratorKind>>({{"tc", IntegratorKind::tc},
                                                                                     {"qmc", IntegratorKind::qmc},
                                                                                     {"mixed", IntegratorKind::mixed},
                                                                                     {"auto",
                                                                                      IntegratorKind::automatic}});
template <>
inline constexpr auto kNames<SamplerKind> = std::to_array<Named<SamplerKind>>({{"owen-sobol", SamplerKind::owen_sobol},
                                                                               {"multi-jitter",
                                                                                SamplerKind::multi_jitter},
                                                                               {"random", SamplerKind::random}});
/// Those that show surfaces first.
template <>
inline constexpr auto kNames<ShadingKind> = std::to_array<Named<ShadingKind>>({{"normal", ShadingKind::normal},
                                                                               {"flat", ShadingKind::flat},
                                                                               {"whitted", ShadingKind::whitted},
                                                                               {"path", ShadingKind::path},
                                                                               {"bounds", ShadingKind::bounds},
                                                                               {"bounds-exact",
                                                                                ShadingKind::bounds_exact}});
template <>
inline constexpr auto kNames<Clusters> = std::to_array<Named<Clusters>>(
    {{"auto", Clusters::automatic}, {"on", Clusters::on}, {"pixel", Clusters::pixel}, {"off", Clusters::off}});
template <>
inline constexpr auto kNames<Cells> =
    std::to_array<Named<Cells>>({{"auto", Cells::automatic}, {"on", Cells::on}, {"off", Cells::off}});
template <>
inline constexpr auto kNames<Shadows> = std::to_array<Named<Shadows>>({{"auto", Shadows::automatic},
                                                                       {"sampled", Shadows::sampled},
                                                                       {"exact", Shadows::exact}});
template <>
inline constexpr auto kNames<Mirrors> = std::to_array<Named<Mirrors>>({{"auto", Mirrors::automatic},
                                                                       {"sampled", Mirrors::sampled},
                                                                       {"exact", Mirrors::exact}});
template <>
inline constexpr auto kNames<FilterKind> = std::to_array<Named<FilterKind>>(
    {{"box", FilterKind::box}, {"gaussian", FilterKind::gaussian}, {"blackman-harris", FilterKind::blackman_harris}});
template <>
inline constexpr auto kNames<Aov> = std::to_array<Named<Aov>>({{"depth", Aov::depth},
                                                               {"normal", Aov::normal},
                                                               {"albedo", Aov::albedo},
                                                               {"coverage", Aov::coverage},
                                                               {"segments", Aov::segments},
                                                               {"mesh", Aov::mesh}});
template <>
inline constexpr auto kNames<Scan> = std::to_array<Named<Scan>>(
    {{"top", Scan::top}, {"bottom", Scan::bottom}, {"left", Scan::left}, {"right", Scan::right}});
template <>
inline constexpr auto kNames<Normalise> = std::to_array<Named<Normalise>>({{"mean", Normalise::mean},
                                                                           {"energy", Normalise::energy}});
template <>
inline constexpr auto kNames<ShotOptions::Instances> =
    std::to_array<Named<ShotOptions::Instances>>({{"auto", ShotOptions::Instances::automatic},
                                                  {"never", ShotOptions::Instances::never},
                                                  {"always", ShotOptions::Instances::always}});
template <>
inline constexpr auto kNames<LightChoice> = std::to_array<Named<LightChoice>>({{"auto", LightChoice::automatic},
                                                                               {"file", LightChoice::file},
                                                                               {"studio", LightChoice::studio},
                                                                               {"none", LightChoice::none}});
template <>
inline constexpr auto kNames<ViewTransform> =
    std::to_array<Named<ViewTransform>>({{"standard", ViewTransform::standard}, {"filmic", ViewTransform::filmic}});
template <>
inline constexpr auto kNames<InstructionSet> = std::to_array<Named<InstructionSet>>({{"scalar", InstructionSet::scalar},
                                                                                     {"sse4", InstructionSet::sse4},
                                                                                     {"avx2", InstructionSet::avx2},
                                                                                     {"avx512", InstructionSet::avx512},
                                                                                     {"neon", InstructionSet::neon}});
template <>
inline constexpr auto kNames<TextureWrap> = std::to_array<Named<TextureWrap>>({{"repeat", TextureWrap::repeat},
                                                                               {"clamp", TextureWrap::clamp},
                                                                               {"mirror", TextureWrap::mirror}});
template <>
inline constexpr auto kNames<Material::AlphaMode> =
    std::to_array<Named<Material::AlphaMode>>({{"opaque", Material::AlphaMode::opaque},
                                               {"mask", Material::AlphaMode::mask},
                                               {"blend", Material::AlphaMode::blend}});

/// Empty for a number that is no value of the enum.
template <class Enum>
requires(!kNames<Enum>.empty()) constexpr std::string_view to_string(Enum value) {
  for (const auto& [name, known] : kNames<Enum>)
    if (known == value) return name;
  return {};
}

/// parse<SamplerKind>("random"); nullopt for a name that no value has.
template <class Enum>
requires(!kNames<Enum>.empty()) constexpr std::optional<Enum> parse(std::string_view name) {
  for (const auto& [known, value] : kNames<Enum>)
    if (known == name) return value;
  return std::nullopt;
}

}  // namespace kairos
