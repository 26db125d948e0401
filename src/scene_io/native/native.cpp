#include "scene_io/native/native.h"

#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>

#include "base/file.h"
#include "scene_io/json_node.h"
#include "scene_io/json_text.h"
#include "scene_io/keyframes.h"
#include "scene_io/native/parts.h"
#include "scene_io/placed_motion.h"
#include "scene_io/text_numbers.h"
#include "scene_io/turned_triangles.h"

namespace kairos {

namespace {

constexpr size_t kMaxIncludeDepth = 16;

class NativeReader {
 public:
  NativeReader(const JsonNode& root, const std::string& path, LoadContext& context)
      : root_(root), folder_(context.folder_of(path)), context_(context) {}

  Scene read() {
    root_.expect_fields(
        {"kairos", "include", "meshes", "camera", "shutter", "image", "materials", "lights", "background"});
    if (root_.at("kairos").number() != 1) root_.at("kairos").fail("only version 1 is known");
    scene_.materials.emplace_back();
    scene_.fps = 1;
    // What is cheap to check comes before files are read.
    read_camera_and_image();
    read_materials();
    if (const auto lights = root_.find("lights")) {
      scene_.brings_lights = true;  // an empty list says that there are none
      for (const JsonNode& light : lights->items()) scene_.lights.push_back(read_light(light, picture_finder()));
    }
    read_includes();
    if (const auto background = root_.find("background")) scene_.background = background->color();
    if (const auto meshes = root_.find("meshes"))
      for (const JsonNode& mesh : meshes->items()) read_mesh(mesh);
    if (!scene_.shutter && has_keys_) scene_.shutter = {0, 1};
    return std::move(scene_);
  }

 private:
  void read_camera_and_image() {
    if (const auto camera = root_.find("camera")) {
      scene_.cameras.push_back(read_camera(*camera));
      has_keys_ = camera->at("keys").items().size() > 1;
    }
    if (const auto shutter = root_.find("shutter")) {
      const std::vector<JsonNode> ends = shutter->items(2);
      scene_.shutter = {ends[0].time(), ends[1].time()};
      if (!((*scene_.shutter)[0] <= (*scene_.shutter)[1])) shutter->fail("the shutter closes before it opens");
    }
    if (const auto image = root_.find("image")) {
      image->expect_fields({"width", "height"});
      constexpr int kMaxSide = 65536;
      scene_.image_size = {image->at("width").integer(1, kMaxSide), image->at("height").integer(1, kMaxSide)};
    }
  }

  void read_materials() {
    const auto materials = root_.find("materials");
    if (!materials) return;
    for (const auto& [name, node] : materials->fields()) {
      material_index_[name] = static_cast<uint32_t>(scene_.materials.size());
      scene_.materials.push_back(read_material(name, node, picture_finder()));
    }
  }

  void read_includes() {
    const auto include = root_.find("include");
    if (!include) return;
    bool first = true;
    for (const JsonNode& node : include->items()) {
      Scene other = node.is_object() ? read_placed(node) : load_file(path_of(node), context_);
      if (std::exchange(first, false)) scene_.fps = other.fps;
      append_scene(scene_, std::move(other));
    }
  }

  std::string path_of(const JsonNode& node) const { return folder_.resolve(node.string(), node.place()); }

  /// One can do without a picture.
  FindPicture picture_finder() {
    return [this](const JsonNode& name) {
      std::string problem;
      std::string path = folder_.try_resolve(name.string(), problem);
      if (problem.empty()) return path;
      if (context_.options.strict) name.fail(problem);
      scene_.warnings.push_back(name.place() + ": picture left out: " + problem);
      return path;
    };
  }

  /// A file with an animation of its own choice, or at another place.
  Scene read_placed(const JsonNode& node) {
    node.expect_fields({"file", "animation", "transform"});
    const std::string path = path_of(node.at("file"));
    const LoadOptions usual = context_.options;
    const auto animation = node.find("animation");
    if (animation) context_.options.animation = animation->string();
    Scene scene;
    const std::pair included(path, context_.options.animation);
    try {
      auto found = included_.find(included);
      if (found == included_.end()) found = included_.emplace(included, load_file(path, context_)).first;
      scene = found->second;
      // Said once.
      found->second.warnings.clear();
      found->second.notes.clear();
    } catch (const Error& error) {  // it is not the caller who named an animation that is not there
      if (!animation || error.code() != ErrorCode::bad_usage) throw;
      animation->fail(error.what());
    }
    context_.options = usual;
    const auto given = node.find("transform");
    if (!given) return scene;
    // Lights and cameras of a file describe it by itself; where its meshes go as a part of something else, they stay.
    scene.cameras.clear();
    scene.lights.clear();
    scene.moving_lights.clear();
    scene.brings_lights = false;
    const TransformKeys transform = read_transform(*given);
    for (SceneMesh& mesh : scene.meshes) {
      if (transform.mirrors()) mesh.triangles = turned_.of(mesh.triangles);
      mesh.motion = std::make_shared<PlacedMotion>(mesh.motion, transform);
    }
    has_keys_ = has_keys_ || transform.matrices.size() > 1;
    return scene;
  }

