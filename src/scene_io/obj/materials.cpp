#include "scene_io/obj/materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <kairos/error.h>

#include "base/file.h"
#include "scene_io/obj/lines.h"
#include "scene_io/text_numbers.h"

namespace kairos {

namespace {

constexpr float kFarthest = 1e15f;   // beyond what float tells apart in a picture
constexpr float kBrightest = 1e30f;  // far above any light, far below float's overflow

/// A file that an OBJ or MTL file names, from its own folder; nothing, with a warning, where it may not be read or is
/// not there. Programs for Windows write backslashes.
std::optional<std::string> find_named(std::string name, const SceneFolder& folder, const FilePlace& place,
                                      FileWarnings& warnings) {
  std::replace(name.begin(), name.end(), '\\', '/');
  std::string problem;
  const std::string path = folder.try_resolve(name, problem);
  std::error_code ec;
  if (problem.empty() && std::filesystem::is_regular_file(path, ec)) return path;
  if (problem.empty()) problem = "'" + printable(name, 200) + "' is not there, or no file";
  warnings.add(place, problem + ": left out");
  return std::nullopt;
}

/// What a material's statements say, before it is known what they mean together.
struct Statements {
  Material material;
  std::optional<Vec3f> diffuse, specular, filter;
  float exponent = 0, opacity = 1;
  std::optional<float> roughness;
  int model = 2;  ///< illum: 0 and 1 have no highlights, 6 and 7 refract
  float ior = 1.5f;
  TextureRef opacity_picture;
};

bool is_black(Vec3f color) { return color.x == 0 && color.y == 0 && color.z == 0; }

Vec3f within_unit(Vec3f color) {
  return {std::clamp(color.x, 0.0f, 1.0f), std::clamp(color.y, 0.0f, 1.0f), std::clamp(color.z, 0.0f, 1.0f)};
}

/// Phong's exponent as glTF's roughness: a distribution of Blinn with that exponent is as wide as one of GGX whose
/// alpha is the root of 2 / (exponent + 2) (B. Walter et al. 2007), and alpha is the square of the roughness.
float roughness_of(float exponent) { return std::sqrt(std::sqrt(2 / (std::max(exponent, 0.0f) + 2))); }

Material make_material(const Statements& said) {
  Material material = said.material;
  const Vec3f diffuse = said.diffuse.value_or(material.base_color), specular = said.specular.value_or(Vec3f{});
  const bool has_picture = !material.base_color_texture.empty();
  material.base_color = within_unit(diffuse);
  // Exporters write a black Kd beside a picture that is meant to be seen.
  if (has_picture && (!said.diffuse || is_black(diffuse))) material.base_color = {1, 1, 1};
  const bool shines = said.model >= 2 && !is_black(specular);
  if (shines) material.roughness = roughness_of(said.exponent);
  if (shines && is_black(diffuse) && !has_picture) {  // nothing but reflection
    material.base_color = within_unit(specular);
    material.metallic = 1;
  }
  if (said.model == 6 || said.model == 7) {
    material.base_color = within_unit(said.filter.value_or(Vec3f{1, 1, 1}));
    material.metallic = 0;
    material.transmission = 1;
    material.ior = std::clamp(said.ior, 1.0f, 10.0f);
    if (!shines) material.roughness = 0;
  } else if (said.opacity < 1) {
    material.alpha = std::clamp(said.opacity, 0.0f, 1.0f);
    material.alpha_mode = Material::AlphaMode::blend;
  }
  if (said.roughness) material.roughness = std::clamp(*said.roughness, 0.0f, 1.0f);
  if (!said.opacity_picture.empty() && material.transmission == 0) {
    if (material.alpha_mode == Material::AlphaMode::opaque) material.alpha_mode = Material::AlphaMode::mask;
    // The same picture as the colour's holds opacity in its alpha.
    if (said.opacity_picture.picture != material.base_color_texture.picture)
      material.alpha_texture = said.opacity_picture;
  }
  return material;
}

class MtlParser {
 public:
  MtlParser(std::string_view text, const std::string& path, SceneFolder folder, FileWarnings& warnings,
            std::map<std::string, Material>& materials)
      : lines_(text), path_(path), folder_(std::move(folder)), warnings_(warnings), materials_(materials) {}

