// A Scene put together from the statements of a pbrt file, with the attributes that hold while each is read.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scene_io/pbrt/camera.h"
#include "scene_io/pbrt/curve.h"
#include "scene_io/pbrt/geometry.h"
#include "scene_io/pbrt/light.h"
#include "scene_io/pbrt/look.h"
#include "scene_io/pbrt/quadric_meshes.h"
#include "scene_io/turned_triangles.h"

namespace kairos::pbrt {

class Builder {
 public:
  /// max_triangles: of the whole scene, all instances counted.
  Builder(SceneFolder folder, LoadContext& load, uint64_t max_triangles);

  // Statements, in the order of a file.
  void camera(const std::string& kind, const Parameters& parameters);
  void film(const std::string& kind, const Parameters& parameters) { film_ = read_film(kind, parameters, warnings); }
  void transform_times(double start, double end, const Place& place);
  void world_begin();
  /// what: "Attribute", "Transform" or "Object". As in pbrt-v3 any end closes what was begun last, with a warning where
  /// that was of another kind. Throws Error(bad_input) where nothing is open.
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
    std::shared_ptr<const AreaLight> light;  ///< null for none
    bool reversed = false;
    std::shared_ptr<const Defaults> defaults;
  };
  struct SavedTransform {
    std::string what;
    Place place;
    TransformPair pair;
    std::array<bool, 2> active;
  };
  struct Use {  ///< of a shape, placed
    std::string name;
    std::shared_ptr<const Geometry> geometry;  ///< null for a quadric
    std::shared_ptr<const Quadric> quadric;    ///< whose triangles depend on its size in the picture
    TransformPath path;
    std::shared_ptr<const Look> look;
    bool reversed;
  };

  /// Curves that follow each other and differ in nothing else become one mesh: hair has a statement for each strand.
  struct Strands {
    std::shared_ptr<Geometry> geometry;
    std::shared_ptr<Vertices> vertices;
    std::shared_ptr<const Look> look;
    TransformPair pair;
    std::array<double, 2> times;
    bool reversed = false;
  };

  std::shared_ptr<const Geometry> read_geometry(const std::string& kind, const Parameters& parameters);
  Alpha read_alpha(const Parameters& parameters);
  void add_use(Use use, const Place& place);
  void take_triangles(uint64_t count, const Place& place);
  void charge_surface(const std::shared_ptr<const Geometry>& geometry, const Place& place);
  void add_curve_shape(const Parameters& parameters, const Alpha& alpha);
  void add_mesh(const Use& use, const TransformPath& outside, SceneLooks& looks, QuadricMeshes& quadrics);
  /// What all meshes that are made of a geometry have in common.
  const SceneMesh& surface_of(const std::shared_ptr<const Geometry>& geometry);
  void expose(const Camera& camera);

  SceneFolder folder_;
  LoadContext& load_;
  uint64_t triangles_left_, uses_left_;
  Attributes now_;
  // pbrt-v3 keeps two stacks, of which TransformBegin only uses the one.
  std::vector<SavedTransform> saved_transforms_;
  std::vector<Attributes> saved_attributes_;
  std::array<double, 2> times_{0, 1};
  std::map<size_t, TransformPath> light_paths_;  ///< of lights that move, by their places in the scene's
  std::optional<Camera> camera_;
  std::optional<Film> film_;
  std::map<std::string, std::vector<Use>> objects_;
  std::optional<std::string> object_;  ///< being defined
  std::vector<Use> uses_;
  std::map<std::string, std::shared_ptr<const Geometry>> ply_files_;
  std::optional<Screen> screen_;    ///< once the world has begun, where there is a camera
  std::optional<Strands> strands_;  ///< the last statement, where it was a curve
  std::map<std::shared_ptr<const Geometry>, SceneMesh> surfaces_;
  std::set<std::shared_ptr<const Geometry>> charged_;
  TurnedTriangles turned_;
  Scene scene_;
};

}  // namespace kairos::pbrt
