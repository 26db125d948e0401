#include "report.h"

#include <set>

#include <fmt/format.h>
#include <sys/resource.h>

namespace kairos::cli {

uint64_t triangle_count(const std::vector<Mesh>& meshes) {
  uint64_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangle_count();
  return count;
}

uint64_t mesh_bytes(const Mesh& mesh) {
  uint64_t bytes = mesh.triangles.size() * sizeof(Triangle) + mesh.key_times.size() * sizeof(float) +
                   mesh.uvs.size() * sizeof(Vec2f) + mesh.colors.size() * sizeof(Vec4f) +
                   mesh.prim_ids.size() * sizeof(uint32_t) + mesh.placements.size() * sizeof(AffineMap) +
                   mesh.directions.size() * sizeof(DirectionMap);
  for (const auto& key : mesh.positions) bytes += key.size() * sizeof(Vec3f);
  for (const auto& key : mesh.normals) bytes += key.size() * sizeof(Vec3f);
  for (const auto& key : mesh.tangents) bytes += key.size() * sizeof(Vec4f);
  for (const auto& set : mesh.more_uvs) bytes += set.size() * sizeof(Vec2f);
  return bytes;
}

uint64_t mesh_bytes(const std::vector<Mesh>& meshes) {
  uint64_t bytes = 0;
  std::set<const Mesh*> objects;
  for (const Mesh& mesh : meshes) {
    bytes += mesh_bytes(mesh);
    if (mesh.object && objects.insert(mesh.object.get()).second) bytes += mesh_bytes(*mesh.object);
  }
  return bytes;
}

uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

std::string amount(size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string megabytes(uint64_t bytes) { return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6); }

}  // namespace kairos::cli
