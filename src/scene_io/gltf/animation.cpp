// Which animation plays, and its channels as tracks on nodes.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include <kairos/printable.h>

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

std::shared_ptr<const Track> read_track(Document& document, const file::AnimationSampler& sampler, bool is_rotation,
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

/// "/nodes/N/extensions/...": of what kind a pointer's target is.
std::string without_indices(const std::string& pointer) {
  std::string result;
  for (size_t i = 0; i < pointer.size(); ++i) {
    const bool is_digit = pointer[i] >= '0' && pointer[i] <= '9';
    if (!is_digit)
      result += pointer[i];
    else if (result.back() != 'N' || pointer[i - 1] == 'N')
      result += 'N';
  }
  return result;
}

/// A pointer to a node's own motion says what a plain target does; null for any other.
std::optional<file::Channel> as_plain(const file::Channel& channel) {
  const std::string& pointer = channel.target_path;
  constexpr std::string_view kNodes = "/nodes/";
  if (!pointer.starts_with(kNodes)) return std::nullopt;
  file::Channel plain = channel;
  const char *begin = pointer.data() + kNodes.size(), *end = pointer.data() + pointer.size();
  const auto [stop, failure] = std::from_chars(begin, end, plain.target_node);
  if (failure != std::errc() || stop == end || *stop != '/') return std::nullopt;
  plain.target_path.assign(stop + 1, end);
  for (const char* known : {"translation", "rotation", "scale", "weights"})
    if (plain.target_path == known) return plain;
  return std::nullopt;
}

void read_channel(Document& document, const file::Animation& animation, const file::Channel& channel,
                  const std::string& where, NodeGraph& graph, Warnings& warnings) {
  if (channel.target_path.starts_with("/"))
    return warnings.add(where,
                        "the animation of '" + printable(without_indices(channel.target_path)) + "' is left out");
  if (channel.target_node < 0) return warnings.add(where, "an animation of nothing is left out");
  if (static_cast<size_t>(channel.target_node) >= graph.nodes.size())
    document.fail(where, fmt::format("names node {}, but there are {}", channel.target_node, graph.nodes.size()));
  if (channel.sampler < 0 || static_cast<size_t>(channel.sampler) >= animation.samplers.size())
    document.fail(where, fmt::format("names sampler {}, but there are {}", channel.sampler, animation.samplers.size()));
  const file::AnimationSampler& sampler = animation.samplers[static_cast<size_t>(channel.sampler)];
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
  if (*slot) return warnings.add(where, "what several animations move goes as the first of them says");
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

namespace {

/// From the file's own bounds of its key times; nothing where it has none.
std::optional<std::array<double, 2>> range_of(const Document& document, const file::Animation& animation) {
  std::optional<std::array<double, 2>> range;
  for (const file::AnimationSampler& sampler : animation.samplers) {
    const auto& accessors = document.model.accessors;
    if (sampler.input < 0 || static_cast<size_t>(sampler.input) >= accessors.size()) continue;
    const file::Accessor& times = accessors[static_cast<size_t>(sampler.input)];
    if (times.min.size() != 1 || times.max.size() != 1) continue;
    if (!range) range = {times.min[0], times.max[0]};
    (*range)[0] = std::min((*range)[0], times.min[0]);
    (*range)[1] = std::max((*range)[1], times.max[0]);
  }
  return range;
}

/// [animation]: does it play?
std::vector<bool> chosen(const Document& document, const std::string& wanted) {
  const auto& animations = document.model.animations;
  std::vector<std::string> names;
  names.reserve(animations.size());
  for (const file::Animation& animation : animations) names.push_back(animation.name);
  const int index = wanted.empty() && !animations.empty() ? 0 : find_by_name_or_index(names, wanted);
  std::vector<bool> plays(animations.size(), index < 0 && wanted == "all");
  if (index >= 0) plays[static_cast<size_t>(index)] = true;
  if (index < 0 && !wanted.empty() && wanted != "none" && wanted != "all")
    throw Error(
        ErrorCode::bad_usage, document.name,
        "has no animation '" + printable(wanted) + "'; it has: " + listed(names) + " (or give 'all' or 'none')");
  return plays;
}

}  // namespace

void play_animations(Document& document, const std::string& wanted, NodeGraph& graph, Scene& scene,
                     Warnings& warnings) {
  const auto& animations = document.model.animations;
  const std::vector<bool> plays = chosen(document, wanted);
  std::vector<std::string> resting;
  for (size_t a = 0; a < animations.size(); ++a) {
    const file::Animation& animation = animations[a];
    scene.animations.push_back({printable(animation.name), range_of(document, animation), plays[a]});
    if (!plays[a]) {
      resting.push_back(animation.name);
      continue;
    }
    for (size_t i = 0; i < animation.channels.size(); ++i) {
      const file::Channel& channel = animation.channels[i];
      read_channel(document, animation, as_plain(channel).value_or(channel),
                   at("animations", a) + "." + at("channels", i), graph, warnings);
    }
  }
  if (wanted.empty() && !resting.empty())
    scene.notes.push_back(fmt::format("{}: of {} animations the first plays; not {} (--animation chooses one, or all)",
                                      document.name, animations.size(), listed(resting)));
}

}  // namespace kairos::gltf
