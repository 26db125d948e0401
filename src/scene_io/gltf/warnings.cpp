#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "scene_io/gltf/document.h"

namespace kairos::gltf {

namespace {

// What the reader understands.
constexpr std::array<std::string_view, 9> kSupported = {
    "KHR_mesh_quantization", "KHR_draco_mesh_compression", "KHR_materials_emissive_strength",
    "KHR_materials_ior",     "KHR_materials_transmission", "KHR_lights_punctual",
    "KHR_texture_transform", "KHR_materials_unlit",        "KHR_materials_pbrSpecularGlossiness"};

// What only changes how surfaces look, or carries notes: the shapes are right without it.
constexpr std::array<std::string_view, 17> kIgnorable = {
    "KHR_texture_basisu",       "KHR_materials_clearcoat",  "KHR_materials_sheen",
    "KHR_materials_specular",   "KHR_materials_volume",     "KHR_materials_iridescence",
    "KHR_materials_anisotropy", "KHR_materials_dispersion", "KHR_materials_diffuse_transmission",
    "KHR_materials_variants",   "KHR_materials_common",     "KHR_technique_webgl",
    "KHR_techniques_webgl",     "KHR_xmp_json_ld",          "EXT_texture_webp",
    "EXT_texture_avif",         "MSFT_texture_dds"};

template <size_t N>
bool contains(const std::array<std::string_view, N>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

void Warnings::add(const std::string& where, const std::string& what, uint64_t count) {
  if (strict_) throw Error(ErrorCode::bad_input, file_ + ": " + where, what);
  Entry& entry = entries_[what];
  if (entry.count == 0) {
    entry.where = where;
    order_.push_back(what);
  }
  entry.count += count;
}

std::vector<std::string> Warnings::lines() const {
  std::vector<std::string> result;
  for (const std::string& what : order_) {
    const Entry& entry = entries_.at(what);
    result.push_back(fmt::format("{}: {}: {}", file_, entry.where, what) +
                     (entry.count > 1 ? fmt::format(" ({} times)", entry.count) : ""));
  }
  return result;
}

void check_extensions(const Document& document, Warnings& warnings) {
  for (const std::string& extension : document.model.extensionsRequired)
    if (!contains(kSupported, extension) && !contains(kIgnorable, extension))
      document.fail("extensionsRequired", "the file needs the extension '" + printable(extension) +
                                              "', which is not supported; export it without");
  for (const std::string& extension : document.model.extensionsUsed)
    if (!contains(kSupported, extension))
      warnings.add("extensionsUsed", "the extension '" + printable(extension) + "' is left out");
}

}  // namespace kairos::gltf
