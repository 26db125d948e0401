// Materials of pbrt scene files as ours.
#pragma once

#include <map>
#include <memory>
#include <string>

#include <kairos/scene.h>

#include "scene_io/pbrt/texture.h"

namespace kairos::pbrt {

struct Surface {
  Material material;
  bool invisible = false;  ///< pbrt's "interface" (or "none", or ""): light passes as if nothing were there
};

class Materials {
 public:
  explicit Materials(Textures& textures, Warnings& warnings) : textures_(textures), warnings_(warnings) {}

  /// What a shape has before any material is given.
  static Surface none_given();

  /// A Material statement's surface. An unknown kind becomes matte, with a warning.
  std::shared_ptr<const Surface> read(const std::string& kind, const Parameters& parameters);

  /// MakeNamedMaterial and NamedMaterial. What has no definition yet may get one, as in pbrt-v4, and is none_given()
  /// until then.
  void define(const std::string& name, const Parameters& parameters);
  std::shared_ptr<const Surface> named(const std::string& name, const Place& place);
  /// Warns of names that never got a definition.
  void finish();

 private:
  Surface make(const std::string& kind, const Parameters& parameters);
  void read_known(const std::string& kind, const Parameters& parameters, Surface& surface);
  void set_base(Surface& surface, const Texture& texture);
  void metal(const Parameters& parameters, Surface& surface);
  void glass(const Parameters& parameters, bool v3, Surface& surface);
  void uber(const Parameters& parameters, Surface& surface);
  void mix(const Parameters& parameters, Surface& surface);
  double roughness(const Parameters& parameters, double otherwise, bool v3);
  double refraction(const Parameters& parameters, double otherwise);

  Textures& textures_;
  Warnings& warnings_;
  std::map<std::string, std::shared_ptr<Surface>> named_;
  std::map<std::string, Place> undefined_;  ///< where those among them were asked for
};

}  // namespace kairos::pbrt
