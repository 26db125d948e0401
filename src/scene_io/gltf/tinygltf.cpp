#include <fstream>  // which its writer wants also without files

#define TINYGLTF_IMPLEMENTATION
#include "scene_io/gltf/tinygltf.h"
