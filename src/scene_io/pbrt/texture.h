// Textures of pbrt scene files: a factor, and perhaps an image that it multiplies.
#pragma once

#include <map>
#include <string>

#include <kairos/image.h>
#include <kairos/scene.h>

#include "scene_io/pbrt/spectrum.h"

namespace kairos::pbrt {

/// Where on an image a shape's texture coordinates lie: coordinate * scale + offset; and what lies beyond it.
struct UvMap {
  Vec2d scale{1, 1}, offset{0, 0};
  TextureWrap wrap = TextureWrap::repeat;
  friend bool operator==(const UvMap&, const UvMap&) = default;
};

struct Texture {
  Vec3d factor{1, 1, 1};
  std::string image;  ///< path; empty: the factor is all there is
  UvMap map;
  double image_mean = 0.5;  ///< as far as it is known
  bool is_absent = false;   ///< its image cannot be found: the factor stands for it

  /// Its image, where our texture coordinates, which count from an image's upper edge, lie on it.
  TextureRef reference() const;
};

class Textures {
 public:
  Textures(SceneFolder folder, Warnings& warnings) : spectrum_{std::move(folder), warnings} {}

  /// Adds what a Texture statement defines. type: "float" or "spectrum"; kind: "imagemap" and so on.
  void define(const std::string& name, const std::string& type, const std::string& kind, const Parameters& parameters);

  /// A parameter that is a colour, a number, or the name of a texture.
  Texture color(const Parameters& parameters, const char* name, Vec3d otherwise);
  /// Its number, or the mean of its texture's factor; an image in it is left out, with a warning.
  double number(const Parameters& parameters, const char* name, double otherwise);

  SpectrumContext& spectrum() { return spectrum_; }

  /// What was drawn for textures that are computed, by the name under which they call it.
  std::map<std::string, Pixels> take_pictures() { return std::move(pictures_); }

 private:
  Texture evaluate(const std::string& kind, const Parameters& parameters);
  Texture image(const Parameters& parameters);
  Texture mix(const Parameters& parameters);
  Texture scale(const Parameters& parameters);
  void check_mapping(const Parameters& parameters);
  Texture checkerboard(const Parameters& parameters);

  SpectrumContext spectrum_;
  std::map<std::string, Texture> floats_, spectra_;
  std::map<std::string, Pixels> pictures_;
};

double mean(Vec3d color);

}  // namespace kairos::pbrt
