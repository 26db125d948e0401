#include "scene_io/pbrt/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/file.h"
#include "scene_io/pbrt/geometry.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

/// Linear Rec. 709 from CIE XYZ (D65).
Vec3d rgb_from_xyz(Vec3d c) {
  return {3.2404542 * c.x - 1.5371385 * c.y - 0.4985314 * c.z, -0.9692660 * c.x + 1.8760108 * c.y + 0.0415560 * c.z,
          0.0556434 * c.x - 0.2040259 * c.y + 1.0572252 * c.z};
}

Vec3d no_less_than_zero(Vec3d c) { return {std::max(c.x, 0.0), std::max(c.y, 0.0), std::max(c.z, 0.0)}; }

/// One lobe of a fit to the colour matching functions, its width different on both sides of the peak. Nanometres.
double lobe(double wavelength, double peak, double below, double above) {
  const double x = (wavelength - peak) / (wavelength < peak ? below : above);
  return std::exp(-x * x / 2);
}

/// C. Wyman, P.-P. Sloan and P. Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions"
/// (2013).
Vec3d color_matching(double w) {
  return {1.056 * lobe(w, 599.8, 37.9, 31.0) + 0.362 * lobe(w, 442.0, 16.0, 26.7) - 0.065 * lobe(w, 501.1, 20.4, 26.2),
          0.821 * lobe(w, 568.8, 46.9, 40.5) + 0.286 * lobe(w, 530.9, 16.3, 31.1),
          1.217 * lobe(w, 437.0, 11.8, 36.0) + 0.681 * lobe(w, 459.0, 26.0, 13.8)};
}

struct Metal {
  const char* name;
  Vec3d color;
};
// Reflectance at normal incidence, from the metals' indices of refraction.
constexpr std::array<Metal, 6> kMetals{{{"CuZn", {0.91, 0.78, 0.42}},
                                        {"Cu", {0.955, 0.638, 0.538}},
                                        {"Ag", {0.972, 0.960, 0.915}},
                                        {"Al", {0.913, 0.922, 0.924}},
                                        {"Au", {1.000, 0.782, 0.344}},
                                        {"TiO2", {0.22, 0.23, 0.27}}}};
struct Glass {
  const char* name;
  double ior;  ///< at the sodium line
};
constexpr std::array<Glass, 8> kGlasses{{{"BK7", 1.5168},
                                         {"BAF10", 1.67},
                                         {"FK51A", 1.4866},
                                         {"LASF9", 1.8503},
                                         {"SF5", 1.6727},
                                         {"F5", 1.6034},
                                         {"SF10", 1.7283},
                                         {"SF11", 1.7847}}};

/// Is `word` in `name` between characters that are no letters or digits?
bool has_word(const std::string& name, const std::string& word) {
  const auto is_part = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  for (size_t at = name.find(word); at != name.npos; at = name.find(word, at + 1)) {
    const size_t end = at + word.size();
    if ((at == 0 || !is_part(name[at - 1])) && (end == name.size() || !is_part(name[end]))) return true;
  }
  return false;
}

