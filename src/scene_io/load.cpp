#include "scene_io/load.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <map>
#include <new>
#include <set>

#include <fmt/format.h>

#include <kairos/printable.h>
#include <kairos/temporary_error.h>

#include "base/file.h"
#include "base/parallel.h"
#include "scene_io/gltf/gltf.h"
#include "scene_io/keyframes.h"
#include "scene_io/native/native.h"
#include "scene_io/obj/materials.h"
#include "scene_io/obj/obj.h"
#include "scene_io/pbrt/pbrt.h"
#include "scene_io/ply/ply.h"

namespace kairos {

void LoadContext::count_file(const std::string& place) {
  if (--files_left < 0) throw Error(ErrorCode::bad_input, place, "the scene reads too many files");
}

FileFormat format_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".obj") return FileFormat::obj;
  if (extension == ".ply") return FileFormat::ply;
  if (extension == ".gltf" || extension == ".glb") return FileFormat::gltf;
  if (extension == ".json") return FileFormat::native;
  if (extension == ".pbrt") return FileFormat::pbrt;
  throw Error(ErrorCode::bad_input, path,
              "has no extension that is known; give .obj, .ply, .gltf, .glb, .pbrt or .json");
}

bool is_mesh_file(const std::string& path) {
  const FileFormat format = format_of(path);
  return format == FileFormat::obj || format == FileFormat::ply;
}

std::vector<double> even_times(size_t keys) {
  std::vector<double> times(keys);
  for (size_t k = 1; k < keys; ++k) times[k] = static_cast<double>(k) / static_cast<double>(keys - 1);
  return times;
}

MeshFile load_mesh_file(const std::vector<std::string>& paths, bool with_materials, LoadContext& context) {
  constexpr uint64_t kMaxFileSize = uint64_t{1} << 34;
  std::vector<PolygonMesh> keys;
  for (const std::string& path : paths) {
    context.count_file(path);
    const std::vector<uint8_t> bytes = read_file(path, kMaxFileSize);
    context.budget.add_file(bytes.size());
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    keys.push_back(format_of(path) == FileFormat::obj ? parse_obj(text, path) : parse_ply(text, path));
  }
  MeshData data = make_mesh_data(std::move(keys), context.options.strict);
  data.uvs = uvs_from_above(std::move(data.uvs));
  MeshFile file;
  file.warnings = std::move(data.warnings);
  const bool names_any = !data.libraries.empty() || std::any_of(data.material_names.begin(), data.material_names.end(),
                                                                [](const std::string& name) { return !name.empty(); });
  if (with_materials && names_any) {
    FileWarnings warnings(context.options.strict);
    file.materials = read_obj_materials(paths.front(), context.folder_of(paths.front()), data.libraries,
                                        data.material_names, warnings);
    for (std::string& line : warnings.lines()) file.warnings.push_back(std::move(line));
  } else {
    data.triangle_materials.clear();
  }
  file.parts = split_by_material(std::move(data));
  return file;
}