  void parse() {
    std::string_view whole;
    while (lines_.next(whole)) {
      std::string_view rest = whole;
      const std::string_view keyword = without_comment(take_token(rest));
      if (keyword.empty()) continue;
      if (keyword == "newmtl") {
        finish();
        said_.emplace();
        said_->material.name = printable(trimmed(rest));
        name_ = trimmed(rest);
      } else if (!said_) {
        warnings_.add(place(), "what stands before the first newmtl is left out");
      } else if (!number(keyword, without_comment(rest)) && !picture(keyword, rest)) {
        warnings_.add(place(), "statements '" + printable(keyword) + "' of materials are left out");
      }
    }
    finish();
  }

 private:
  FilePlace place() const { return {path_, lines_.number()}; }

  void finish() {
    if (said_) materials_[name_] = make_material(*said_);
    said_.reset();
  }

  float read_float(std::string_view& rest) const {
    const std::string_view token = take_token(rest);
    float value = 0;
    if (!parse_number(token, value) || !std::isfinite(value))
      fail_at(place(), "'" + printable(token) + "' is not a finite number");
    return std::clamp(value, -kBrightest, kBrightest);
  }

  /// r [g b]. Nothing, with a warning, for spectra.
  std::optional<Vec3f> read_color(std::string_view rest) {
    std::string_view ahead = rest;
    const std::string_view first = take_token(ahead);
    if (first == "spectral" || first == "xyz") {
      warnings_.add(place(), "colours as '" + printable(first) + "' are left out");
      return std::nullopt;
    }
    const float r = read_float(rest);
    if (trimmed(rest).empty()) return Vec3f{r, r, r};
    const float g = read_float(rest), b = read_float(rest);
    return Vec3f{r, g, b};
  }

  bool number(std::string_view keyword, std::string_view rest) {
    Statements& said = *said_;
    if (keyword == "Kd") {
      said.diffuse = read_color(rest);
    } else if (keyword == "Ks") {
      said.specular = read_color(rest);
    } else if (keyword == "Ke") {
      const Vec3f glow = read_color(rest).value_or(Vec3f{});
      said.material.emission = {std::max(glow.x, 0.0f), std::max(glow.y, 0.0f), std::max(glow.z, 0.0f)};
    } else if (keyword == "Tf") {
      said.filter = read_color(rest);
    } else if (keyword == "Ka" || keyword == "map_Ka") {
      // Light from all around, which Kairos has from the scene.
    } else if (keyword == "Ns") {
      said.exponent = read_float(rest);
    } else if (keyword == "Ni") {
      said.ior = read_float(rest);
    } else if (keyword == "d") {
      if (std::string_view ahead = rest; take_token(ahead) == "-halo") {
        warnings_.add(place(), "opacity that depends on the view (-halo) is taken as even");
        rest = ahead;
      }
      said.opacity = read_float(rest);
    } else if (keyword == "Tr") {
      said.opacity = 1 - read_float(rest);
    } else if (keyword == "illum") {
      said.model = static_cast<int>(std::clamp(read_float(rest), 0.0f, 100.0f));
    } else if (keyword == "Pr") {
      said.roughness = read_float(rest);
    } else if (keyword == "Pc") {
      said.material.clearcoat = std::clamp(read_float(rest), 0.0f, 1.0f);
    } else if (keyword == "Pcr") {
      said.material.clearcoat_roughness = std::clamp(read_float(rest), 0.0f, 1.0f);
    } else if (keyword == "Pm") {
      said.material.metallic = std::clamp(read_float(rest), 0.0f, 1.0f);
    } else {
      return false;
    }
    return true;
  }

  bool picture(std::string_view keyword, std::string_view rest) {
    const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
      return std::find(names.begin(), names.end(), keyword) != names.end();
    };
    if (!is_one_of({"map_Kd", "map_Ke", "map_d", "map_Pr", "map_Pm", "norm"})) return false;
    TextureRef texture = read_options(rest);
    const auto path = find_named(std::string(trimmed(rest)), folder_, place(), warnings_);
    if (!path) return true;
    Material& material = said_->material;
    texture.picture = *path;
    if (keyword == "map_Kd") {
      material.base_color_texture = texture;
    } else if (keyword == "map_d") {
      said_->opacity_picture = texture;
    } else if (keyword == "norm") {
      material.normal_texture = texture;
    } else if (keyword == "map_Ke") {
      material.emission_texture = texture;
      if (is_black(material.emission)) material.emission = {1, 1, 1};
    } else if (material.metallic_roughness_texture.empty() || material.metallic_roughness_texture.picture == *path) {
      // Roughness is read from green and metalness from blue; a grey picture has either in both.
      material.metallic_roughness_texture = texture;
      if (keyword == "map_Pm" && material.metallic == 0) material.metallic = 1;
    } else {
      warnings_.add(place(), "pictures of roughness and metalness that are not the same: the first counts");
    }
    return true;
  }

