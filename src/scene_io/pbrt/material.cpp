#include "scene_io/pbrt/material.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene_io/pbrt/geometry.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

constexpr Vec3d kHalf{0.5, 0.5, 0.5}, kQuarter{0.25, 0.25, 0.25};

template <size_t N>
bool is_one_of(const std::string& kind, const std::array<const char*, N>& kinds) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

/// Within [0, 1]; 0 for NaN, which products of very large and very small factors give.
float unit(double value) { return value > 0 ? static_cast<float>(std::min(value, 1.0)) : 0.0f; }
/// An index of refraction; that of air for NaN.
float index(double value) { return value > 1 ? static_cast<float>(std::min(value, 10.0)) : 1.0f; }
double largest(Vec3d color) { return std::max({color.x, color.y, color.z}); }

}  // namespace

Surface Materials::none_given() {
  Surface surface;
  surface.material.base_color = {0.5f, 0.5f, 0.5f};
  return surface;
}

void Materials::set_base(Surface& surface, const Texture& texture) {
  surface.material.base_color = {unit(texture.factor.x), unit(texture.factor.y), unit(texture.factor.z)};
  surface.material.base_color_texture = texture.reference();
}

double Materials::roughness(const Parameters& parameters, double otherwise, bool v3) {
  const double both = textures_.number(parameters, "roughness", otherwise);
  const double u = textures_.number(parameters, "uroughness", both),
               v = textures_.number(parameters, "vroughness", both);
  if (u != v) warnings_.add(parameters.place(), "roughness that differs by direction becomes its mean");
  double alpha = std::max(0.0, (u + v) / 2);
  if (parameters.boolean("remaproughness", true) && alpha > 0) {
    if (v3) {  // pbrt-v3's own fit
      const double x = std::log(std::max(alpha, 1e-3));
      alpha = 1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
    } else {
      alpha = std::sqrt(alpha);
    }
  }
  return std::sqrt(double{unit(alpha)});  // alpha is the square of glTF's roughness
}

double Materials::refraction(const Parameters& parameters, double otherwise) {
  for (const char* name : {"eta", "index"})
    if (const Parameter* found = parameters.find(name)) {
      if (found->type == "spectrum" && found->strings.size() == 1)
        if (const auto ior = glass_ior(found->strings[0])) return *ior;
      if (found->type != "float" && found->type != "texture")
        return mean(spectrum_color(parameters, name, {otherwise, otherwise, otherwise}, textures_.spectrum()));
      return textures_.number(parameters, name, otherwise);
    }
  return otherwise;
}

void Materials::metal(const Parameters& parameters, Surface& surface) {
  surface.material.metallic = 1;
  if (parameters.find("reflectance")) return set_base(surface, textures_.color(parameters, "reflectance", kHalf));
  std::optional<Vec3d> named = metal_color("Cu");  // pbrt's own default
  const Parameter *eta = parameters.find("eta"), *k = parameters.find("k");
  for (const Parameter* found : {k, eta})
    if (found && found->type == "spectrum" && found->strings.size() == 1) named = metal_color(found->strings[0]);
  const bool numbers = eta && k && eta->numbers.size() >= 3 && k->numbers.size() >= 3;
  if (!numbers) {
    if (!named) warnings_.add(parameters.place(), "a metal that is not known becomes grey");
    if (eta || k) warnings_.add(parameters.place(), "spectra are taken as three colours");
    return set_base(surface, {named.value_or(kHalf), "", {}});
  }
  const Vec3d n = spectrum_color(parameters, "eta", kWhite, textures_.spectrum());
  const Vec3d x = spectrum_color(parameters, "k", kWhite, textures_.spectrum());
  Vec3d reflected;
  for (int c = 0; c < 3; ++c) {  // Fresnel's reflectance at right angles
    const double absorbed = x[c] * x[c];
    reflected[c] = ((n[c] - 1) * (n[c] - 1) + absorbed) / ((n[c] + 1) * (n[c] + 1) + absorbed);
    if (!std::isfinite(reflected[c])) reflected[c] = 1;
  }
  set_base(surface, {reflected, "", {}});
}

