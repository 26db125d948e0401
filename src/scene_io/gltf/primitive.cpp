#include "scene_io/gltf/primitive.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "scene_io/gltf/accessor.h"
#include "scene_io/gltf/draco.h"

namespace kairos::gltf {

namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// Attributes of one primitive, from Draco where it has them and from accessors otherwise.
class AttributeReader {
 public:
  AttributeReader(Document& document, const tinygltf::Primitive& source, const std::string& where)
      : document_(document), source_(source), where_(where) {
    position_ = &get_accessor(document, source.attributes.at("POSITION"), where + ".attributes.POSITION");
    if (position_->count > std::numeric_limits<uint32_t>::max())
      document.fail(at("accessors", static_cast<size_t>(source.attributes.at("POSITION"))),
                    "has more than 2^32 vertices");
    if (const auto found = source.extensions.find(kDraco); found != source.extensions.end()) decode(found->second);
  }

  size_t vertex_count() const { return position_->count; }

  bool has(const std::string& name) const { return source_.attributes.count(name) != 0; }

  /// One element per vertex.
  std::vector<float> floats(const std::string& name, int components) {
    const int accessor = checked_accessor(source_.attributes.at(name), name);
    if (const auto id = draco_ids_.find(name); id != draco_ids_.end())
      return draco_->floats(document_, id->second, components, get_accessor(document_, accessor, name).normalized);
    return read_floats(document_, accessor, components, where_ + ".attributes." + printable(name));
  }

  std::vector<uint32_t> integers(const std::string& name, int components) {
    if (draco_ids_.count(name)) {
      const std::vector<float> values = floats(name, components);
      std::vector<uint32_t> result(values.size());
      for (size_t i = 0; i < values.size(); ++i) {
        if (!(values[i] >= 0 && values[i] <= 65535)) document_.fail(where_, "Draco's " + name + " are no joints");
        result[i] = static_cast<uint32_t>(values[i]);
      }
      return result;
    }
    return read_integers(document_, checked_accessor(source_.attributes.at(name), name), components,
                         where_ + ".attributes." + printable(name));
  }

  std::vector<uint32_t> corners() {
    if (draco_) return draco_->indices(document_);
    if (source_.indices >= 0) return read_integers(document_, source_.indices, 1, where_ + ".indices");
    document_.charge(vertex_count() * sizeof(uint32_t), where_);
    std::vector<uint32_t> all(vertex_count());
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }

  /// Throws unless the accessor has one element per vertex.
  int checked_accessor(int accessor, const std::string& name) const {
    const uint64_t count = get_accessor(document_, accessor, where_ + "." + printable(name)).count;
    if (count != vertex_count())
      document_.fail(
          where_, fmt::format("its {} has {} elements, but POSITION has {}", printable(name), count, vertex_count()));
    return accessor;
  }

 private:
  void decode(const tinygltf::Value& extension) {
    const std::string where = where_ + ".extensions." + kDraco;
    const bool sound = extension.Has("bufferView") && extension.Get("bufferView").IsInt() &&
                       extension.Has("attributes") && extension.Get("attributes").IsObject();
    if (!sound) document_.fail(where, "needs a bufferView and attributes");
    const tinygltf::Value& attributes = extension.Get("attributes");
    for (const std::string& name : attributes.Keys()) {
      const tinygltf::Value& id = attributes.Get(name);
      if (!id.IsInt() || id.GetNumberAsInt() < 0) document_.fail(where, "its attributes must be ids");
      draco_ids_[name] = static_cast<uint32_t>(id.GetNumberAsInt());
    }
    const int view = extension.Get("bufferView").GetNumberAsInt();
    if (view < 0 || static_cast<size_t>(view) >= document_.model.bufferViews.size())
      document_.fail(where, fmt::format("names buffer view {}, which does not exist", view));
    const uint64_t length = document_.model.bufferViews[static_cast<size_t>(view)].byteLength;
    const bool is_list = source_.mode == TINYGLTF_MODE_TRIANGLES && source_.indices >= 0;
    const uint64_t corners = is_list ? get_accessor(document_, source_.indices, where_ + ".indices").count : 0;
    draco_.emplace(document_, view_bytes(document_, view, 0, length, where), vertex_count(), corners, where);
  }

  Document& document_;
  const tinygltf::Primitive& source_;
  std::string where_;
  const tinygltf::Accessor* position_;
  std::optional<DracoMesh> draco_;
  std::map<std::string, uint32_t> draco_ids_;
};

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

void read_targets(Document& document, const tinygltf::Primitive& source, const AttributeReader& attributes,
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

void read_uvs(const Document& document, AttributeReader& attributes, Primitive& primitive) {
  TexturePlace place;
  if (primitive.material >= 0 && static_cast<size_t>(primitive.material) < document.texture_places.size())
    place = document.texture_places[static_cast<size_t>(primitive.material)];
  const std::string name = fmt::format("TEXCOORD_{}", place.set);
  if (!attributes.has(name)) return;
  const std::vector<float> flat = attributes.floats(name, 2);
  primitive.uvs.resize(flat.size() / 2);
  for (size_t i = 0; i < primitive.uvs.size(); ++i) primitive.uvs[i] = place.apply({flat[2 * i], flat[2 * i + 1]});
}

}  // namespace

std::vector<Triangle> assemble_triangles(const std::vector<uint32_t>& corners, int mode) {
  std::vector<Triangle> result;
  if (corners.size() < 3) return result;
  const size_t count = mode == TINYGLTF_MODE_TRIANGLES ? corners.size() / 3 : corners.size() - 2;
  result.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLES)
      result.push_back({corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]});
    else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
      result.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    else
      result.push_back({corners[i + 1], corners[i + 2], corners[0]});
  }
  return result;
}

std::shared_ptr<const Primitive> read_primitive(Document& document, const tinygltf::Primitive& source,
                                                const std::string& where, Warnings& warnings) {
  const int mode = source.mode;
  if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN)
    document.fail(where, fmt::format("has the unknown mode {}", mode));
  if (mode < TINYGLTF_MODE_TRIANGLES) {
    warnings.add(where, "points and lines are left out");
    return nullptr;
  }
  if (!source.attributes.count("POSITION")) {
    warnings.add(where, "a primitive without positions is left out");
    return nullptr;
  }
  auto primitive = std::make_shared<Primitive>();
  primitive->material = source.material;
  AttributeReader attributes(document, source, where);
  const std::vector<uint32_t> corners = attributes.corners();
  document.charge(corners.size() * (sizeof(Triangle) + sizeof(uint32_t)), where);
  // Draco gives a list even where the mode, and the accessor that it stands for, say strip.
  const bool is_draco = source.extensions.count(kDraco) != 0;
  const int assembled_as = is_draco ? TINYGLTF_MODE_TRIANGLES : mode;
  if (assembled_as == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0)
    warnings.add(where, "the last triangle of a list lacks corners and is left out");
  primitive->positions = vectors(attributes.floats("POSITION", 3));
  keep_sound_triangles(assemble_triangles(corners, assembled_as), where, *primitive, warnings);
  read_normals(attributes, where, *primitive, warnings);
  read_uvs(document, attributes, *primitive);
  read_targets(document, source, attributes, where, *primitive);
  read_influences(document, attributes, where, *primitive, warnings);
  return primitive;
}

}  // namespace kairos::gltf
