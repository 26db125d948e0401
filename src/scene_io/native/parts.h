// The parts of a native scene file that stand by themselves: materials, lights, the camera, transforms.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene_io/json_node.h"
#include "scene_io/keyframes.h"

namespace kairos {

/// The path of a picture that a scene file names; empty for one that it may not read.
using FindPicture = std::function<std::string(const JsonNode& name)>;

Material read_material(const std::string& name, const JsonNode& node, const FindPicture& find_picture);
Light read_light(const JsonNode& node, const FindPicture& find_picture);
SceneCamera read_camera(const JsonNode& node);
/// One {matrix} or a list of {time, matrix}.
TransformKeys read_transform(const JsonNode& node);
/// The field `time` of each key, or spread evenly over [0, 1] where no key has one.
std::vector<double> read_key_times(const std::vector<JsonNode>& keys);
/// Throws where times do not ascend.
void expect_ascending(const std::vector<double>& times, const JsonNode& node);

}  // namespace kairos
