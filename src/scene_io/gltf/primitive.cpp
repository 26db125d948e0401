#include "scene_io/gltf/primitive.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "scene_io/gltf/accessor.h"
#include "scene_io/gltf/attributes.h"

namespace kairos::gltf {

namespace {

std::vector<Vec3f> vectors(const std::vector<float>& flat) {
  std::vector<Vec3f> result(flat.size() / 3);
  for (size_t i = 0; i < result.size(); ++i) result[i] = {flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
  return result;
}

void read_normals(AttributeReader& attributes, const std::string& where, Primitive& primitive, Warnings& warnings) {
  if (!attributes.has("NORMAL")) return;
  std::vector<Vec3f> normals = vectors(attributes.floats("NORMAL", 3));
  for (const Vec3f& n : normals)
    if (normalize(n) == Vec3f{}) return warnings.add(where, "normals are left out: some are zero or not finite");
  primitive.normals = std::move(normals);
}

void read_targets(Document& document, const file::Primitive& source, const AttributeReader& attributes,
                  const std::string& where, Primitive& primitive) {
  for (size_t i = 0; i < source.targets.size(); ++i) {
    const auto displacements = [&](const char* name) -> std::vector<Vec3f> {
      const auto found = source.targets[i].find(name);
      if (found == source.targets[i].end()) return {};
      const std::string user = where + "." + at("targets", i) + "." + name;
      return vectors(read_floats(document, attributes.checked_accessor(found->second, user), 3, user));
    };
    MorphTarget target;
    target.positions = displacements("POSITION");
    if (!primitive.normals.empty()) target.normals = displacements("NORMAL");
    if (!primitive.tangents.empty()) target.tangents = displacements("TANGENT");
    primitive.targets.push_back(std::move(target));
  }
}

/// Joints and weights of all sets, without those that weigh nothing; the rest made to sum to 1.
void read_influences(Document& document, AttributeReader& attributes, const std::string& where, Primitive& primitive,
                     Warnings& warnings) {
  std::vector<std::vector<uint32_t>> joints;
  std::vector<std::vector<float>> weights;
  for (int set = 0; attributes.has(fmt::format("JOINTS_{}", set)); ++set) {
    if (!attributes.has(fmt::format("WEIGHTS_{}", set)))
      document.fail(where, fmt::format("has JOINTS_{} but no WEIGHTS_{}", set, set));
    joints.push_back(attributes.integers(fmt::format("JOINTS_{}", set), 4));
    weights.push_back(attributes.floats(fmt::format("WEIGHTS_{}", set), 4));
  }
  if (joints.empty()) return;
  const size_t vertices = attributes.vertex_count();
  document.charge((vertices + 1) * sizeof(uint32_t) + vertices * joints.size() * 4 * sizeof(Influence), where);
  uint64_t without_weight = 0;
  primitive.influence_begin.reserve(vertices + 1);
  for (size_t v = 0; v < vertices; ++v) {
    const size_t begin = primitive.influences.size();
    primitive.influence_begin.push_back(static_cast<uint32_t>(begin));
    double sum = 0;
    for (size_t set = 0; set < joints.size(); ++set)
      for (size_t c = 4 * v; c < 4 * v + 4; ++c)
        if (const float weight = weights[set][c]; weight > 0 && std::isfinite(weight)) {
          primitive.influences.push_back({joints[set][c], weight});
          sum += static_cast<double>(weight);
        }
    if (primitive.influences.size() == begin) {  // nothing holds it: the first joint does
      primitive.influences.push_back({joints[0][4 * v], 1});
      sum = 1;
      ++without_weight;
    }
    for (size_t i = begin; i < primitive.influences.size(); ++i) {
      Influence& influence = primitive.influences[i];
      influence.weight = static_cast<float>(static_cast<double>(influence.weight) / sum);
      primitive.joint_count = std::max(primitive.joint_count, influence.joint + 1);
    }
    if (primitive.influences.size() > std::numeric_limits<uint32_t>::max())
      document.fail(where, "has more than 2^32 skin weights");
  }
  primitive.influence_begin.push_back(static_cast<uint32_t>(primitive.influences.size()));
  if (without_weight)
    warnings.add(where, "vertices without a usable skin weight follow their first joint", without_weight);
}

/// Drops the triangles that name vertices that do not exist.
void keep_sound_triangles(std::vector<Triangle> all, const std::string& where, Primitive& primitive,
                          Warnings& warnings) {
  const size_t vertices = primitive.positions.size();
  const auto is_sound = [&](const Triangle& triangle) {
    return std::all_of(triangle.begin(), triangle.end(), [&](uint32_t v) { return v < vertices; });
  };
  const auto bad =
      static_cast<size_t>(std::count_if(all.begin(), all.end(), [&](const Triangle& t) { return !is_sound(t); }));
  if (bad == 0) {
    primitive.triangles = std::move(all);
    return;
  }
  warnings.add(where, "triangles that name vertices that do not exist are dropped", bad);
  for (size_t i = 0; i < all.size(); ++i)
    if (is_sound(all[i])) {
      primitive.triangles.push_back(all[i]);
      primitive.prim_ids.push_back(static_cast<uint32_t>(i));
    }
}

}  // namespace

std::vector<Triangle> assemble_triangles(const std::vector<uint32_t>& corners, int mode) {
  std::vector<Triangle> result;
  if (corners.size() < 3) return result;
  const size_t count = mode == file::kTriangles ? corners.size() / 3 : corners.size() - 2;
  result.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    if (mode == file::kTriangles)
      result.push_back({corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]});
    else if (mode == file::kTriangleStrip)
      result.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    else
      result.push_back({corners[i + 1], corners[i + 2], corners[0]});
  }
  return result;
}

