// Which animation plays, and its channels as tracks on nodes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "scene_io/gltf/accessor.h"
#include "scene_io/gltf/nodes.h"

namespace kairos::gltf {

namespace {

std::optional<Interpolation> interpolation_named(const std::string& name) {
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic;
  return std::nullopt;
}

std::vector<double> finite_doubles(const Document& document, const std::vector<float>& values,
                                   const std::string& where) {
  for (float v : values)
    if (!std::isfinite(v)) document.fail(where, "holds a number that is not finite");
  return {values.begin(), values.end()};
}

/// Morph targets of a node's mesh.
size_t target_count(const Document& document, int node) {
  const int mesh = document.model.nodes[static_cast<size_t>(node)].mesh;
  size_t count = 0;
  if (mesh >= 0 && static_cast<size_t>(mesh) < document.model.meshes.size())
    for (const auto& primitive : document.model.meshes[static_cast<size_t>(mesh)].primitives)
      count = std::max(count, primitive.targets.size());
  return count;
}

std::shared_ptr<const Track> read_track(Document& document, const tinygltf::AnimationSampler& sampler, bool is_rotation,
                                        int components, size_t width, const std::string& where) {
  const auto interpolation = interpolation_named(sampler.interpolation);
  if (!interpolation) document.fail(where, "has the unknown interpolation '" + printable(sampler.interpolation) + "'");
  std::vector<double> times =
      finite_doubles(document, read_floats(document, sampler.input, 1, where + ".input"), where + ".input");
  if (times.empty()) document.fail(where + ".input", "has no key");
  if (!std::is_sorted(times.begin(), times.end())) document.fail(where + ".input", "its times do not ascend");
  std::vector<double> values =
      finite_doubles(document, read_floats(document, sampler.output, components, where + ".output"), where + ".output");
  const size_t expected = times.size() * width * (interpolation == Interpolation::cubic ? 3 : 1);
  if (values.size() != expected)
    document.fail(where + ".output",
                  fmt::format("has {} numbers, but {} keys need {}", values.size(), times.size(), expected));
  document.charge((times.size() + values.size()) * sizeof(double), where);
  return std::make_shared<const Track>(*interpolation, is_rotation, width, std::move(times), std::move(values));
}

void read_channel(Document& document, const tinygltf::Animation& animation, const tinygltf::AnimationChannel& channel,
                  const std::string& where, NodeGraph& graph, Warnings& warnings) {
  if (channel.target_node < 0) return;  // what an unknown extension animates
  if (static_cast<size_t>(channel.target_node) >= graph.nodes.size())
    document.fail(where, fmt::format("names node {}, but there are {}", channel.target_node, graph.nodes.size()));
  if (channel.sampler < 0 || static_cast<size_t>(channel.sampler) >= animation.samplers.size())
    document.fail(where, fmt::format("names sampler {}, but there are {}", channel.sampler, animation.samplers.size()));
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>(channel.sampler)];
  Node& node = graph.nodes[static_cast<size_t>(channel.target_node)];

  std::shared_ptr<const Track>* slot = nullptr;
  int components = 3;
  size_t width = 3;
  const bool is_rotation = channel.target_path == "rotation", is_weights = channel.target_path == "weights";
  if (channel.target_path == "translation") slot = &node.moving_translation;
  if (channel.target_path == "scale") slot = &node.moving_scale;
  if (is_rotation) {
    slot = &node.moving_rotation;
    components = 4;
    width = 4;
  }
  if (is_weights) {
    slot = &node.moving_weights;
    components = 1;
    width = target_count(document, channel.target_node);
    if (width == 0) return warnings.add(where, "weights of a node without morph targets are left out");
  }
  if (!slot) return warnings.add(where, "animation of '" + printable(channel.target_path) + "' is left out");
  if (node.has_matrix && !is_weights) return warnings.add(where, "animation of a node with a matrix is left out");
  if (*slot) return warnings.add(where, "a second animation of the same property is left out");
  *slot = read_track(document, sampler, is_rotation, components, width, where);
}

}  // namespace

int find_by_name_or_index(const std::vector<std::string>& names, const std::string& wanted) {
  if (const auto found = std::find(names.begin(), names.end(), wanted); found != names.end())
    return static_cast<int>(found - names.begin());
  constexpr size_t kMostDigits = 9;
  const bool is_number = !wanted.empty() && wanted.size() <= kMostDigits &&
                         std::all_of(wanted.begin(), wanted.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return -1;
  const int index = std::stoi(wanted);
  return static_cast<size_t>(index) < names.size() ? index : -1;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr size_t kMost = 100;
  std::string result;
  for (size_t i = 0; i < std::min(names.size(), kMost); ++i)
    result += (i == 0 ? "'" : ", '") + printable(names[i]) + "'";
  return names.empty() ? "none" : names.size() > kMost ? result + ", ..." : result;
}

void play_animation(Document& document, const std::string& wanted, NodeGraph& graph, Warnings& warnings) {
  const auto& animations = document.model.animations;
  if (wanted == "none" || (wanted.empty() && animations.empty())) return;
  std::vector<std::string> names;
  names.reserve(animations.size());
  for (const auto& animation : animations) names.push_back(animation.name);
  const int index = wanted.empty() ? 0 : find_by_name_or_index(names, wanted);
  if (index < 0)
    throw Error(ErrorCode::bad_usage, document.name,
                "has no animation '" + printable(wanted) + "'; it has: " + listed(names) + " (or give 'none')");
  const tinygltf::Animation& animation = animations[static_cast<size_t>(index)];
  for (size_t i = 0; i < animation.channels.size(); ++i)
    read_channel(document, animation, animation.channels[i],
                 at("animations", static_cast<size_t>(index)) + "." + at("channels", i), graph, warnings);
}

}  // namespace kairos::gltf
