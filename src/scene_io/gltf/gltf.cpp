#include "scene_io/gltf/gltf.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <kairos/printable.h>

#include "base/file.h"
#include "scene_io/gltf/document.h"
#include "scene_io/gltf/instances.h"
#include "scene_io/gltf/motion.h"
#include "scene_io/gltf/nodes.h"
#include "scene_io/gltf/primitive.h"
#include "scene_io/gltf/surface.h"
#include "scene_io/turned_triangles.h"

namespace kairos {

namespace {

using namespace gltf;

// A GLB cannot be larger: it counts its bytes in 32 bits.
constexpr uint64_t kMaxFileBytes = uint64_t{1} << 32;

/// "name", "name.1", "name.2", ... in the order asked for.
class UniqueNames {
 public:
  std::string make(const std::string& name) {
    std::string result = name;
    for (size_t& next = next_[name]; !used_.insert(result).second;) result = fmt::format("{}.{}", name, ++next);
    return result;
  }

 private:
  std::map<std::string, size_t> next_;
  std::set<std::string> used_;
};

std::string first_of(const std::string& a, const std::string& b, const std::string& otherwise) {
  return printable(!a.empty() ? a : !b.empty() ? b : otherwise);
}

class SceneReader {
 public:
  SceneReader(std::span<const uint8_t> bytes, const std::string& name, const SceneFolder& folder, LoadContext& context)
      : options_(context.options),
        warnings_(name, context.options.strict),
        document_(read_document(bytes, name, folder, context.budget, warnings_)) {}

  Scene read() {
    auto graph = std::make_shared<NodeGraph>(document_);
    play_animations(document_, options_.animation, *graph, scene_, warnings_);
    graph_ = std::move(graph);
    read_materials(document_, scene_, warnings_);
    for (const SeenNode& node : nodes_of_scene()) {
      if (node.is_visible) add_meshes(node.index);
      add_camera(node.index);
      if (node.is_visible) add_light(node.index);
    }
    scene_.warnings = warnings_.lines();
    return std::move(scene_);
  }

 private:
  /// Roots of the scene that the options name; without any scene in the file, of everything.
  std::vector<int> roots() const {
    const auto& scenes = document_.model.scenes;
    std::vector<std::string> names;
    names.reserve(scenes.size());
    for (const auto& scene : scenes) names.push_back(scene.name);
    int index = document_.model.scene;
    if (!options_.gltf_scene.empty()) {
      index = find_by_name_or_index(names, options_.gltf_scene);
      if (index < 0)
        throw Error(ErrorCode::bad_usage, document_.name,
                    "has no scene '" + printable(options_.gltf_scene) + "'; it has: " + listed(names));
    }
    if (index >= 0 && static_cast<size_t>(index) >= scenes.size())
      document_.fail("scene", fmt::format("names scene {}, but there are {}", index, scenes.size()));
    if (!scenes.empty()) return scenes[static_cast<size_t>(std::max(index, 0))].nodes;
    std::vector<int> result;
    for (size_t i = 0; i < graph_->nodes.size(); ++i)
      if (graph_->nodes[i].parent < 0) result.push_back(static_cast<int>(i));
    return result;
  }

  struct SeenNode {
    int index;
    bool is_visible;
  };

  /// What all meshes that are made of one primitive have in common.
  struct SharedSurface {
    SharedArray<Triangle> triangles;
    SharedArray<Vec2f> uvs;
    SharedArray<std::vector<Vec2f>> more_uvs;
    SharedArray<Vec4f> colors;
    SharedArray<uint32_t> prim_ids;

    explicit SharedSurface(const Primitive& from)
        : triangles(from.triangles),
          uvs(from.uvs),
          more_uvs(from.more_uvs),
          colors(from.colors),
          prim_ids(from.prim_ids) {}
  };

  /// All nodes of the scene, parents before children and siblings in the file's order.
  std::vector<SeenNode> nodes_of_scene() const {
    const std::vector<int> first = roots();
    std::vector<SeenNode> stack, result;
    for (int root : first)
      if (root < 0 || static_cast<size_t>(root) >= graph_->nodes.size())
        document_.fail("scenes", fmt::format("a scene names node {}, but there are {}", root, graph_->nodes.size()));
    for (auto root = first.rbegin(); root != first.rend(); ++root) stack.push_back({*root, true});
    std::vector<bool> seen(graph_->nodes.size(), false);
    while (!stack.empty()) {
      const SeenNode parent = stack.back();
      const auto node = static_cast<size_t>(parent.index);
      stack.pop_back();
      if (seen[node]) continue;
      seen[node] = true;
      const file::Node& source = document_.model.nodes[node];
      const bool is_visible = parent.is_visible && source.visible;  // who hides hides all below
      result.push_back({parent.index, is_visible});
      for (auto child = source.children.rbegin(); child != source.children.rend(); ++child)
        stack.push_back({*child, is_visible});
    }
    return result;
  }

  void add_meshes(int node) {
    const file::Node& source = document_.model.nodes[static_cast<size_t>(node)];
    const std::string where = at("nodes", static_cast<size_t>(node));
    if (source.mesh < 0) return;
    const auto& meshes = document_.model.meshes;
    if (static_cast<size_t>(source.mesh) >= meshes.size())
      document_.fail(where, fmt::format("names mesh {}, but there are {}", source.mesh, meshes.size()));
    const file::Mesh& mesh = meshes[static_cast<size_t>(source.mesh)];
    const std::string name = first_of(source.name, mesh.name, fmt::format("mesh{}", source.mesh));
    std::vector<Mat4> places(1);
    if (source.instances) places = read_instances(document_, *source.instances, where, warnings_);
    for (const auto& primitive : primitives_of(static_cast<size_t>(source.mesh))) {
      if (primitive->triangles.empty()) continue;
      const auto skin = skin_for(source, *primitive, where);
      for (const Mat4& place : places) {
        auto motion = std::make_shared<const MeshMotion>(graph_, node, primitive, skin,
                                                         source.weights.empty() ? mesh.weights : source.weights, place);
        add_mesh(name, *primitive, std::move(motion), where);
      }
    }
  }

