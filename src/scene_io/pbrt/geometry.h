// The shapes of pbrt scene files as triangles, in their own space.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "scene_io/load.h"
#include "scene_io/pbrt/motion.h"
#include "scene_io/pbrt/parameters.h"

namespace kairos::pbrt {

/// Triangles in a shape's own space; shared by its instances. Texture coordinates as pbrt has them, (0, 0) at the lower
/// left of a picture.
struct Geometry {
  std::vector<Triangle> triangles;
  std::vector<Vec2f> uvs;          ///< empty, or one per vertex
  std::vector<uint32_t> prim_ids;  ///< empty, or one per triangle: see Mesh::prim_ids
  std::shared_ptr<const Vertices> vertices;
  bool is_one_shape = false;  ///< to pbrt: a sphere, not a mesh, each triangle of which is a shape
};

/// What reading a shape needs to know of its surroundings.
struct ShapeContext {
  SceneFolder folder;  ///< files are found from here, and may not lie outside
  LoadContext& load;
  Warnings& warnings;
  uint64_t max_triangles;  ///< of one shape
};

/// Reads a shape that is neither a quadric nor a curve. nullptr, with a warning, for one that is not known or whose
/// file is not there. Throws Error(bad_input) for parameters that make no sense.
std::shared_ptr<const Geometry> read_shape(const std::string& kind, const Parameters& parameters,
                                           ShapeContext& context);

/// Polygons, checked and cut into triangles.
std::shared_ptr<const Geometry> finish_geometry(PolygonMesh mesh, const Place& place, ShapeContext& context);
std::shared_ptr<const Geometry> make_geometry(MeshData data);

/// Can one do without a file that lies where the scene may not read? A picture is only left out.
enum class Needed { yes, no };
/// A file that the scene names; nothing, with a warning, where it is not there, or is a picture that may not be read.
/// Throws Error(bad_input) for others that may not.
std::optional<std::string> find_file(const std::string& name, const Place& place, const SceneFolder& folder,
                                     Warnings& warnings, Needed needed = Needed::yes);

/// The geometry as a matrix that projects makes it. Throws Error(bad_input) where a point goes to infinity.
std::shared_ptr<const Geometry> projected(const Geometry& geometry, const Mat4& matrix, const Place& place);

/// The triangles of bilinear patches, whose parameters are checked here.
MeshData tessellate_bilinear(const Parameters& parameters, uint64_t max_triangles);

/// Loop's subdivision of a mesh, its vertices moved to where endless subdivision would bring them, with normals.
/// Throws Error(bad_input) with `place` where the result would be larger than `max_triangles`.
MeshData subdivide_loop(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles, int64_t levels,
                        uint64_t max_triangles, const Place& place);

}  // namespace kairos::pbrt
