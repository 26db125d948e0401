// Any bytes as a native scene file in a folder with three small meshes and a scene to include: loads, and then every
// motion can be evaluated, or throws kairos::Error.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <kairos/error.h>

#include "scene_io/native/native.h"

namespace {

struct Folder {
  std::string path = std::filesystem::temp_directory_path() / "kairos_fuzz_XXXXXX";

  Folder() {
    if (!mkdtemp(path.data())) std::abort();
    const std::string triangle = "vn 0 0 1\nf 1//1 2//1 3//1\n";
    std::ofstream(path + "/a.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\n" << triangle;
    std::ofstream(path + "/b.obj") << "v 0 0 1\nv 1 0 1\nv 0 1 1\n" << triangle;
    std::ofstream(path + "/c.obj") << "v nan 0 1\nv 1 0 1\nv 0 1 1\n" << triangle;
    std::ofstream(path + "/d.json") << R"({"kairos": 1, "meshes": [{"keys": ["a.obj", "b.obj"]}]})";
  }
  ~Folder() {
    std::error_code ec;
    std::filesystem::remove_all(path, ec);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Folder folder;
  try {
    kairos::LoadContext context;
    context.budget = kairos::MemoryBudget(1 << 26);
    context.files_left = 20;
    const kairos::Scene scene = kairos::parse_native(std::string_view(reinterpret_cast<const char*>(data), size),
                                                     folder.path + "/fuzz.json", context);
    for (const double time : {-1.0, 0.3, 1.0}) {
      for (const kairos::SceneMesh& mesh : scene.meshes) {
        std::vector<kairos::Vec3d> positions(mesh.motion->vertex_count());
        std::vector<kairos::Vec3f> normals(positions.size());
        mesh.motion->positions(time, kairos::Side::after, positions);
        if (mesh.motion->has_normals()) mesh.motion->normals(time, kairos::Side::after, normals);
        for (const kairos::Triangle& triangle : mesh.triangles)
          for (const uint32_t v : triangle)
            if (!is_finite(positions.at(v))) std::abort();
      }
      for (const kairos::SceneCamera& camera : scene.cameras)
        if (!(std::abs(determinant3(camera.motion->at(time, kairos::Side::after)) - 1) < 1e-6)) std::abort();
    }
  } catch (const kairos::Error&) {
  }
  return 0;
}
