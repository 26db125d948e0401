#include "scene_io/pbrt/texture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "scene_io/pbrt/geometry.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {
constexpr Vec3d kGrey{0.5, 0.5, 0.5};  // of what can't be known
constexpr size_t kMostPictures = 64;   // of a megabyte each

/// How an image lies on texture coordinates.
UvMap uv_map(const Parameters& parameters) {
  constexpr double kMost = 1e15;  // far beyond what float tells apart, far below its overflow
  const auto number = [&](const char* name, double otherwise) {
    return std::clamp(parameters.number(name, otherwise), -kMost, kMost);
  };
  UvMap map;
  map.scale = {number("uscale", 1), number("vscale", 1)};
  map.offset = {number("udelta", 0), number("vdelta", 0)};
  return map;
}

}  // namespace

double mean(Vec3d color) { return (color.x + color.y + color.z) / 3; }

TextureRef Texture::reference() const {
  TextureRef ref;
  ref.picture = image;
  ref.wrap = {map.wrap, map.wrap};
  const Vec3d u{map.scale.x, 0, map.offset.x}, v{0, map.scale.y, 1 - map.scale.y - map.offset.y};
  if (!image.empty()) ref.placement = {to_float(u), to_float(v)};
  return ref;
}

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
  if (kind == "checkerboard") return checkerboard(parameters);
  spectrum_.warnings.add(parameters.place(), "textures of kind '" + printable(kind) + "' become one colour");
  if (kind == "dots") {
    const Vec3d a = color(parameters, "inside", kWhite).factor, b = color(parameters, "outside", {}).factor;
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

namespace {

/// Two by two squares, the lower left one and the upper right one of the first colour.
Pixels draw_checkerboard(Vec3d first, Vec3d second) {
  constexpr int kSide = 128;  // pixels of a square, whose edges a look-up blurs by one
  Pixels pixels{2 * kSide, 2 * kSide, {}, {}};
  for (int y = 0; y < pixels.height; ++y)
    for (int x = 0; x < pixels.width; ++x) {
      const Vec3d& color = (x < kSide) == (y < kSide) ? second : first;
      for (const double part : {color.x, color.y, color.z, 1.0}) pixels.values.push_back(static_cast<float>(part));
    }
  return pixels;
}

}  // namespace

Texture Textures::checkerboard(const Parameters& parameters) {
  const Texture a = color(parameters, "tex1", kWhite), b = color(parameters, "tex2", {});
  parameters.find("aamode");  // how pbrt-v3 filters it
  const bool is_flat = parameters.integer("dimension", 2) == 2;
  const double most = std::max({a.factor.x, a.factor.y, a.factor.z, b.factor.x, b.factor.y, b.factor.z});
  if (!is_flat || !a.image.empty() || !b.image.empty() || !(most > 0) || !std::isfinite(most)) {
    if (most != 0 || !is_flat)
      spectrum_.warnings.add(parameters.place(), "a checkerboard of images, or in space, becomes one colour");
    return {(a.factor + b.factor) * 0.5, "", {}};
  }
  Texture texture;
  texture.factor = kWhite * most;
  const Vec3d first = a.factor / most, second = b.factor / most;
  texture.image_mean = (mean(first) + mean(second)) / 2;
  texture.image =
      fmt::format("checkerboard ({} {} {}) ({} {} {})", first.x, first.y, first.z, second.x, second.y, second.z);
  if (!pictures_.count(texture.image)) pictures_[texture.image] = draw_checkerboard(first, second);
  if (pictures_.size() > kMostPictures) fail(parameters.place(), "the scene has too many checkerboards");
  texture.map = uv_map(parameters);
  // The picture is two squares wide and high.
  texture.map.scale = {texture.map.scale.x / 2, texture.map.scale.y / 2};
  texture.map.offset = {texture.map.offset.x / 2, texture.map.offset.y / 2};
  check_mapping(parameters);
  return texture;
}

Texture Textures::image(const Parameters& parameters) {
  Texture texture;
  // How the image is filtered is the renderer's business.
  for (const char* passed_over : {"trilinear", "maxanisotropy", "filter"}) parameters.find(passed_over);
  const Parameter* gamma = parameters.find("gamma");
  if (parameters.string("encoding", "sRGB") != "sRGB" || (gamma && gamma->strings != std::vector<std::string>{"true"}))
    spectrum_.warnings.add(parameters.place(),
                           "the encoding of an image is left out: it is taken as usual for its format");
  texture.factor = kWhite * std::max(0.0, parameters.number("scale", 1));
  texture.map = uv_map(parameters);
  check_mapping(parameters);
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
    texture.is_absent = true;
  if (texture.is_absent) texture.factor = texture.factor * 0.5;
  return texture;
}

void Textures::check_mapping(const Parameters& parameters) {
  const std::string mapping = parameters.string("mapping", "uv");
  if (mapping != "uv")
    spectrum_.warnings.add(parameters.place(), "texture mapping '" + printable(mapping) + "' is taken as 'uv'");
}

Texture Textures::scale(const Parameters& parameters) {
  const bool v4 = parameters.find("tex") || parameters.find("scale");
  Texture a = color(parameters, v4 ? "tex" : "tex1", kWhite);
  const Texture b = color(parameters, v4 ? "scale" : "tex2", kWhite);
  if (!a.image.empty() && !b.image.empty())
    spectrum_.warnings.add(parameters.place(), "of a product of two images one is left out");
  constexpr double kMost = 1e30;  // so that no product of products overflows
  for (int axis = 0; axis < 3; ++axis) a.factor[axis] = std::min(a.factor[axis] * b.factor[axis], kMost);
  a.is_absent = a.is_absent || b.is_absent;
  if (a.image.empty()) {
    a.image = b.image;
    a.map = b.map;
    a.image_mean = b.image_mean;
  }
  return a;
}

Texture Textures::mix(const Parameters& parameters) {
  const double amount = std::clamp(number(parameters, "amount", 0.5), 0.0, 1.0);
  Texture a = color(parameters, "tex1", {}), b = color(parameters, "tex2", kWhite);
  if (amount == 0) return a;
  if (amount == 1) return b;
  if (a.image.empty() && b.image.empty())
    return {lerp(a.factor, b.factor, amount), "", {}, 0.5, a.is_absent || b.is_absent};
  if (a.image == b.image && a.map == b.map) return {lerp(a.factor, b.factor, amount), a.image, a.map, a.image_mean};
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
      return mean(texture->second.factor) * (texture->second.image.empty() ? 1 : texture->second.image_mean);
    }
  spectrum_.warnings.add(parameters.place(*found), "a texture that was not defined before is left out");
  return otherwise;
}

}  // namespace kairos::pbrt
