// Numbers out of accessors: bounds, strides, sparse replacements and normalisation are dealt with here, and only here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene_io/gltf/document.h"

namespace kairos::gltf {

/// The accessor, or Error: `user` ("skins[0].inverseBindMatrices") names one that does not exist.
const file::Accessor& get_accessor(const Document& document, int index, const std::string& user);

/// [element][component] flattened. Integers become floats, in [0, 1] or [-1, 1] where the accessor says normalized.
/// Throws Error unless elements have `components` (1 to 4, or 16 for a 4x4 matrix) and all of their bytes exist.
std::vector<float> read_floats(Document& document, int accessor, int components, const std::string& user);

/// The same for unsigned integers of any width; floats are an error.
std::vector<uint32_t> read_integers(Document& document, int accessor, int components, const std::string& user);

/// Whole components of glTF's component type `type` as a number; `normalized` as above.
double component_value(const uint8_t* bytes, int type, bool normalized);

/// Bytes in a component, or 0 for a type that glTF does not know.
uint64_t component_size(int type);

}  // namespace kairos::gltf
