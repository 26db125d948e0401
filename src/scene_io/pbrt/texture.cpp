#include "scene_io/pbrt/texture.h"

#include <algorithm>
#include <cmath>

#include "scene_io/pbrt/geometry.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {
constexpr Vec3d kGrey{0.5, 0.5, 0.5};  // of what can't be known
constexpr Vec3d kWhite{1, 1, 1};
}  // namespace

double mean(Vec3d color) { return (color.x + color.y + color.z) / 3; }

void Textures::define(const std::string& name, const std::string& type, const std::string& kind,
                      const Parameters& parameters) {
  (type == "float" ? floats_ : spectra_)[name] = evaluate(kind, parameters);
  parameters.warn_unused("texture '" + printable(kind) + "'", spectrum_.warnings);
}

Texture Textures::evaluate(const std::string& kind, const Parameters& parameters) {
  if (kind == "constant") return color(parameters, "value", kWhite);
  if (kind == "imagemap") return image(parameters);
  if (kind == "scale") return scale(parameters);
  if (kind == "mix" || kind == "directionmix") return mix(parameters);
  spectrum_.warnings.add(parameters.place(), "textures of kind '" + printable(kind) + "' become one colour");
  if (kind == "checkerboard" || kind == "dots") {
    const bool dots = kind == "dots";
    const Vec3d a = color(parameters, dots ? "inside" : "tex1", kWhite).factor;
    const Vec3d b = color(parameters, dots ? "outside" : "tex2", {}).factor;
    return {(a + b) * 0.5, "", {}};
  }
  if (kind == "bilerp") {
    Vec3d sum{};
    for (const char* corner : {"v00", "v10"}) sum += color(parameters, corner, {}).factor;
    for (const char* corner : {"v01", "v11"}) sum += color(parameters, corner, kWhite).factor;
    return {sum * 0.25, "", {}};
  }
  return {kGrey, "", {}};
}

Texture Textures::image(const Parameters& parameters) {
  Texture texture;
  // How the image is filtered is the renderer's business, and what its numbers mean its file's.
  for (const char* passed_over : {"trilinear", "maxanisotropy", "filter", "gamma", "encoding"})
    parameters.find(passed_over);
  texture.factor = kWhite * std::max(0.0, parameters.number("scale", 1));
  texture.map.scale = {parameters.number("uscale", 1), parameters.number("vscale", 1)};
  texture.map.offset = {parameters.number("udelta", 0), parameters.number("vdelta", 0)};
  const std::string mapping = parameters.string("mapping", "uv");
  if (mapping != "uv")
    spectrum_.warnings.add(parameters.place(), "texture mapping '" + printable(mapping) + "' is taken as 'uv'");
  const std::string wrap = parameters.string("wrap", "repeat");
  if (wrap == "clamp")
    texture.map.wrap = TextureWrap::clamp;
  else if (wrap != "repeat")
    spectrum_.warnings.add(parameters.place(), "the wrap '" + printable(wrap) + "' of an image is taken as 'repeat'");
  const std::string name = parameters.string("filename", "");
  if (name.empty()) fail(parameters.place(), "an imagemap needs a 'filename'");
  if (const auto path = find_file(name, parameters.place(), spectrum_.folder, spectrum_.warnings, Needed::no))
    texture.image = *path;
  else
    texture.factor = texture.factor * 0.5;
  return texture;
}

Texture Textures::scale(const Parameters& parameters) {
  const bool v4 = parameters.find("tex") || parameters.find("scale");
  Texture a = color(parameters, v4 ? "tex" : "tex1", kWhite);
  const Texture b = color(parameters, v4 ? "scale" : "tex2", kWhite);
  if (!a.image.empty() && !b.image.empty())
    spectrum_.warnings.add(parameters.place(), "of a product of two images one is left out");
  constexpr double kMost = 1e30;  // so that no product of products overflows
  for (int axis = 0; axis < 3; ++axis) a.factor[axis] = std::min(a.factor[axis] * b.factor[axis], kMost);
  if (a.image.empty()) {
    a.image = b.image;
    a.map = b.map;
  }
  return a;
}

Texture Textures::mix(const Parameters& parameters) {
  const double amount = std::clamp(number(parameters, "amount", 0.5), 0.0, 1.0);
  Texture a = color(parameters, "tex1", {}), b = color(parameters, "tex2", kWhite);
  if (amount == 0) return a;
  if (amount == 1) return b;
  if (a.image.empty() && b.image.empty()) return {lerp(a.factor, b.factor, amount), "", {}};
  if (a.image == b.image && a.map == b.map) return {lerp(a.factor, b.factor, amount), a.image, a.map};
  spectrum_.warnings.add(parameters.place(), "of a mix of images only the stronger part is kept");
  return amount > 0.5 ? b : a;
}

Texture Textures::color(const Parameters& parameters, const char* name, Vec3d otherwise) {
  const Parameter* found = parameters.find(name);
  if (!found || found->type != "texture") return {spectrum_color(parameters, name, otherwise, spectrum_), "", {}};
  if (found->strings.size() != 1) fail(parameters.place(*found), "a texture parameter needs the name of a texture");
  for (const auto* textures : {&spectra_, &floats_})
    if (const auto texture = textures->find(found->strings[0]); texture != textures->end()) return texture->second;
  spectrum_.warnings.add(parameters.place(*found),
                         "no texture '" + printable(found->strings[0]) + "' was defined before: left out");
  return {otherwise, "", {}};
}

double Textures::number(const Parameters& parameters, const char* name, double otherwise) {
  const Parameter* found = parameters.find(name);
  if (!found || found->type != "texture") return parameters.number(name, otherwise);
  if (found->strings.size() == 1)
    if (const auto texture = floats_.find(found->strings[0]); texture != floats_.end()) {
      if (!texture->second.image.empty())
        spectrum_.warnings.add(parameters.place(*found),
                               "an image that gives '" + printable(name) + "' is taken as one number");
      return mean(texture->second.factor) * (texture->second.image.empty() ? 1 : 0.5);
    }
  spectrum_.warnings.add(parameters.place(*found), "a texture that was not defined before is left out");
  return otherwise;
}

}  // namespace kairos::pbrt