namespace {

/// What a file shows that says nothing of materials: grey, or its vertices' colours as they are.
Material material_without(const MeshFile& file) {
  Material material;
  for (const MaterialPart& part : file.parts) {
    if (part.data.colors.empty()) continue;
    material.base_color = {1, 1, 1};
    for (const Vec4f& color : part.data.colors)
      if (color.w < 1) material.alpha_mode = Material::AlphaMode::blend;
  }
  return material;
}

/// A scene of one mesh, or one for each of its materials, with keys spread evenly over the time 0 to 1.
Scene load_mesh_scene(const std::vector<std::string>& paths, LoadContext& context) {
  MeshFile file = load_mesh_file(paths, true, context);
  Scene scene;
  scene.materials = std::move(file.materials);
  if (scene.materials.empty()) scene.materials.push_back(material_without(file));
  scene.fps = 1;
  if (paths.size() > 1) scene.shutter = {0, 1};
  scene.warnings = std::move(file.warnings);
  for (MaterialPart& part : file.parts) {
    SceneMesh mesh;
    mesh.name = std::filesystem::path(paths.front()).stem().string();
    if (file.parts.size() > 1) mesh.name += "." + scene.materials[part.material].name;
    mesh.material = part.material;
    mesh.motion = std::make_shared<KeyframeMotion>(
        VertexKeys{even_times(paths.size()), std::move(part.data.positions), std::move(part.data.normals)});
    take_surface(mesh, part.data);
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

template <class T>
void move_append(std::vector<T>& to, std::vector<T>& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

template <class T>
void number_repeated_names(std::vector<T>& named) {
  std::set<std::string> taken;
  for (const T& one : named) taken.insert(one.name);
  std::set<std::string> seen;
  std::map<std::string, size_t> next_number;
  for (T& one : named) {
    if (seen.insert(one.name).second) continue;
    std::string name;
    do {
      name = fmt::format("{}.{}", one.name, ++next_number[one.name]);
    } while (!taken.insert(name).second);
    one.name = name;
    seen.insert(name);
  }
}

}  // namespace

void take_surface(SceneMesh& mesh, MeshData& data) {
  mesh.triangles = std::move(data.triangles);
  mesh.uvs = std::move(data.uvs);
  mesh.colors = std::move(data.colors);
  mesh.prim_ids = std::move(data.prim_ids);
}

void make_names_unique(Scene& scene) {
  number_repeated_names(scene.meshes);
  number_repeated_names(scene.cameras);
}

void append_scene(Scene& scene, Scene other) {
  const auto offset = static_cast<uint32_t>(scene.materials.size());
  for (SceneMesh& mesh : other.meshes) mesh.material += offset;
  move_append(scene.materials, other.materials);
  move_append(scene.meshes, other.meshes);
  scene.embedded_pictures.merge(other.embedded_pictures);
  scene.pictures.merge(other.pictures);
  move_append(scene.cameras, other.cameras);
  for (auto& [index, light] : other.moving_lights)
    scene.moving_lights.emplace(scene.lights.size() + index, std::move(light));
  move_append(scene.lights, other.lights);
  scene.brings_lights = scene.brings_lights || other.brings_lights;
  move_append(scene.animations, other.animations);
  move_append(scene.warnings, other.warnings);
  move_append(scene.notes, other.notes);
  if (scene.background == Vec3f{}) scene.background = other.background;
  scene.brightest = std::min(scene.brightest, other.brightest);
  if (!scene.shutter) scene.shutter = other.shutter;
  if (!scene.image_size) scene.image_size = other.image_size;
}

Scene load_file(const std::string& path, LoadContext& context) {
  switch (format_of(path)) {
    case FileFormat::obj:
    case FileFormat::ply:
      return load_mesh_scene({path}, context);
    case FileFormat::native:
      return load_native(path, context);
    case FileFormat::pbrt:
      return load_pbrt(path, context);
    case FileFormat::gltf:
      break;
  }
  return load_gltf(path, context);
}

namespace {

/// Names are shown on terminals, and who asks for a camera by its name asks for what was shown.
void make_printable(Scene& scene) {
  const auto clean = [](std::string& text) { text = printable(text, std::string::npos); };
  for (SceneMesh& mesh : scene.meshes) clean(mesh.name);
  for (SceneCamera& camera : scene.cameras) clean(camera.name);
  for (Material& material : scene.materials) clean(material.name);
  for (SceneAnimation& animation : scene.animations) clean(animation.name);
  for (std::string& note : scene.notes) clean(note);
  for (std::string& warning : scene.warnings) clean(warning);
}

std::shared_ptr<const Scene> load_here(const std::vector<std::string>& paths, const LoadOptions& options) {
  if (paths.empty()) throw Error(ErrorCode::bad_usage, "", "no scene file given");
  std::vector<std::string> mesh_files, scene_files;
  for (const std::string& path : paths) (is_mesh_file(path) ? mesh_files : scene_files).push_back(path);
  LoadContext context(options);
  // Each file that is given brings its own folder, unless one is given for all.
  const auto enter = [&](const std::string& path) {
    if (options.root.empty()) context.root = parent_folder(path);
  };
  try {
    std::optional<Scene> scene;
    for (const std::string& path : scene_files) {
      enter(path);
      Scene one = load_file(path, context);
      if (scene)
        append_scene(*scene, std::move(one));
      else
        scene = std::move(one);
    }
    if (!mesh_files.empty()) {
      enter(mesh_files.front());
      Scene one = load_mesh_scene(mesh_files, context);
      if (scene)
        append_scene(*scene, std::move(one));
      else
        scene = std::move(one);
    }
    if (scene->meshes.empty()) {
      const std::string nothing = "has nothing to show: no mesh";
      if (options.strict) throw Error(ErrorCode::bad_input, paths.front(), nothing);
      scene->warnings.push_back(paths.front() + ": " + nothing);
    }
    make_printable(*scene);
    make_names_unique(*scene);
    scene->memory_budget = context.budget.left();
    scene->files = paths;
    for (const std::string& path : *context.named)
      if (std::find(paths.begin(), paths.end(), path) == paths.end()) scene->files.push_back(path);
    return std::make_shared<const Scene>(std::move(*scene));
  } catch (const std::bad_alloc&) {
    throw TemporaryError(ErrorCode::bad_input, paths.front(), "needs more memory than there is");
  }
}

}  // namespace

std::shared_ptr<const Scene> load_scene(const std::vector<std::string>& paths, const LoadOptions& options) {
  std::shared_ptr<const Scene> scene;
  with_threads(options.threads, [&] { scene = load_here(paths, options); });
  return scene;
}

}  // namespace kairos
