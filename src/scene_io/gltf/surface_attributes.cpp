#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "scene_io/gltf/attributes.h"
#include "scene_io/tangents.h"

namespace kairos::gltf {

namespace {

std::vector<Vec2f> read_uv_set(AttributeReader& attributes, uint32_t set) {
  const std::string name = fmt::format("TEXCOORD_{}", set);
  if (!attributes.has(name)) return {};
  const std::vector<float> flat = attributes.floats(name, 2);
  std::vector<Vec2f> uvs(flat.size() / 2);
  for (size_t i = 0; i < uvs.size(); ++i) uvs[i] = {flat[2 * i], flat[2 * i + 1]};
  return uvs;
}

void read_uvs(AttributeReader& attributes, const Material& material, Primitive& primitive) {
  primitive.uvs = read_uv_set(attributes, 0);
  for (const TextureRef* texture : {&material.base_color_texture, &material.emission_texture,
                                    &material.metallic_roughness_texture, &material.normal_texture}) {
    const uint32_t set = texture->uv_set;
    if (texture->empty() || set == 0) continue;
    if (primitive.more_uvs.size() < set) primitive.more_uvs.resize(set);
    if (primitive.more_uvs[set - 1].empty()) primitive.more_uvs[set - 1] = read_uv_set(attributes, set);
  }
}

/// glTF wants tangents with normals; what has no length is left to how the picture lies.
void read_tangents(AttributeReader& attributes, const std::string& where, const Material& material,
                   Primitive& primitive, Warnings& warnings) {
  if (material.normal_texture.empty() || primitive.normals.empty() || !attributes.has("TANGENT")) return;
  const std::vector<float> flat = attributes.floats("TANGENT", 4);
  std::vector<Vec4f> tangents(flat.size() / 4);
  for (size_t i = 0; i < tangents.size(); ++i) {
    const Vec3f along = normalize(Vec3f{flat[4 * i], flat[4 * i + 1], flat[4 * i + 2]});
    if (along == Vec3f{}) return warnings.add(where, "tangents are left out: some are zero or not finite");
    tangents[i] = {along.x, along.y, along.z, flat[4 * i + 3] < 0 ? -1.0f : 1.0f};
  }
  primitive.tangents = std::move(tangents);
}

void read_colors(AttributeReader& attributes, const std::string& where, Primitive& primitive, Warnings& warnings) {
  if (!attributes.has("COLOR_0")) return;
  const file::Accessor& accessor = attributes.accessor("COLOR_0");
  const size_t components = accessor.components == 3 ? 3 : 4;
  const std::vector<float> flat = attributes.floats("COLOR_0", static_cast<int>(components));
  float scale = 1;
  if (!accessor.normalized && accessor.componentType != file::kFloat) {
    warnings.add(where, "vertex colours in whole numbers count as normalized, though the file does not say so");
    scale = accessor.componentType == file::kUnsignedByte ? 1.0f / 255 : 1.0f / 65535;
  }
  std::vector<Vec4f> colors(flat.size() / components);
  uint64_t bad = 0;
  const auto part = [&](size_t i) {
    if (!std::isfinite(flat[i])) ++bad;
    return std::isfinite(flat[i]) ? std::max(flat[i] * scale, 0.0f) : 1.0f;
  };
  bool all_white = true;
  for (size_t v = 0; v < colors.size(); ++v) {
    const size_t i = v * components;
    colors[v] = {part(i), part(i + 1), part(i + 2), components == 4 ? part(i + 3) : 1.0f};
    all_white = all_white && colors[v] == Vec4f{1, 1, 1, 1};
  }
  if (bad) warnings.add(where, "parts of vertex colours that are not finite count as 1", bad);
  if (!all_white) primitive.colors = std::move(colors);
}

/// Appends a copy of vertex `v` in everything that has one element per vertex.
void copy_vertex(Primitive& primitive, uint32_t v) {
  const auto copy = [&](auto& list) {
    if (list.size() > v) list.push_back(list[v]);
  };
  copy(primitive.positions);
  copy(primitive.normals);
  copy(primitive.uvs);
  for (auto& set : primitive.more_uvs) copy(set);
  copy(primitive.colors);
  for (MorphTarget& target : primitive.targets) {
    copy(target.positions);
    copy(target.normals);
  }
  if (!primitive.is_skinned()) return;
  for (uint32_t i = primitive.influence_begin[v]; i < primitive.influence_begin[v + 1]; ++i)
    primitive.influences.push_back(primitive.influences[i]);
  primitive.influence_begin.push_back(static_cast<uint32_t>(primitive.influences.size()));
}

}  // namespace

void read_surface_attributes(AttributeReader& attributes, const Material& material, const std::string& where,
                             Primitive& primitive, Warnings& warnings) {
  read_uvs(attributes, material, primitive);
  read_tangents(attributes, where, material, primitive, warnings);
  read_colors(attributes, where, primitive, warnings);
}

void add_tangents(Document& document, const Material& material, const std::string& where, Primitive& primitive) {
  const TextureRef& picture = material.normal_texture;
  if (picture.empty() || primitive.normals.empty() || !primitive.tangents.empty()) return;
  const std::vector<Vec2f>* set = picture.uv_set == 0 ? &primitive.uvs
                                  : picture.uv_set <= primitive.more_uvs.size()
                                      ? &primitive.more_uvs[picture.uv_set - 1]
                                      : nullptr;
  if (!set || set->empty()) return;
  constexpr uint64_t kBytesPerTriangle = 400, kBytesPerSplit = 200;  // of what is needed on the way, at most
  document.charge(primitive.triangles.size() * kBytesPerTriangle, where);
  std::vector<Vec2f> uvs(set->size());
  for (size_t v = 0; v < uvs.size(); ++v) uvs[v] = picture.place((*set)[v]);
  const CornerTangents made = make_tangents(primitive.positions, primitive.normals, uvs, primitive.triangles);
  std::vector<uint32_t> tangent_of(primitive.positions.size(), kNoTangent);  // [vertex]
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> splits;                  // vertex and tangent: the new vertex
  for (size_t corner = 0; corner < made.corner.size(); ++corner) {
    uint32_t& vertex = primitive.triangles[corner / 3][corner % 3];
    const uint32_t wanted = made.corner[corner];
    if (wanted == kNoTangent || tangent_of[vertex] == wanted) continue;
    if (tangent_of[vertex] == kNoTangent) {
      tangent_of[vertex] = wanted;
      continue;
    }
    const auto [found, is_new] =
        splits.try_emplace({vertex, wanted}, static_cast<uint32_t>(primitive.positions.size()));
    if (is_new) {
      document.charge(kBytesPerSplit + primitive.targets.size() * 2 * sizeof(Vec3f), where);
      copy_vertex(primitive, vertex);
      tangent_of.push_back(wanted);
    }
    vertex = found->second;
  }
  primitive.tangents.resize(primitive.positions.size());
  for (size_t v = 0; v < primitive.tangents.size(); ++v)
    primitive.tangents[v] = tangent_of[v] == kNoTangent ? Vec4f{0, 0, 0, 1} : made.tangents[tangent_of[v]];
}

}  // namespace kairos::gltf
