// The part of glTF's JSON schema that the reader relies on.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace kairos::gltf {

/// Throws Error(bad_input, "name: JSON path") for the first property of a wrong type. Whole numbers written as 3.0 are
/// turned into integers. tinygltf would pass over such properties, or over what holds them, in silence.
void check_schema(nlohmann::json& document, const std::string& name);

}  // namespace kairos::gltf
