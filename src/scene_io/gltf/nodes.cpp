#include "scene_io/gltf/nodes.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace kairos::gltf {

namespace {

// Every evaluation walks to the root. Skeletons of real characters are a few dozen deep.
constexpr int kMaxDepth = 1000;

Mat4 compose(Vec3d t, Quaternion r, Vec3d s) {
  Mat4 result = rotation(r);
  for (size_t row = 0; row < 3; ++row) {
    result.m[0][row] *= s.x;
    result.m[1][row] *= s.y;
    result.m[2][row] *= s.z;
  }
  result.m[3] = {t.x, t.y, t.z, 1};
  return result;
}

Vec3d vector_at(const Track& track, double time, Side side) {
  std::array<double, 3> v;
  track.evaluate(time, side, v);
  return {v[0], v[1], v[2]};
}

Node read_node(const Document& document, const file::Node& source, const std::string& where) {
  const auto sized = [&](const std::vector<double>& values, size_t size, const char* what) {
    if (!values.empty() && values.size() != size)
      document.fail(where, fmt::format("its {} has {} numbers instead of {}", what, values.size(), size));
    return !values.empty();
  };
  Node node;
  node.has_matrix = sized(source.matrix, 16, "matrix");
  if (node.has_matrix)
    for (size_t i = 0; i < 16; ++i) node.matrix.m[i / 4][i % 4] = source.matrix[i];
  if (sized(source.translation, 3, "translation"))
    node.translation = {source.translation[0], source.translation[1], source.translation[2]};
  if (sized(source.scale, 3, "scale")) node.scale = {source.scale[0], source.scale[1], source.scale[2]};
  if (sized(source.rotation, 4, "rotation"))
    node.rotation =
        normalize(Quaternion{source.rotation[0], source.rotation[1], source.rotation[2], source.rotation[3]});
  return node;
}

}  // namespace

Mat4 Node::at_rest() const { return has_matrix ? matrix : compose(translation, rotation, scale); }

Mat4 Node::at(double time, Side side) const {
  if (has_matrix) return matrix;
  Quaternion r = rotation;
  if (moving_rotation) {
    std::array<double, 4> v;
    moving_rotation->evaluate(time, side, v);
    r = {v[0], v[1], v[2], v[3]};
  }
  return compose(moving_translation ? vector_at(*moving_translation, time, side) : translation, r,
                 moving_scale ? vector_at(*moving_scale, time, side) : scale);
}

bool Node::is_static(double open, double close) const {
  for (const Track* track : {moving_translation.get(), moving_rotation.get(), moving_scale.get()})
    if (track && !track->is_constant(open, close)) return false;
  return true;
}

void Node::add_kinks(double open, double close, std::vector<double>& kinks) const {
  for (const Track* track : {moving_translation.get(), moving_rotation.get(), moving_scale.get()})
    if (track) track->add_kinks(open, close, kinks);
}

NodeGraph::NodeGraph(const Document& document) {
  const auto& sources = document.model.nodes;
  for (size_t i = 0; i < sources.size(); ++i) nodes.push_back(read_node(document, sources[i], gltf::at("nodes", i)));
  for (size_t i = 0; i < sources.size(); ++i)
    for (int child : sources[i].children) {
      if (child < 0 || static_cast<size_t>(child) >= nodes.size())
        document.fail(gltf::at("nodes", i), fmt::format("names child {}, but there are {} nodes", child, nodes.size()));
      Node& node = nodes[static_cast<size_t>(child)];
      if (node.parent >= 0)
        document.fail(gltf::at("nodes", static_cast<size_t>(child)),
                      fmt::format("has more than one parent: nodes {} and {}", node.parent, i));
      node.parent = static_cast<int>(i);
    }
  // With one parent each, whoever does not lead to a root within so many steps is part of a cycle, below one, or too
  // deep.
  std::vector<int> depth(nodes.size(), 0);  // 0: not known yet
  for (size_t i = 0; i < nodes.size(); ++i) {
    int steps = 0, node = static_cast<int>(i);
    while (node >= 0 && depth[static_cast<size_t>(node)] == 0 && steps <= kMaxDepth) {
      node = nodes[static_cast<size_t>(node)].parent;
      ++steps;
    }
    const int total = steps + (node >= 0 ? depth[static_cast<size_t>(node)] : 0);
    if (total > kMaxDepth)
      document.fail(gltf::at("nodes", i),
                    fmt::format("is its own ancestor, or lies more than {} levels deep", kMaxDepth));
    node = static_cast<int>(i);
    for (int d = total; steps > 0; --steps, --d) {
      depth[static_cast<size_t>(node)] = d;
      node = nodes[static_cast<size_t>(node)].parent;
    }
  }
}

Mat4 NodeGraph::world_at_rest(int node) const {
  Mat4 result;
  for (; node >= 0; node = nodes[static_cast<size_t>(node)].parent)
    result = nodes[static_cast<size_t>(node)].at_rest() * result;
  return result;
}

Mat4 NodeGraph::world(int node, double time, Side side) const {
  Mat4 result;
  for (; node >= 0; node = nodes[static_cast<size_t>(node)].parent)
    result = nodes[static_cast<size_t>(node)].at(time, side) * result;
  return result;
}

bool NodeGraph::is_static(int node, double open, double close) const {
  for (; node >= 0; node = nodes[static_cast<size_t>(node)].parent)
    if (!nodes[static_cast<size_t>(node)].is_static(open, close)) return false;
  return true;
}

void NodeGraph::add_kinks(int node, double open, double close, std::vector<double>& kinks) const {
  for (; node >= 0; node = nodes[static_cast<size_t>(node)].parent)
    nodes[static_cast<size_t>(node)].add_kinks(open, close, kinks);
}

bool NodeGraph::is_straight(int node, bool points_move) const {
  const auto moves = [](const std::shared_ptr<const Track>& track) { return track && !track->is_piecewise_constant(); };
  for (; node >= 0; node = nodes[static_cast<size_t>(node)].parent) {
    const Node& n = nodes[static_cast<size_t>(node)];
    if (moves(n.moving_rotation)) return false;
    for (const Track* track : {n.moving_translation.get(), n.moving_scale.get()})
      if (track && !track->is_straight()) return false;
    if (moves(n.moving_scale) && points_move) return false;
    points_move = points_move || moves(n.moving_scale) || moves(n.moving_translation);
  }
  return true;
}

}  // namespace kairos::gltf
