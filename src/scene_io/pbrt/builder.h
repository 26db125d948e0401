// A Scene put together from the statements of a pbrt file, with the attributes that hold while each is read.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "scene_io/pbrt/camera.h"
#include "scene_io/pbrt/geometry.h"
#include "scene_io/pbrt/light.h"
#include "scene_io/pbrt/material.h"

namespace kairos::pbrt {

class Builder {
 public:
  /// max_triangles: of the whole scene, all instances counted.
  Builder(SceneFolder folder, LoadContext& load, uint64_t max_triangles);

  // Statements, in the order of a file.
  void camera(const std::string& kind, const Parameters& parameters);
  void film(const Parameters& parameters) { image_size_ = read_film(parameters, warnings); }
  void transform_times(double start, double end, const Place& place);
  void world_begin();
  /// what: "Attribute", "Transform" or "Object"; an end must meet the begin of its own kind. Throws Error(bad_input).
  void begin(const std::string& what, const Place& place);
  void end(const std::string& what, const Place& place);
  void object_begin(const std::string& name, const Place& place);
  void object_end(const Place& place);
  void object_instance(const std::string& name, const Place& place);
  void material(const std::string& kind, const Parameters& parameters) {
    now_.surface = materials.read(kind, parameters);
  }
  void named_material(const std::string& name, const Place& place) { now_.surface = materials.named(name, place); }
  void area_light(const std::string& kind, const Parameters& parameters);
  void light(const std::string& kind, const Parameters& parameters);
  void reverse_orientation() { now_.reversed = !now_.reversed; }
  void shape(const std::string& kind, const Parameters& parameters);
  /// pbrt-v4's Attribute: parameters that statements of a kind ("shape", "light", ...) have unless they say otherwise.
  void defaults(const std::string& target, Parameters parameters);
  void add_defaults(const std::string& target, Parameters& parameters) const;

  /// Closes what is open and makes the scene. Nothing may follow.
  Scene finish();

  Warnings warnings;
  CurrentTransform transform;
  Textures textures;
  Materials materials;

 private:
  using Defaults = std::map<std::string, std::vector<Parameter>>;
  struct Attributes {
    std::shared_ptr<const Surface> surface;
    std::optional<Vec3f> emission;
    bool reversed = false;
    std::shared_ptr<const Defaults> defaults;
  };
  struct Saved {
    std::string what;
    Place place;
    Attributes attributes;
    TransformPair pair;
    std::array<bool, 2> active;
  };
  struct Use {  ///< of a shape, placed
    std::string name;
    std::shared_ptr<const Geometry> geometry;
    TransformPath path;
    UvMap map;
    uint32_t material;
    bool reversed;
  };
  struct Alpha {
    std::string image;
    double value = 1;
    UvMap map;
  };
  using MaterialKey =
      std::tuple<std::shared_ptr<const Surface>, std::array<float, 3>, bool, std::string, double, TextureWrap>;

  std::shared_ptr<const Geometry> read_geometry(const std::string& kind, const Parameters& parameters);
  void add_use(Use use, const Place& place);
  uint32_t material_index(const Alpha& alpha);
  SceneMesh make_mesh(const Use& use, const TransformPath& outside) const;

  SceneFolder folder_;
  LoadContext& load_;
  uint64_t triangles_left_, uses_left_;
  Attributes now_;
  std::vector<Saved> saved_;
  std::array<double, 2> times_{0, 1};
  std::optional<Camera> camera_;
  std::optional<std::array<int, 2>> image_size_;
  std::map<std::string, std::vector<Use>> objects_;
  std::optional<std::string> object_;  ///< being defined
  std::vector<Use> uses_;
  std::map<std::string, std::shared_ptr<const Geometry>> ply_files_;
  std::map<MaterialKey, uint32_t> material_indices_;
  Scene scene_;
};

}  // namespace kairos::pbrt
