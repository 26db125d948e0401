#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "scene_io/gltf/accessor.h"
#include "scene_io/gltf/motion.h"

namespace kairos::gltf {

std::vector<Mat4> Skin::joint_matrices(const NodeGraph& graph, double time, Side side) const {
  std::vector<Mat4> world(placed.size());
  for (size_t i = 0; i < placed.size(); ++i) {
    const Mat4 local = graph.nodes[static_cast<size_t>(placed[i].node)].at(time, side);
    world[i] = placed[i].parent < 0 ? local : world[static_cast<size_t>(placed[i].parent)] * local;
  }
  std::vector<Mat4> result(joints.size());
  for (size_t j = 0; j < joints.size(); ++j) result[j] = world[joints[j]] * inverse_bind[j];
  return result;
}

Mat4 Skin::first_joint_at_rest(const NodeGraph& graph) const {
  return graph.world_at_rest(placed[joints[0]].node) * inverse_bind[0];
}

Skin read_skin(Document& document, size_t index, const NodeGraph& graph) {
  const file::Skin& source = document.model.skins[index];
  const std::string where = at("skins", index);
  if (source.joints.empty()) document.fail(where, "has no joints");
  Skin skin;
  std::unordered_map<int, int> entry_of;  // node -> its entry
  for (int joint : source.joints) {
    if (joint < 0 || static_cast<size_t>(joint) >= graph.nodes.size())
      document.fail(where, fmt::format("names node {}, but there are {}", joint, graph.nodes.size()));
    std::vector<int> path;  // from the joint up to what has an entry already
    int node = joint;
    for (; node >= 0 && !entry_of.count(node); node = graph.nodes[static_cast<size_t>(node)].parent)
      path.push_back(node);
    document.charge((path.size() + 1) * (sizeof(Skin::Placed) + sizeof(Mat4)), where);
    int parent = node < 0 ? -1 : entry_of.at(node);
    for (auto step = path.rbegin(); step != path.rend(); ++step) {
      const int entry = static_cast<int>(skin.placed.size());
      skin.placed.push_back({*step, parent});
      entry_of[*step] = entry;
      parent = entry;
    }
    skin.joints.push_back(static_cast<uint32_t>(entry_of.at(joint)));
  }
  skin.inverse_bind.resize(skin.joints.size());
  if (source.inverseBindMatrices < 0) return skin;
  const std::vector<float> values =
      read_floats(document, source.inverseBindMatrices, 16, where + ".inverseBindMatrices");
  if (values.size() < skin.joints.size() * 16)
    document.fail(where,
                  fmt::format("has {} joints but {} inverse bind matrices", skin.joints.size(), values.size() / 16));
  for (size_t j = 0; j < skin.joints.size(); ++j)
    for (size_t i = 0; i < 16; ++i) {
      const float value = values[16 * j + i];
      if (!std::isfinite(value)) document.fail(where, "has an inverse bind matrix that is not finite");
      skin.inverse_bind[j].m[i / 4][i % 4] = static_cast<double>(value);
    }
  return skin;
}

}  // namespace kairos::gltf
