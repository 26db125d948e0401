#include "scene_io/split_by_material.h"

#include <algorithm>
#include <utility>

namespace kairos {

namespace {

template <class T>
std::vector<T> pick(const std::vector<T>& values, const std::vector<uint32_t>& indices) {
  std::vector<T> picked;
  if (values.empty()) return picked;
  picked.reserve(indices.size());
  for (const uint32_t index : indices) picked.push_back(values[index]);
  return picked;
}

}  // namespace

std::vector<MaterialPart> split_by_material(MeshData mesh) {
  std::vector<MaterialPart> parts;
  const std::vector<uint32_t> materials = std::move(mesh.triangle_materials);
  const bool is_one = std::adjacent_find(materials.begin(), materials.end(), std::not_equal_to<>()) == materials.end();
  if (is_one) {
    const uint32_t material = materials.empty() ? 0 : materials.front();
    parts.push_back({material, std::move(mesh)});
    return parts;
  }

  std::vector<std::vector<uint32_t>> triangles_of(*std::max_element(materials.begin(), materials.end()) + size_t{1});
  for (size_t t = 0; t < materials.size(); ++t) triangles_of[materials[t]].push_back(static_cast<uint32_t>(t));
  const size_t vertex_count = mesh.positions.empty() ? 0 : mesh.positions.front().size();
  std::vector<uint32_t> place(vertex_count, kNoIndex);  // in the part that is made
  for (uint32_t material = 0; material < triangles_of.size(); ++material) {
    const std::vector<uint32_t>& triangles = triangles_of[material];
    if (triangles.empty()) continue;
    MaterialPart part{material, {}};
    std::vector<uint32_t> used;  // vertices of the whole mesh
    for (const uint32_t t : triangles) {
      Triangle triangle = mesh.triangles[t];
      for (uint32_t& vertex : triangle) {
        if (place[vertex] == kNoIndex) {
          place[vertex] = static_cast<uint32_t>(used.size());
          used.push_back(vertex);
        }
        vertex = place[vertex];
      }
      part.data.triangles.push_back(triangle);
      part.data.prim_ids.push_back(mesh.prim_ids.empty() ? t : mesh.prim_ids[t]);
    }
    for (const uint32_t vertex : used) place[vertex] = kNoIndex;
    for (const auto& key : mesh.positions) part.data.positions.push_back(pick(key, used));
    for (const auto& key : mesh.normals) part.data.normals.push_back(pick(key, used));
    part.data.uvs = pick(mesh.uvs, used);
    part.data.colors = pick(mesh.colors, used);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace kairos
