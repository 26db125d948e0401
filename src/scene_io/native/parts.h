// The parts of a native scene file that stand by themselves: materials, lights, the camera, transforms.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene_io/json_node.h"
#include "scene_io/keyframes.h"

namespace kairos {

/// `folder` is the scene file's: textures lie in it.
Material read_material(const std::string& name, const JsonNode& node, const std::string& folder);
Light read_light(const JsonNode& node, const std::string& folder);
SceneCamera read_camera(const JsonNode& node);
/// One {matrix} or a list of {time, matrix}.
TransformKeys read_transform(const JsonNode& node);
/// The field `time` of each key, or spread evenly over [0, 1] where no key has one.
std::vector<double> read_key_times(const std::vector<JsonNode>& keys);
/// Throws where times do not ascend.
void expect_ascending(const std::vector<double>& times, const JsonNode& node);

}  // namespace kairos