  /// One mesh, or one for each material that its file has, unless the node gives one.
  void read_mesh(const JsonNode& node) {
    node.expect_fields({"name", "keys", "times", "material", "transform"});
    const std::vector<JsonNode> keys = node.at("keys").items();
    if (keys.empty()) node.at("keys").fail("a mesh needs at least one key");
    std::vector<std::string> paths;
    for (const JsonNode& key : keys) {
      paths.push_back(path_of(key));
      if (!is_mesh_file(paths.back())) key.fail("a key must be an OBJ or PLY file; use 'include' for others");
    }

    std::vector<double> times = even_times(keys.size());
    if (const auto given = node.find("times")) {
      const std::vector<JsonNode> numbers = given->items();
      if (numbers.size() != keys.size()) given->fail(fmt::format("{} times for {} keys", numbers.size(), keys.size()));
      for (size_t k = 0; k < times.size(); ++k) times[k] = numbers[k].time();
      expect_ascending(times, *given);
    }
    TransformKeys transform;
    if (const auto given = node.find("transform")) transform = read_transform(*given);
    has_keys_ = has_keys_ || keys.size() > 1 || transform.matrices.size() > 1;

    const auto name = node.find("name");
    const std::string mesh_name = name ? name->string() : std::filesystem::path(paths.front()).stem().string();
    uint32_t material_of_all = 0;
    const auto material = node.find("material");
    if (material) {
      const auto found = material_index_.find(material->string());
      if (found == material_index_.end())
        material->fail("no material '" + printable(material->string()) + "' in this file's 'materials'");
      material_of_all = found->second;
    }
    for (const FilePart& part : parts_of(paths, times, !material)) {
      SceneMesh mesh = part.mesh;
      mesh.name = mesh_name + part.mesh.name;
      if (!part.has_material) mesh.material = material_of_all;
      const auto motion = std::make_shared<KeyframeMotion>(part.vertices, transform);
      if (motion->mirrors()) mesh.triangles = turned_.of(mesh.triangles);
      mesh.motion = motion;
      scene_.meshes.push_back(std::move(mesh));
    }
  }

  /// What a file's triangles of one material give to a mesh. mesh.name: what is added to the mesh's own.
  struct FilePart {
    SceneMesh mesh;
    std::shared_ptr<const VertexKeys> vertices;
    bool has_material;
  };

  /// The same files are read once, however many meshes are made of them.
  const std::vector<FilePart>& parts_of(const std::vector<std::string>& paths, const std::vector<double>& times,
                                        bool with_materials) {
    const auto [place, is_new] = parts_.try_emplace({paths, times, with_materials});
    std::vector<FilePart>& parts = place->second;
    if (!is_new) return parts;
    MeshFile file = load_mesh_file(paths, with_materials, context_);
    for (std::string& warning : file.warnings) scene_.warnings.push_back(std::move(warning));
    const auto first = static_cast<uint32_t>(scene_.materials.size());
    for (MaterialPart& part : file.parts) {
      FilePart& made = parts.emplace_back();
      if (file.parts.size() > 1) made.mesh.name = "." + file.materials[part.material].name;
      made.has_material = !file.materials.empty();
      if (made.has_material) made.mesh.material = first + part.material;
      made.vertices = std::make_shared<const VertexKeys>(
          VertexKeys{times, std::move(part.data.positions), std::move(part.data.normals)});
      take_surface(made.mesh, part.data);
    }
    for (Material& one : file.materials) scene_.materials.push_back(std::move(one));
    return parts;
  }

  const JsonNode& root_;
  const SceneFolder folder_;
  LoadContext& context_;
  Scene scene_;
  std::map<std::string, uint32_t> material_index_;
  std::map<std::pair<std::string, std::string>, Scene> included_;  // by file and animation
  std::map<std::tuple<std::vector<std::string>, std::vector<double>, bool>, std::vector<FilePart>> parts_;
  TurnedTriangles turned_;
  bool has_keys_ = false;  ///< does anything in this file itself have several keys?
};

}  // namespace

Scene parse_native(std::string_view text, const std::string& path, LoadContext& context) {
  const JsonText document(text, path);
  const JsonNode root(document.root(), path);
  return NativeReader(root, path, context).read();
}

Scene load_native(const std::string& path, LoadContext& context) {
  constexpr uint64_t kMaxFileSize = 256 << 20;
  context.count_file(path);
  std::error_code ec;
  const std::string canonical = std::filesystem::weakly_canonical(path, ec).string();
  for (const std::string& open : context.open_files)
    if (open == canonical) throw Error(ErrorCode::bad_input, path, "includes itself, perhaps by way of other files");
  if (context.open_files.size() >= kMaxIncludeDepth)
    throw Error(ErrorCode::bad_input, path, fmt::format("includes are nested more than {} deep", kMaxIncludeDepth));
  context.open_files.push_back(canonical);
  const std::vector<uint8_t> bytes = read_file(path, kMaxFileSize);
  context.budget.add_file(bytes.size());
  Scene scene =
      parse_native(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), path, context);
  context.open_files.pop_back();
  return scene;
}

}  // namespace kairos
