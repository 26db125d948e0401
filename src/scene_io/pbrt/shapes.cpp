// Which shape a pbrt statement asks for; triangle and PLY meshes.
#include <algorithm>
#include <filesystem>
#include <system_error>

#include "base/file.h"
#include "scene_io/pbrt/geometry.h"
#include "scene_io/pbrt/gzip.h"
#include "scene_io/pbrt/transform.h"
#include "scene_io/ply/ply.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

/// Indices by threes; without any, three points are one triangle.
std::vector<uint32_t> triangle_indices(const Parameters& parameters, size_t points) {
  std::vector<uint32_t> indices = parameters.index_list("indices");
  if (!parameters.find("indices") && points == 3) indices = {0, 1, 2};
  if (indices.empty() || indices.size() % 3 != 0)
    fail(parameters.place(), "a triangle mesh needs 'indices', three for each triangle");
  return indices;
}

std::shared_ptr<const Geometry> read_triangles(const Parameters& parameters, ShapeContext& context) {
  PolygonMesh mesh;
  mesh.path = parameters.place().text();
  mesh.positions = parameters.vec3_list("P");
  if (mesh.positions.empty()) fail(parameters.place(), "a triangle mesh needs points 'P'");
  mesh.corners = triangle_indices(parameters, mesh.positions.size());
  mesh.normals = parameters.vec3_list("N");
  mesh.uvs = parameters.vec2_list(parameters.find("uv") ? "uv" : "st");
  return finish_geometry(std::move(mesh), parameters.place(), context);
}

std::shared_ptr<const Geometry> read_ply(const Parameters& parameters, ShapeContext& context) {
  const std::string name = parameters.string("filename", "");
  if (name.empty()) fail(parameters.place(), "a plymesh needs a 'filename'");
  const auto path = find_file(name, parameters.place(), context.folder, context.warnings);
  if (!path) return nullptr;
  constexpr uint64_t kMaxFileSize = uint64_t{1} << 33;
  context.load.count_file(*path);
  const std::vector<uint8_t> bytes = read_maybe_packed(*path, kMaxFileSize, context.load.budget);
  return finish_geometry(parse_ply({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, *path),
                         parameters.place(), context);
}

std::shared_ptr<const Geometry> read_loop(const Parameters& parameters, ShapeContext& context) {
  const int64_t levels = parameters.integer(parameters.find("nlevels") ? "nlevels" : "levels", 3);
  parameters.find("scheme");  // there is only one
  PolygonMesh mesh;
  mesh.path = parameters.place().text();
  mesh.positions = parameters.vec3_list("P");
  if (mesh.positions.empty()) fail(parameters.place(), "a loopsubdiv needs points 'P'");
  mesh.corners = triangle_indices(parameters, mesh.positions.size());
  MeshData cage = make_mesh_data({std::move(mesh)}, context.load.options.strict);
  for (const std::string& warning : cage.warnings) context.warnings.add_line(warning);
  constexpr uint64_t kBytesPerTriangle = 512;  // of working space, a kilobyte a vertex
  constexpr int64_t kMostDoublings = 31;
  context.load.budget.charge((cage.triangles.size() * kBytesPerTriangle)
                                 << (2 * std::clamp<int64_t>(levels, 0, kMostDoublings / 2)),
                             parameters.place().text());
  return make_geometry(
      subdivide_loop(cage.positions[0], cage.triangles, levels, context.max_triangles, parameters.place()));
}

}  // namespace

std::optional<std::string> find_file(const std::string& name, const Place& place, const SceneFolder& folder,
                                     Warnings& warnings, Needed needed) {
  std::string problem;
  const std::string path = folder.try_resolve(name, problem);
  if (!problem.empty() && needed == Needed::yes) fail(place, problem);
  std::error_code ec;
  if (problem.empty() && std::filesystem::is_regular_file(path, ec)) return path;
  warnings.add(place, problem.empty() ? "the file '" + printable(name, 200) + "' is not there, or no file: left out"
                                      : problem + ": left out");
  return std::nullopt;
}

std::shared_ptr<const Geometry> make_geometry(MeshData data) {
  auto vertices = std::make_shared<Vertices>();
  vertices->positions = std::move(data.positions[0]);
  if (!data.normals.empty()) vertices->normals = std::move(data.normals[0]);
  auto geometry = std::make_shared<Geometry>();
  geometry->triangles = std::move(data.triangles);
  geometry->uvs = std::move(data.uvs);
  geometry->prim_ids = std::move(data.prim_ids);
  geometry->vertices = std::move(vertices);
  return geometry;
}

std::shared_ptr<const Geometry> projected(const Geometry& geometry, const Mat4& matrix, const Place& place) {
  auto vertices = std::make_shared<Vertices>(*geometry.vertices);
  for (Vec3f& p : vertices->positions) {
    p = to_float(project_point(matrix, to_double(p)));
    if (!is_finite(p)) fail(place, "the transform takes a point of the shape to infinity");
  }
  const Mat4 turned = normal_matrix(matrix);
  for (Vec3f& n : vertices->normals) n = to_float(normalize(transform_vector(turned, to_double(n))));
  auto result = std::make_shared<Geometry>(geometry);
  result->vertices = std::move(vertices);
  return result;
}

std::shared_ptr<const Geometry> finish_geometry(PolygonMesh mesh, const Place& place, ShapeContext& context) {
  const auto one_each = [&](size_t count, const char* what) {
    if (count != 0 && count != mesh.positions.size())
      fail(place, std::string("needs one ") + what + " for each point, or none");
  };
  if (mesh.corner_normals.empty()) one_each(mesh.normals.size(), "normal");
  if (mesh.corner_uvs.empty()) one_each(mesh.uvs.size(), "texture coordinate");
  MeshData data = make_mesh_data({std::move(mesh)}, context.load.options.strict);
  for (const std::string& warning : data.warnings) context.warnings.add_line(warning);
  return make_geometry(std::move(data));
}

std::shared_ptr<const Geometry> read_shape(const std::string& kind, const Parameters& parameters,
                                           ShapeContext& context) {
  if (kind == "trianglemesh") return read_triangles(parameters, context);
  if (kind == "plymesh") return read_ply(parameters, context);
  if (kind == "loopsubdiv") return read_loop(parameters, context);
  if (kind == "bilinearmesh") return make_geometry(tessellate_bilinear(parameters, context.max_triangles));
  context.warnings.add(parameters.place(), "shapes of kind '" + printable(kind) + "' are left out");
  return nullptr;
}

}  // namespace kairos::pbrt
