// Any bytes as a PLY file: loads or throws kairos::Error.
#include <kairos/error.h>

#include "scene_io/ply/ply.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const std::string_view file(reinterpret_cast<const char*>(data), size);
    kairos::make_mesh_data({kairos::parse_ply(file, "fuzz.ply")}, false);
  } catch (const kairos::Error&) {
  }
  return 0;
}
