#include "scene_io/gltf/extensions.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <kairos/error.h>
#include <kairos/printable.h>

#include "scene_io/gltf/text.h"

namespace kairos::gltf {

namespace {

constexpr std::array<std::string_view, 24> kRead = {"KHR_mesh_quantization",
                                                    "KHR_draco_mesh_compression",
                                                    "EXT_meshopt_compression",
                                                    "KHR_meshopt_compression",
                                                    "EXT_mesh_gpu_instancing",
                                                    "KHR_node_visibility",
                                                    "KHR_animation_pointer",
                                                    "KHR_lights_punctual",
                                                    "KHR_texture_transform",
                                                    "EXT_texture_webp",
                                                    "KHR_materials_emissive_strength",
                                                    "KHR_materials_ior",
                                                    "KHR_materials_transmission",
                                                    "KHR_materials_volume",
                                                    "KHR_materials_specular",
                                                    "KHR_materials_clearcoat",
                                                    "KHR_materials_unlit",
                                                    "KHR_materials_pbrSpecularGlossiness",
                                                    "KHR_materials_sheen",
                                                    "KHR_materials_iridescence",
                                                    "KHR_materials_anisotropy",
                                                    "KHR_materials_dispersion",
                                                    "KHR_materials_diffuse_transmission",
                                                    "KHR_materials_variants"};

// They only change how surfaces look, or carry notes: without them shapes are right.
constexpr std::array<std::string_view, 7> kForLooks = {
    "KHR_texture_basisu",  "EXT_texture_avif",     "MSFT_texture_dds", "KHR_materials_common",
    "KHR_technique_webgl", "KHR_techniques_webgl", "KHR_xmp_json_ld"};

template <size_t N>
bool contains(const std::array<std::string_view, N>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

void check_extensions(const std::vector<std::string>& required, const std::vector<std::string>& used,
                      const std::string& name, Warnings& warnings) {
  for (const std::string& extension : required)
    if (!contains(kRead, extension) && !contains(kForLooks, extension))
      throw Error(
          ErrorCode::bad_input, name + ": extensionsRequired",
          "the file needs the extension '" + printable(extension) + "', which is not supported; export it without");
  for (const std::string& extension : used)
    if (!contains(kRead, extension) && !contains(kForLooks, extension))
      warnings.add("extensionsUsed", "the extension '" + printable(extension) + "' is left out");
}

}  // namespace kairos::gltf
