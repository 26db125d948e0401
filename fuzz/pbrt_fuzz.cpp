// Any bytes as a pbrt scene file in a folder with a mesh, a file to include and an image: loads, and then every motion
// can be evaluated, or throws kairos::Error. Bytes that begin as gzip does are unpacked too.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <kairos/error.h>

#include "scene_io/pbrt/gzip.h"
#include "scene_io/pbrt/pbrt.h"

namespace {

struct Folder {
  std::string path = std::filesystem::temp_directory_path() / "kairos_fuzz_XXXXXX";

  Folder() {
    if (!mkdtemp(path.data())) std::abort();
    std::ofstream(path + "/m.ply")
        << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n";
    std::ofstream(path + "/i.pbrt") << "Shape \"plymesh\" \"string filename\" \"m.ply\"\n";
    std::ofstream(path + "/r.pbrt") << "Include \"r.pbrt\"\n";
    std::ofstream(path + "/a.png") << "no image";
  }
  ~Folder() {
    std::error_code ec;
    std::filesystem::remove_all(path, ec);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Folder folder;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    if (size > 1 && data[0] == 0x1f && data[1] == 0x8b) {
      constexpr uint64_t kLimit = 1 << 20;
      if (kairos::pbrt::gunzip(text, kLimit, "fuzz.gz").size() > kLimit) std::abort();
      return 0;
    }
    constexpr uint64_t kMaxTriangles = 1 << 14;
    kairos::LoadContext context;
    context.budget = kairos::MemoryBudget(1 << 26);
    context.files_left = 20;
    const kairos::Scene scene = kairos::parse_pbrt(text, folder.path + "/fuzz.pbrt", context, kMaxTriangles);
    if (scene.materials.empty()) std::abort();
    for (const kairos::SceneMesh& mesh : scene.meshes) {
      if (mesh.material >= scene.materials.size()) std::abort();
      const size_t vertices = mesh.motion->vertex_count();
      if (!mesh.uvs.empty() && mesh.uvs.size() != vertices) std::abort();
      for (const kairos::Triangle& triangle : mesh.triangles)
        for (const uint32_t v : triangle)
          if (v >= vertices) std::abort();
    }
    for (const double time : {-1.0, 0.3, 1.0}) {
      constexpr size_t kEnough = 8;
      for (size_t i = 0; i < scene.meshes.size() && i < kEnough; ++i) {
        const kairos::VertexMotion& motion = *scene.meshes[i].motion;
        std::vector<kairos::Vec3d> positions(motion.vertex_count());
        std::vector<kairos::Vec3f> normals(positions.size());
        motion.positions(time, kairos::Side::after, positions);
        if (motion.has_normals()) motion.normals(time, kairos::Side::after, normals);
        for (const kairos::Vec3f& n : normals)
          if (!is_finite(n)) std::abort();
      }
      for (const kairos::SceneCamera& camera : scene.cameras) camera.motion->at(time, kairos::Side::after);
    }
    if (!((*scene.shutter)[0] <= (*scene.shutter)[1])) std::abort();  // equal: a still frame
    for (const kairos::Material& material : scene.materials)
      if (!is_finite(material.base_color) || !is_finite(material.emission) || !(material.roughness <= 1)) std::abort();
  } catch (const kairos::Error&) {
  }
  return 0;
}