std::vector<double> read_samples(const std::string& path) {
  constexpr uint64_t kMaxFileSize = 16 << 20;
  const std::vector<uint8_t> bytes = read_file(path, kMaxFileSize);
  Tokens tokens({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
  std::vector<double> samples;
  while (tokens.peek().kind != Token::Kind::end) samples.push_back(tokens.take_number());
  return samples;
}

}  // namespace

Vec3d blackbody_light(double kelvin) {
  if (!(kelvin > 0)) return {};
  constexpr double kFirst = 360, kLast = 830, kStep = 5;
  constexpr double kSecondRadiation = 1.438776877e7;  // h c / k in nm K
  constexpr double kDisplacement = 2.897771955e6;     // Wien: the peak's wavelength times the temperature, in nm K
  const double peak = kDisplacement / kelvin;
  const double at_peak = std::expm1(kSecondRadiation / kDisplacement);
  Vec3d xyz{};
  double white = 0;  // luminance where the spectrum is 1 throughout
  for (double w = kFirst; w <= kLast; w += kStep) {
    const double relative =
        std::pow(peak / w, 5) * (at_peak / std::expm1(std::min(kSecondRadiation / (w * kelvin), 700.0)));
    xyz += color_matching(w) * relative;
    white += color_matching(w).y;
  }
  const Vec3d rgb = no_less_than_zero(rgb_from_xyz(xyz / white));
  return is_finite(rgb) ? rgb : Vec3d{};
}

Vec3d blackbody_color(double kelvin) {
  // Where next to nothing of the light is visible, the colour is that of the reddest that is.
  constexpr double kLeast = 500, kMost = 1e6;
  if (!(kelvin > 0)) return {};
  const Vec3d rgb = blackbody_light(std::clamp(kelvin, kLeast, kMost));
  return rgb / std::max({rgb.x, rgb.y, rgb.z});
}

std::optional<Vec3d> metal_color(const std::string& name) {
  for (const Metal& metal : kMetals)
    if (has_word(name, metal.name)) return metal.color;
  return std::nullopt;
}

std::optional<double> glass_ior(const std::string& name) {
  for (const Glass& glass : kGlasses)
    if (has_word(name, glass.name)) return glass.ior;
  return std::nullopt;
}

Vec3d band_color(const std::vector<double>& samples) {
  const size_t count = samples.size() / 2;
  const auto at = [&](double wavelength) {
    for (size_t i = 0; i < count; ++i) {
      if (samples[2 * i] < wavelength) continue;
      if (i == 0) return samples[1];
      const double low = samples[2 * i - 2], weight = (wavelength - low) / (samples[2 * i] - low);
      return samples[2 * i - 1] + (samples[2 * i + 1] - samples[2 * i - 1]) * weight;
    }
    return samples[2 * count - 1];
  };
  if (count == 0) return {};
  const auto mean = [&](double from, double to) {
    constexpr int kSteps = 16;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += at(from + (i + 0.5) * (to - from) / kSteps);
    return sum / kSteps;
  };
  return no_less_than_zero({mean(580, 680), mean(490, 580), mean(420, 490)});
}

Vec3d light_color(const Parameters& parameters, const char* name, Vec3d otherwise, SpectrumContext& context) {
  const Parameter* found = parameters.find(name);
  const bool is_blackbody = found && found->type == "blackbody" && !found->numbers.empty();
  const Vec3d color = spectrum_color(parameters, name, otherwise, context);
  if (!is_blackbody) return color;
  if (found->numbers.size() > 1) return blackbody_light(found->numbers[0]) * std::max(found->numbers[1], 0.0);
  const double luminance = 0.2126 * color.x + 0.7152 * color.y + 0.0722 * color.z;  // Rec. 709
  return luminance > 0 ? color / luminance : color;
}

Vec3d spectrum_color(const Parameters& parameters, const char* name, Vec3d otherwise, SpectrumContext& context) {
  const Parameter* found = parameters.find(name);
  if (!found || found->type == "texture") return otherwise;
  const Place place = parameters.place(*found);
  const std::vector<double>& n = found->numbers;
  for (const double number : n)
    if (!std::isfinite(number)) fail(place, "'" + printable(found->name) + "' holds a number that is not finite");
  const std::string what = "spectra are taken as three colours";
  if (found->type == "rgb" || found->type == "color" || found->type == "xyz") {
    if (n.size() != 3) fail(place, "'" + printable(found->name) + "' needs three numbers");
    const Vec3d color{n[0], n[1], n[2]};
    return no_less_than_zero(found->type == "xyz" ? rgb_from_xyz(color) : color);
  }
  if (found->type == "blackbody") {
    if (n.empty()) fail(place, "a black body needs a temperature");
    return blackbody_color(n[0]) * (n.size() > 1 ? std::max(n[1], 0.0) : 1.0);  // pbrt-v3 has a scale after it
  }
  if (found->type == "float") {
    if (n.size() != 1) fail(place, "'" + printable(found->name) + "' needs one number");
    const double value = std::max(n[0], 0.0);
    return {value, value, value};
  }
  if (found->type != "spectrum") {
    context.warnings.add(place, "a '" + printable(found->type) + "' is no kind of spectrum that is known: left out");
    return otherwise;
  }
  if (found->strings.empty()) {
    if (n.size() < 2 || n.size() % 2 != 0) fail(place, "a spectrum needs pairs of wavelength and value");
    context.warnings.add(place, what);
    return band_color(n);
  }
  const std::string& text = found->strings[0];
  if (metal_color(text) || glass_ior(text)) {
    context.warnings.add(place, what);
    return otherwise;
  }
  if (text.find("illum") != text.npos) {  // v4's standard illuminants: white, for us
    context.warnings.add(place, what);
    return {1, 1, 1};
  }
  const auto path = find_file(text, place, context.folder, context.warnings);
  if (!path) return otherwise;
  context.warnings.add(place, what);
  const std::vector<double> samples = read_samples(*path);
  return samples.size() >= 2 ? band_color(samples) : otherwise;
}

}  // namespace kairos::pbrt
