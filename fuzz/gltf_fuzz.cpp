// Any bytes at all as a glTF or GLB file, or as the Draco data in one: a scene or an Error, nothing else.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <kairos/error.h>

#include "scene_io/gltf/gltf.h"

namespace {

/// A GLB of this JSON and these bytes.
std::vector<uint8_t> glb_of(const std::string& json, std::span<const uint8_t> bytes) {
  std::vector<uint8_t> glb = {'g', 'l', 'T', 'F', 2, 0, 0, 0};
  const auto word = [&](size_t value) {
    for (int shift = 0; shift < 32; shift += 8) glb.push_back(static_cast<uint8_t>(value >> shift));
  };
  word(28 + json.size() + bytes.size());
  word(json.size());
  word(0x4E4F534A);
  glb.insert(glb.end(), json.begin(), json.end());
  word(bytes.size());
  word(0x004E4942);
  glb.insert(glb.end(), bytes.begin(), bytes.end());
  return glb;
}

/// A GLB whose one mesh is these bytes of Draco: what random changes to a whole file hardly ever get to.
std::vector<uint8_t> around_draco(std::span<const uint8_t> draco) {
  const std::string size = std::to_string(draco.size());
  return glb_of(R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{
    "attributes": {"POSITION": 0}, "indices": 1, "extensions": {"KHR_draco_mesh_compression":
    {"bufferView": 0, "attributes": {"POSITION": 0}}}}]}],
    "accessors": [{"componentType": 5126, "count": 4, "type": "VEC3"},
                  {"componentType": 5121, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": )" +
                    size + R"(}], "buffers": [{"byteLength": )" + size + "}]}",
                draco);
}

// Streams of meshoptimizer begin with one of these, and a version.
constexpr uint8_t kVertices = 0xa0, kTriangles = 0xe0, kSequence = 0xd0;

/// The same with a stream of meshoptimizer: as positions under a filter, or as their indices.
std::vector<uint8_t> around_meshopt(std::span<const uint8_t> stream) {
  const uint8_t kind = stream[0] & 0xf0;
  const bool is_vertices = kind == kVertices;
  const std::string size = std::to_string(stream.size());
  const std::string mode = is_vertices ? "ATTRIBUTES" : kind == kTriangles ? "TRIANGLES" : "INDICES";
  const std::string filter = is_vertices && stream.size() % 2 != 0 ? "EXPONENTIAL" : "NONE";
  const std::string packed = R"("extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteLength": )" + size +
                             R"(, "byteStride": )" + (is_vertices ? "12" : "4") + R"(, "count": )" +
                             (is_vertices ? "64" : "96") + R"(, "mode": ")" + mode + R"(", "filter": ")" + filter +
                             R"("}})";
  const std::string plain = R"({"componentType": 5126, "count": 64, "type": "VEC3")";
  return glb_of(R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{
    "attributes": {"POSITION": 0})" +
                    std::string(is_vertices ? "" : R"(, "indices": 1)") + R"(}]}], "accessors": [)" + plain +
                    (is_vertices ? R"(, "bufferView": 0)" : "") +
                    R"(}, {"componentType": 5125, "count": 96, "type": "SCALAR", "bufferView": 0}],
    "bufferViews": [{"buffer": 0, "byteLength": 768, )" +
                    packed + R"(}], "buffers": [{"byteLength": )" + size + "}]}",
                stream);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr size_t kMaxInput = 1 << 16, kMaxVertices = 1 << 16;
  if (size > kMaxInput) return 0;
  std::vector<uint8_t> wrapped;
  std::span<const uint8_t> file(data, size);
  if (size >= 5 && std::memcmp(data, "DRACO", 5) == 0) file = wrapped = around_draco(file);
  kairos::LoadOptions options;
  options.memory_budget = 1 << 26;
  if (size >= 1 && (data[0] & 0xf0) >= kVertices && (data[0] & 0x0f) <= 1) {
    const uint8_t kind = data[0] & 0xf0;
    if (kind == kVertices || kind == kTriangles || kind == kSequence) file = wrapped = around_meshopt(file);
  }
  try {
    const kairos::Scene scene = kairos::parse_gltf(file, "fuzz", "", options);
    size_t vertices = 0;  // evaluated so far: instances of one mesh would only repeat it
    for (const kairos::SceneMesh& mesh : scene.meshes) {
      const kairos::VertexMotion& motion = *mesh.motion;
      if ((vertices += motion.vertex_count()) > kMaxVertices) break;
      for (const kairos::Triangle& triangle : mesh.triangles)
        for (uint32_t v : triangle)
          if (v >= motion.vertex_count()) __builtin_trap();
      motion.kinks(0, 1);
      motion.is_static(0, 1);
      motion.is_linear_between_kinks();
      std::vector<kairos::Vec3d> positions(motion.vertex_count());
      std::vector<kairos::Vec3f> normals(motion.vertex_count());
      std::vector<kairos::Vec4f> tangents(motion.vertex_count());
      for (const double time : {0.0, 0.6}) {
        motion.positions(time, kairos::Side::before, positions);
        if (motion.has_normals()) motion.normals(time, kairos::Side::after, normals);
        if (motion.has_tangents()) motion.tangents(time, kairos::Side::after, tangents);
      }
    }
    for (const kairos::SceneCamera& camera : scene.cameras) camera.motion->at(0.5, kairos::Side::after);
  } catch (const kairos::Error&) {
  }
  return 0;
}
