// Any bytes as the picture of a small scene, through everything that a rendering does: load, look up, shade.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <kairos/error.h>
#include <kairos/render.h>

#include "scene_io/gltf/gltf.h"

namespace {

/// A triangle that shows the picture as its colour, its glow and where it is missing.
std::vector<uint8_t> around_picture(const uint8_t* data, size_t size) {
  const size_t room = (size + 3) / 4 * 4;
  std::string json = R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
    "materials": [{"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
                   "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1]}],
    "textures": [{"source": 0}], "images": [{"bufferView": 0, "mimeType": "image/png"}],
    "accessors": [{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
                  {"bufferView": 1, "byteOffset": 12, "componentType": 5126, "count": 3, "type": "VEC2"}],
    "bufferViews": [{"buffer": 0, "byteLength": )" +
                     std::to_string(size) + R"(}, {"buffer": 0, "byteLength": 36, "byteOffset": )" +
                     std::to_string(room) + R"(}], "buffers": [{"byteLength": )" + std::to_string(room + 36) + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<uint8_t> glb = {'g', 'l', 'T', 'F', 2, 0, 0, 0};
  const auto word = [&](size_t value) {
    for (int shift = 0; shift < 32; shift += 8) glb.push_back(static_cast<uint8_t>(value >> shift));
  };
  word(28 + json.size() + room + 36);
  word(json.size());
  word(0x4E4F534A);
  glb.insert(glb.end(), json.begin(), json.end());
  word(room + 36);
  word(0x004E4942);
  glb.insert(glb.end(), data, data + size);
  glb.resize(glb.size() + room - size);
  constexpr uint32_t kOne = 0x3f800000;
  for (const uint32_t number : {0u, 0u, 0u, kOne, 0u, 0u, 0u, kOne, 0u}) word(number);
  return glb;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr size_t kMostInput = 1 << 12;
  if (size > kMostInput) return 0;
  try {
    const std::vector<uint8_t> glb = around_picture(data, size);
    kairos::LoadOptions small;
    small.memory_budget = 1 << 26;
    kairos::Scene scene = kairos::parse_gltf(glb, "fuzz", "", small);
    scene.memory_budget = small.memory_budget;
    kairos::ShotOptions options;
    options.width = options.height = 4;
    options.threads = 1;
    const kairos::Shot shot = kairos::make_shot(scene, options);
    kairos::RenderParams params;
    params.shading = kairos::ShadingKind::flat;
    params.integrator = kairos::IntegratorKind::qmc;
    params.spp = 4;
    params.threads = 1;
    const kairos::Image image = kairos::render(shot, params);
    for (const kairos::Channel& channel : image.channels)
      for (const float value : channel.values)
        if (!(value - value == 0)) __builtin_trap();
  } catch (const kairos::Error&) {
  }
  return 0;
}
