// Any bytes as an OBJ file, as two keys of one mesh, and as a material library: loads or throws kairos::Error.
#include <kairos/error.h>

#include "scene_io/obj/materials.h"
#include "scene_io/obj/obj.h"
#include "scene_io/split_by_material.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const kairos::PolygonMesh mesh = kairos::parse_obj(text, "fuzz.obj");
    kairos::split_by_material(kairos::make_mesh_data({mesh, mesh}, false));
  } catch (const kairos::Error&) {
  }
  try {
    const size_t half = size / 2;
    kairos::make_mesh_data(
        {kairos::parse_obj(text.substr(0, half), "a.obj"), kairos::parse_obj(text.substr(half), "b.obj")}, true);
  } catch (const kairos::Error&) {
  }
  try {
    kairos::FileWarnings warnings(false);
    std::map<std::string, kairos::Material> materials;
    kairos::parse_mtl(text, "fuzz.mtl", warnings, materials);
  } catch (const kairos::Error&) {
  }
  return 0;
}