  /// Takes one to three numbers: the first two, where there are as many.
  void take_vector(std::string_view& rest, Vec2f& out) {
    float value = 0;
    for (int i = 0; i < 3; ++i) {
      std::string_view ahead = rest;
      if (!parse_number(take_token(ahead), value)) return;
      if (i < 2) (i == 0 ? out.x : out.y) = std::clamp(value, -kFarthest, kFarthest);
      rest = ahead;
    }
  }

  /// Takes "-option value ..." from the front of what is left of a line, and says where the picture lies.
  TextureRef read_options(std::string_view& rest) {
    TextureRef texture;
    texture.nearest = std::nullopt;
    Vec2f scale{1, 1}, offset{0, 0};
    const auto placed = [&] {
      // MTL counts from a picture's lower edge, we from the upper.
      texture.placement = {Vec3f{scale.x, 0, offset.x}, Vec3f{0, scale.y, 1 - scale.y - offset.y}};
      return texture;
    };
    for (;;) {
      std::string_view ahead = rest;
      const std::string_view option = take_token(ahead);
      if (option.size() < 2 || option.front() != '-') return placed();
      if (option == "-clamp") {
        if (take_token(ahead) == "on") texture.wrap = {TextureWrap::clamp, TextureWrap::clamp};
      } else if (option == "-s") {
        take_vector(ahead, scale);
      } else if (option == "-o") {
        take_vector(ahead, offset);
      } else if (option == "-blendu" || option == "-blendv") {
        take_token(ahead);  // how the picture is filtered is the renderer's business
      } else if (option == "-t" || option == "-mm") {
        Vec2f value;
        take_vector(ahead, value);
        warnings_.add(place(), "the option '" + printable(option) + "' of pictures is left out");
      } else if (option == "-bm" || option == "-boost" || option == "-texres" || option == "-imfchan" ||
                 option == "-cc" || option == "-type") {
        take_token(ahead);
        warnings_.add(place(), "the option '" + printable(option) + "' of pictures is left out");
      } else {
        return placed();  // a file may be called so
      }
      rest = ahead;
    }
  }

  Lines lines_;
  const std::string& path_;
  const SceneFolder folder_;
  FileWarnings& warnings_;
  std::map<std::string, Material>& materials_;
  std::optional<Statements> said_;
  std::string name_;
};

/// Several names stand on a line, and a name may hold spaces: who finds the whole as a file takes it so.
std::vector<std::string> split_names(const std::string& line, const std::string& folder) {
  std::error_code ec;
  if (std::filesystem::is_regular_file(std::filesystem::path(folder) / line, ec)) return {line};
  std::vector<std::string> names;
  std::string_view rest = line;
  for (std::string_view name = take_token(rest); !name.empty(); name = take_token(rest)) names.emplace_back(name);
  return names;
}

}  // namespace

void parse_mtl(std::string_view text, const std::string& path, FileWarnings& warnings,
               std::map<std::string, Material>& materials, const SceneFolder& from) {
  MtlParser(text, path, from.beside(path), warnings, materials).parse();
}

std::vector<Material> read_obj_materials(const std::string& obj_path, const SceneFolder& folder,
                                         const std::vector<std::string>& libraries,
                                         const std::vector<std::string>& names, FileWarnings& warnings) {
  constexpr uint64_t kMaxFileSize = 64 << 20;
  const FilePlace place{obj_path, 0};
  std::map<std::string, Material> defined;
  for (const std::string& line : libraries)
    for (const std::string& name : split_names(line, folder.path))
      if (const auto path = find_named(name, folder, place, warnings)) {
        const std::vector<uint8_t> bytes = read_file(*path, kMaxFileSize);
        parse_mtl({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, *path, warnings, defined, folder);
      }
  std::vector<Material> materials;
  for (const std::string& name : names) {
    const auto found = defined.find(name);
    if (found == defined.end() && !name.empty())
      warnings.add(place, "no material '" + printable(name) + "' is defined: it is grey");
    materials.push_back(found == defined.end() ? Material{} : found->second);
    if (found == defined.end()) materials.back().name = printable(name);
  }
  return materials;
}

}  // namespace kairos
