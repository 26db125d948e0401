#include "scene_io/gltf/instances.h"

#include <optional>

#include <fmt/format.h>

#include <kairos/printable.h>

#include "scene_io/gltf/accessor.h"

namespace kairos::gltf {

std::vector<Mat4> read_instances(Document& document, const std::map<std::string, int>& attributes,
                                 const std::string& where, Warnings& warnings) {
  std::optional<uint64_t> count;
  const auto floats = [&](const char* name, int components) -> std::vector<float> {
    const auto found = attributes.find(name);
    return found == attributes.end() ? std::vector<float>{}
                                     : read_floats(document, found->second, components, where + "." + name);
  };
  for (const auto& [name, accessor] : attributes) {
    const uint64_t here = get_accessor(document, accessor, where + "." + printable(name)).count;
    if (count && *count != here)
      document.fail(where, fmt::format("its attributes have {} and {} elements", *count, here));
    count = here;
    const bool is_known = name == "TRANSLATION" || name == "ROTATION" || name == "SCALE";
    if (!is_known && !name.starts_with("_"))
      warnings.add(where, "the attribute '" + printable(name) + "' of instances is left out");
  }
  const std::vector<float> t = floats("TRANSLATION", 3), r = floats("ROTATION", 4), s = floats("SCALE", 3);
  const auto vector = [](const std::vector<float>& flat, size_t i) {
    return Vec3d{flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
  };
  document.charge(count.value_or(0) * sizeof(Mat4), where);
  std::vector<Mat4> places(count.value_or(0));
  for (size_t i = 0; i < places.size(); ++i) {
    if (!t.empty()) places[i] = translation(vector(t, i));
    if (!r.empty())
      places[i] = places[i] * rotation(normalize(Quaternion{r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]}));
    if (!s.empty()) places[i] = places[i] * scaling(vector(s, i));
  }
  return places;
}

}  // namespace kairos::gltf
