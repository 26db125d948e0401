// From file names to a scene, whatever the format.
#pragma once

#include <string>
#include <vector>

#include "base/file.h"
#include "base/memory_budget.h"
#include "scene/scene.h"
#include "scene_io/split_by_material.h"

namespace kairos {

/// What a tree of files that include each other has used up so far.
struct LoadContext {
  LoadOptions options;
  std::vector<std::string> open_files;  ///< the scene files that lead to the one being read, outermost first
  int files_left = 100000;              ///< how many more may be read: two files that include each other twice ...
  std::string root;                     ///< see LoadOptions::root; of the file that was given, where that says nothing
  MemoryBudget budget{LoadOptions{}.memory_budget};
  /// What names in files stand for: SceneFolder::named.
  std::shared_ptr<std::set<std::string>> named = std::make_shared<std::set<std::string>>();

  LoadContext() = default;
  explicit LoadContext(const LoadOptions& wanted) : options(wanted), root(wanted.root), budget(wanted.memory_budget) {}

  /// Where names lead that stand in the file at `path`.
  SceneFolder folder_of(const std::string& path) const { return {parent_folder(path), root, named}; }

  /// Counts a file. Throws Error(bad_input, place) when too many were read.
  void count_file(const std::string& place);
};

/// The format by the name's extension, in any case. Throws Error(bad_input) for an unknown one.
enum class FileFormat { obj, ply, gltf, native, pbrt };
FileFormat format_of(const std::string& path);
/// OBJ and PLY hold a mesh, other formats scenes.
bool is_mesh_file(const std::string& path);

/// What a mesh file holds: triangles of one material each.
struct MeshFile {
  std::vector<MaterialPart> parts;
  std::vector<Material> materials;    ///< that parts refer to; empty: the file says nothing of materials
  std::vector<std::string> warnings;  ///< one line each
};

/// Reads OBJ or PLY files as the motion keys of one mesh; materials are the first one's. Texture coordinates count from
/// a picture's upper edge. Throws Error(bad_input) or Error(io). with_materials: otherwise all is one part.
MeshFile load_mesh_file(const std::vector<std::string>& paths, bool with_materials, LoadContext& context);

/// Moves triangles, their numbers and what lies on their vertices.
void take_surface(SceneMesh& mesh, MeshData& data);

/// times[key] for keys spread evenly over 0 to 1.
std::vector<double> even_times(size_t keys);

/// Reads one file of any format into a scene of its own.
Scene load_file(const std::string& path, LoadContext& context);

/// Puts `other` into `scene`: materials are appended and indices follow; what `scene` has of a shutter, an image size
/// or a background (other than black) stays.
void append_scene(Scene& scene, Scene other);

/// Adds ".1", ".2", ... to the names of meshes, and of cameras, that came before.
void make_names_unique(Scene& scene);

}  // namespace kairos