  void add_mesh(const std::string& name, const Primitive& primitive, std::shared_ptr<const MeshMotion> motion,
                const std::string& where) {
    const auto [found, is_new] = surfaces_.try_emplace(&primitive, primitive);
    const SharedSurface& surface = found->second;
    // Triangles are there twice where some of its nodes mirror.
    const uint64_t shared = 2 * primitive.triangles.size() * sizeof(Triangle) +
                            primitive.triangles.size() * sizeof(uint32_t) +
                            primitive.positions.size() * (1 + primitive.more_uvs.size()) * sizeof(Vec2f) +
                            primitive.colors.size() * sizeof(Vec4f);
    constexpr uint64_t kBytesOfInstance = 2048;  // with its motion, its name, and what a shot makes of it
    document_.charge((is_new ? shared : 0) + kBytesOfInstance, where);
    SceneMesh result;
    result.name = names_.make(name);
    result.triangles = motion->mirrors() ? turned_.of(surface.triangles) : surface.triangles;
    result.uvs = surface.uvs;
    result.more_uvs = surface.more_uvs;
    result.colors = surface.colors;
    result.prim_ids = surface.prim_ids;
    result.material = primitive.material;
    result.motion = std::move(motion);
    scene_.meshes.push_back(std::move(result));
  }

  /// Those of them that can be traced; read once, however many nodes use them.
  const std::vector<std::shared_ptr<const Primitive>>& primitives_of(size_t mesh) {
    const auto [found, is_new] = primitives_.try_emplace(mesh);
    if (is_new) {
      const auto& sources = document_.model.meshes[mesh].primitives;
      for (size_t i = 0; i < sources.size(); ++i)
        if (auto primitive = read_primitive(document_, sources[i], scene_.materials,
                                            at("meshes", mesh) + "." + at("primitives", i), warnings_))
          found->second.push_back(std::move(primitive));
    }
    return found->second;
  }

  std::shared_ptr<const Skin> skin_for(const file::Node& source, const Primitive& primitive, const std::string& where) {
    if (source.skin < 0) return nullptr;
    if (static_cast<size_t>(source.skin) >= document_.model.skins.size())
      document_.fail(where, fmt::format("names skin {}, but there are {}", source.skin, document_.model.skins.size()));
    if (!primitive.is_skinned()) {
      warnings_.add(where, "the skin of a mesh without joints and weights is left out");
      return nullptr;
    }
    auto& skin = skins_[source.skin];
    if (!skin) skin = std::make_shared<const Skin>(read_skin(document_, static_cast<size_t>(source.skin), *graph_));
    if (primitive.joint_count > skin->joints.size())
      document_.fail(where, fmt::format("its mesh uses joint {}, but its skin has {}", primitive.joint_count - 1,
                                        skin->joints.size()));
    return skin;
  }

  void add_camera(int node) {
    const file::Node& source = document_.model.nodes[static_cast<size_t>(node)];
    if (source.camera < 0) return;
    const auto& cameras = document_.model.cameras;
    if (static_cast<size_t>(source.camera) >= cameras.size())
      document_.fail(at("nodes", static_cast<size_t>(node)),
                     fmt::format("names camera {}, but there are {}", source.camera, cameras.size()));
    const auto index = static_cast<size_t>(source.camera);
    SceneCamera camera = read_camera(document_, index);
    camera.name = camera_names_.make(first_of(source.name, cameras[index].name, fmt::format("camera{}", index)));
    camera.motion = std::make_shared<const CameraMotion>(graph_, node);
    scene_.cameras.push_back(std::move(camera));
  }

  void add_light(int node) {
    const std::optional<Light> light = read_light(document_, node, warnings_);
    if (!light) return;
    scene_.brings_lights = true;
    constexpr double kEver = std::numeric_limits<double>::infinity();
    if (!graph_->is_static(node, -kEver, kEver))
      scene_.moving_lights[scene_.lights.size()] = {*light, std::make_shared<const NodeMotion>(graph_, node)};
    scene_.lights.push_back(placed(*light, graph_->world_at_rest(node)));
  }

  const LoadOptions& options_;
  Warnings warnings_;
  Document document_;
  std::shared_ptr<const NodeGraph> graph_;
  std::map<size_t, std::vector<std::shared_ptr<const Primitive>>> primitives_;
  std::map<const Primitive*, SharedSurface> surfaces_;
  TurnedTriangles turned_;
  std::map<int, std::shared_ptr<const Skin>> skins_;
  UniqueNames names_, camera_names_;
  Scene scene_;
};

}  // namespace

Scene parse_gltf(std::span<const uint8_t> bytes, const std::string& name, const SceneFolder& folder,
                 LoadContext& context) {
  return SceneReader(bytes, name, folder, context).read();
}

Scene parse_gltf(std::span<const uint8_t> bytes, const std::string& name, const std::string& folder,
                 const LoadOptions& options) {
  LoadContext context(options);
  return parse_gltf(bytes, name, SceneFolder{folder, options.root}, context);
}

Scene load_gltf(const std::string& path, LoadContext& context) {
  context.count_file(path);
  const std::vector<uint8_t> bytes = read_file(path, kMaxFileBytes);
  return parse_gltf(bytes, path, context.folder_of(path), context);
}

}  // namespace kairos