std::shared_ptr<const Primitive> read_primitive(Document& document, const file::Primitive& source,
                                                const std::vector<Material>& materials, const std::string& where,
                                                Warnings& warnings) {
  const int mode = source.mode;
  if (mode < file::kPoints || mode > file::kTriangleFan)
    document.fail(where, fmt::format("has the unknown mode {}", mode));
  if (mode < file::kTriangles) {
    warnings.add(where, "points and lines are left out");
    return nullptr;
  }
  if (!source.attributes.count("POSITION")) {
    warnings.add(where, "a primitive without positions is left out");
    return nullptr;
  }
  auto primitive = std::make_shared<Primitive>();
  const size_t file_materials = materials.size() - 1;  // glTF's default one stands behind the file's
  if (source.material >= 0 && static_cast<size_t>(source.material) >= file_materials)
    document.fail(where, fmt::format("names material {}, but there are {}", source.material, file_materials));
  primitive->material =
      static_cast<uint32_t>(source.material < 0 ? file_materials : static_cast<size_t>(source.material));
  const Material& material = materials[primitive->material];
  AttributeReader attributes(document, source, where);
  const std::vector<uint32_t> corners = attributes.corners();
  if (corners.empty() || attributes.vertex_count() == 0) {
    warnings.add(where, "an empty primitive is left out");
    return nullptr;
  }
  document.charge(corners.size() * (sizeof(Triangle) + sizeof(uint32_t)), where);
  // Draco gives a list even where the mode, and the accessor that it stands for, say strip.
  const int assembled_as = attributes.is_draco() ? file::kTriangles : mode;
  if (assembled_as == file::kTriangles && corners.size() % 3 != 0)
    warnings.add(where, "the last triangle of a list lacks corners and is left out");
  primitive->positions = vectors(attributes.floats("POSITION", 3));
  keep_sound_triangles(assemble_triangles(corners, assembled_as), where, *primitive, warnings);
  read_normals(attributes, where, *primitive, warnings);
  read_surface_attributes(attributes, material, where, *primitive, warnings);
  read_targets(document, source, attributes, where, *primitive);
  read_influences(document, attributes, where, *primitive, warnings);
  add_tangents(document, material, where, *primitive);
  return primitive;
}

}  // namespace kairos::gltf
