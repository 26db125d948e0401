// Any bytes as an OBJ file, and as two keys of one mesh: loads or throws kairos::Error.
#include <kairos/error.h>

#include "scene_io/obj/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const kairos::PolygonMesh mesh = kairos::parse_obj(text, "fuzz.obj");
    kairos::make_mesh_data({mesh, mesh}, false);
  } catch (const kairos::Error&) {
  }
  try {
    const size_t half = size / 2;
    kairos::make_mesh_data(
        {kairos::parse_obj(text.substr(0, half), "a.obj"), kairos::parse_obj(text.substr(half), "b.obj")}, true);
  } catch (const kairos::Error&) {
  }
  return 0;
}
