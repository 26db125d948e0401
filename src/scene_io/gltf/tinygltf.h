// tinygltf, compiled in under a name of its own and without access to files or images.
//
// Not the shared library: Debian's libdraco exports a second, differently built copy of tinygltf under the same names,
// so that which of the two a program gets, and whether it crashes, would hang on the order in which it links.
#pragma once

#define TINYGLTF_NO_FS
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define tinygltf kairos_tinygltf
#include <tiny_gltf.h>
