// Scenes from memory: what a program has rather than a file.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/image.h>
#include <kairos/mesh.h>
#include <kairos/scene.h>

namespace kairos {

/// Vertices at one or more keys. Between neighbouring keys they move on straight lines, before the first and after the
/// last they rest.
struct MeshDescription {
  std::string name;
  std::vector<Triangle> triangles;            ///< indices of vertices, counter-clockwise seen from the front
  std::vector<double> times;                  ///< [key] scene time, ascending; of a single key it may be left out
  std::vector<std::vector<Vec3f>> positions;  ///< [key][vertex], finite, in metres
  std::vector<std::vector<Vec3f>> normals;    ///< empty, or [key][vertex]: of any length but zero
  std::vector<Vec2f> uvs;                     ///< empty, or [vertex]; (0, 0) is a picture's upper left corner
  std::vector<std::vector<Vec2f>> more_uvs;   ///< sets 1, 2, ... of the same kind, each empty or [vertex]
  std::vector<Vec4f> colors;                  ///< empty, or [vertex]: linear red, green, blue and alpha, finite, from 0
  uint32_t material = 0;                      ///< index into SceneDescription::materials
};

struct PlacementKey {
  double time = 0;                                                          ///< scene time
  Matrix matrix{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};  ///< world from mesh; last row 0 0 0 1
};

/// A mesh, put somewhere. Many of them share its vertices, until a shot places them.
struct InstanceDescription {
  uint32_t mesh = 0;                 ///< index into SceneDescription::meshes
  std::string name;                  ///< empty: the mesh's
  std::optional<uint32_t> material;  ///< unset: the mesh's
  /// In ascending time; none: where the mesh is. Each entry of the matrix goes linearly from key to key: what turns
  /// needs several, of which each turns a little. A matrix that mirrors does not turn the mesh inside out.
  std::vector<PlacementKey> placement;
};

/// From where a camera looks where. The three points and directions go linearly from key to key.
struct CameraKey {
  double time = 0;  ///< scene time
  Vec3d eye{0, 0, 0}, target{0, 0, -1}, up{0, 1, 0};
};
/// The key of a camera with this placement: world from camera, which looks along -z. What scales or shears in it goes.
inline CameraKey camera_key(double time, const Matrix& world_from_camera) {
  const auto& m = world_from_camera;
  const Vec3d eye{m[3][0], m[3][1], m[3][2]}, backwards{m[2][0], m[2][1], m[2][2]};
  return {time, eye, eye - backwards, {m[1][0], m[1][1], m[1][2]}};
}

struct CameraDescription : Lens {
  std::string name = "camera";
  std::vector<CameraKey> keys;  ///< in ascending time, at least one
};

/// A scene over all of its time. World units are metres, right-handed, y up.
struct SceneDescription {
  std::vector<MeshDescription> meshes;
  std::vector<InstanceDescription> instances;  ///< none: every mesh stands once, where it is
  std::vector<Material> materials;             ///< none: a grey one
  /// By the names under which materials and environments call them; a name that is not among these is a file's.
  std::map<std::string, Pixels> pictures;
  std::vector<CameraDescription> cameras;  ///< none: one that frames everything
  std::vector<Light> lights;               ///< directions of any length but zero
  Vec3f background{0, 0, 0};
  std::array<double, 2> shutter{0, 1};      ///< open, close in scene time, where ShotOptions name no frame
  std::array<int, 2> image_size{960, 540};  ///< width, height, where ShotOptions name none
  double fps = 24;                          ///< frames per unit of scene time, where ShotOptions name a frame
};

/// What load_scene would make of a file that says the same: the same shots, bit for bit. Throws Error(bad_input) that
/// names what cannot be used, and where.
KAIROS_API std::shared_ptr<const Scene> make_scene(SceneDescription description);

}  // namespace kairos
