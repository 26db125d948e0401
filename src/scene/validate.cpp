#include <string>

#include <kairos/error.h>
#include <kairos/mesh.h>

namespace kairos {

namespace {
[[noreturn]] void broken(const Mesh& mesh, const std::string& what) {
  throw Error(ErrorCode::bad_input, "mesh '" + mesh.name + "'", what);
}
}  // namespace

void validate_mesh(const Mesh& mesh) {
  const size_t keys = mesh.key_count(), vertices = mesh.vertex_count();
  if (keys == 0 && !mesh.triangles.empty()) broken(mesh, "has triangles but no positions");
  if (keys > 1) {
    if (mesh.key_times.size() != keys)
      broken(mesh, "has " + std::to_string(keys) + " keys but " + std::to_string(mesh.key_times.size()) + " key times");
    if (mesh.key_times.front() != 0 || mesh.key_times.back() != 1) broken(mesh, "key times must run from 0 to 1");
    for (size_t k = 1; k < keys; ++k)
      if (!(mesh.key_times[k - 1] <= mesh.key_times[k])) broken(mesh, "key times must ascend");
  }
  for (const auto& key : mesh.positions) {
    if (key.size() != vertices) broken(mesh, "its keys differ in their number of vertices");
    for (const Vec3f& p : key)
      if (!is_finite(p)) broken(mesh, "a position is not finite");
  }
  if (!mesh.normals.empty()) {
    if (mesh.normals.size() != 1 && mesh.normals.size() != keys)
      broken(mesh, "normals need one key, or as many as positions");
    for (const auto& key : mesh.normals)
      if (key.size() != vertices) broken(mesh, "needs one normal per vertex");
  }
  if (!mesh.uvs.empty() && mesh.uvs.size() != vertices) broken(mesh, "needs one texture coordinate per vertex");
  if (!mesh.prim_ids.empty() && mesh.prim_ids.size() != mesh.triangles.size())
    broken(mesh, "needs one number per triangle");
  for (const Triangle& t : mesh.triangles)
    for (uint32_t v : t)
      if (v >= vertices)
        broken(mesh, "index " + std::to_string(v) + " is beyond its " + std::to_string(vertices) + " vertices");
}

}  // namespace kairos