void Materials::glass(const Parameters& parameters, bool v3, Surface& surface) {
  const Texture through = v3 ? textures_.color(parameters, "Kt", kWhite) : Texture{};
  if (v3) parameters.find("Kr");
  set_base(surface, through);
  surface.material.transmission = largest(through.factor) > 0 ? 1 : 0;
  surface.material.ior = index(refraction(parameters, 1.5));
  surface.material.roughness = unit(roughness(parameters, 0, v3));
}

void Materials::uber(const Parameters& parameters, Surface& surface) {
  set_base(surface, textures_.color(parameters, "Kd", kQuarter));
  surface.material.roughness = unit(roughness(parameters, 0.1, true));
  surface.material.ior = index(refraction(parameters, 1.5));
  const double through = largest(textures_.color(parameters, "Kt", {}).factor);
  const double opacity = mean(textures_.color(parameters, "opacity", kWhite).factor);
  if (largest(textures_.color(parameters, "Ks", kQuarter).factor) == 0) surface.material.roughness = 1;
  if (parameters.find("Kr")) warnings_.add(parameters.place(), "'Kr' of an uber material is left out");
  surface.material.transmission = unit(through);
  if (opacity < 1) {
    surface.material.alpha = unit(opacity);
    surface.material.alpha_mode = Material::AlphaMode::blend;
  }
}

void Materials::mix(const Parameters& parameters, Surface& surface) {
  std::string names[2] = {parameters.string("namedmaterial1", ""), parameters.string("namedmaterial2", "")};
  if (const Parameter* both = parameters.find("materials")) {
    if (both->strings.size() != 2) fail(parameters.place(*both), "a mix needs the names of two materials");
    for (size_t i = 0; i < 2; ++i) names[i] = both->strings[i];
  }
  // v3 has the share of the first, and three of them; v4 the share of the second.
  const bool v4 = parameters.find("materials") != nullptr;
  const double amount = unit(v4 ? textures_.number(parameters, "amount", 0.5)
                                : 1 - mean(textures_.color(parameters, "amount", kHalf).factor));
  warnings_.add(parameters.place(), "a mix of materials becomes one with mixed numbers");
  for (const std::string& name : names)
    if (!named_.count(name) || undefined_.count(name))
      warnings_.add(parameters.place(), "a mix of a material that was not defined before: '" + printable(name) + "'");
  const Surface a = *named(names[0], parameters.place()), b = *named(names[1], parameters.place());
  surface = amount > 0.5 ? b : a;
  const auto weight = static_cast<float>(amount);
  const auto blend = [&](float Material::*part) {
    surface.material.*part = (a.material.*part) * (1 - weight) + (b.material.*part) * weight;
  };
  surface.material.base_color = lerp(a.material.base_color, b.material.base_color, weight);
  for (const auto part : {&Material::metallic, &Material::roughness, &Material::transmission, &Material::ior})
    blend(part);
}

