// Spectra as linear Rec. 709 colours, as well as three numbers can say it.
#pragma once

#include <optional>
#include <string>

#include "base/file.h"
#include "scene_io/pbrt/parameters.h"

namespace kairos::pbrt {

constexpr Vec3d kWhite{1, 1, 1};

struct SpectrumContext {
  SceneFolder folder;  ///< files of samples are found from here, and may not lie outside
  Warnings& warnings;
};

/// The colour of parameter `name`, or `otherwise` where it is absent (or a texture's name): rgb, color, xyz, blackbody,
/// float, and spectrum: sampled in place or in a file. The last kinds come with a warning. A name of a metal or glass
/// gives `otherwise`: see metal_color() and glass_ior().
Vec3d spectrum_color(const Parameters& parameters, const char* name, Vec3d otherwise, SpectrumContext& context);

/// The same for a light. Black bodies differ: pbrt-v4, which gives their temperature alone, makes their luminance 1; v3
/// makes the peak of their spectrum 1, wherever it lies.
Vec3d light_color(const Parameters& parameters, const char* name, Vec3d otherwise, SpectrumContext& context);

/// Linear Rec. 709 of a black body's light where its spectrum's peak is 1. Kelvin; zero for none.
Vec3d blackbody_light(double kelvin);

/// Chromaticity of a black body, scaled so that its largest component is 1. Kelvin; zero for none.
Vec3d blackbody_color(double kelvin);

/// The colour of light that a named metal ("metal-Cu-eta", "spds/metals/Cu.eta.spd", "Cu") reflects straight back.
std::optional<Vec3d> metal_color(const std::string& name);

/// The index of refraction of a named glass ("glass-BK7").
std::optional<double> glass_ior(const std::string& name);

/// Mean of a spectrum's samples (wavelength in nm, value, ...) over the thirds of the visible that red, green and blue
/// stand for.
Vec3d band_color(const std::vector<double>& samples);

}  // namespace kairos::pbrt