void Materials::read_known(const std::string& kind, const Parameters& parameters, Surface& surface) {
  Material& material = surface.material;
  const bool v3 = is_one_of(kind, std::array{"plastic", "substrate", "metal", "glass", "translucent"});
  if (kind == "matte") {
    parameters.find("sigma");  // Oren and Nayar's roughness: nearly Lambert
    set_base(surface, textures_.color(parameters, "Kd", kHalf));
  } else if (kind == "diffuse" || kind == "diffusetransmission") {
    set_base(surface, textures_.color(parameters, "reflectance", kind == "diffuse" ? kHalf : kQuarter));
  } else if (kind == "translucent") {
    set_base(surface, textures_.color(parameters, "Kd", kQuarter));
  } else if (kind == "plastic" || kind == "substrate") {
    parameters.find("Ks");
    set_base(surface, textures_.color(parameters, "Kd", kind == "plastic" ? kQuarter : kHalf));
    material.roughness = unit(roughness(parameters, 0.1, v3));
  } else if (kind == "coateddiffuse") {
    set_base(surface, textures_.color(parameters, "reflectance", kHalf));
    material.ior = index(refraction(parameters, 1.5));
    material.roughness = unit(roughness(parameters, 0, v3));
  } else if (kind == "mirror") {
    set_base(surface, textures_.color(parameters, "Kr", {0.9, 0.9, 0.9}));
    material.metallic = 1;
    material.roughness = 0;
  } else if (kind == "metal" || kind == "conductor") {
    metal(parameters, surface);
    material.roughness = unit(roughness(parameters, v3 ? 0.01 : 0, v3));
  } else if (kind == "coatedconductor") {
    metal(parameters, surface);
    material.roughness =
        unit(std::sqrt(std::sqrt(std::max(0.0, textures_.number(parameters, "conductor.roughness", 0)))));
  } else if (kind == "glass" || kind == "dielectric" || kind == "thindielectric") {
    glass(parameters, v3, surface);
  } else if (kind == "uber") {
    uber(parameters, surface);
  } else if (kind == "disney") {
    set_base(surface, textures_.color(parameters, "color", kHalf));
    material.metallic = unit(textures_.number(parameters, "metallic", 0));
    material.roughness = unit(textures_.number(parameters, "roughness", 0.5));
    material.transmission = unit(textures_.number(parameters, "spectrans", 0));
    material.ior = index(refraction(parameters, 1.5));
  } else if (kind == "kdsubsurface" || kind == "subsurface") {
    set_base(surface, textures_.color(parameters, parameters.find("Kd") ? "Kd" : "reflectance", kHalf));
  } else if (kind == "hair") {
    set_base(surface, textures_.color(parameters, parameters.find("color") ? "color" : "reflectance", kHalf));
  } else if (kind == "mix") {
    mix(parameters, surface);
  }
}

Surface Materials::make(const std::string& kind, const Parameters& parameters) {
  constexpr std::array kExact{"matte", "diffuse",   "plastic", "substrate",  "coateddiffuse", "mirror",
                              "metal", "conductor", "glass",   "dielectric", "uber",          "disney"};
  constexpr std::array kApproximate{
      "diffusetransmission", "translucent", "coatedconductor", "thindielectric", "kdsubsurface", "subsurface", "hair"};
  Surface surface = none_given();
  for (const char* bump : {"bumpmap", "displacement"})
    if (parameters.find(bump)) warnings_.add(parameters.place(), "bumps (" + std::string(bump) + ") are left out");
  if (kind.empty() || kind == "none" || kind == "interface") {
    surface.invisible = true;
    return surface;
  }
  if (!is_one_of(kind, kExact) && kind != "mix")
    warnings_.add(parameters.place(), is_one_of(kind, kApproximate)
                                          ? "materials of kind '" + kind + "' are taken as plain surfaces"
                                          : "materials of kind '" + printable(kind) + "' become matte grey");
  read_known(kind, parameters, surface);
  if (const std::string normals = parameters.string("normalmap", ""); !normals.empty())
    if (const auto path = find_file(normals, parameters.place(), textures_.spectrum().folder, warnings_, Needed::no))
      surface.material.normal_texture.picture = *path;
  parameters.warn_unused("material '" + printable(kind) + "'", warnings_);
  return surface;
}

std::shared_ptr<const Surface> Materials::read(const std::string& kind, const Parameters& parameters) {
  return std::make_shared<const Surface>(make(kind, parameters));
}

void Materials::define(const std::string& name, const Parameters& parameters) {
  Surface surface = make(parameters.string("type", "matte"), parameters);
  surface.material.name = printable(name);
  if (undefined_.erase(name) > 0)
    *named_[name] = std::move(surface);  // for whoever has asked for it
  else
    named_[name] = std::make_shared<Surface>(std::move(surface));
}

std::shared_ptr<const Surface> Materials::named(const std::string& name, const Place& place) {
  const auto [found, is_new] = named_.try_emplace(name);
  if (is_new) {
    found->second = std::make_shared<Surface>(none_given());
    undefined_[name] = place;
  }
  return found->second;
}

void Materials::finish() {
  for (const auto& [name, place] : undefined_)
    warnings_.add(place, "no material '" + printable(name) + "' is defined: left out");
}

}  // namespace kairos::pbrt
