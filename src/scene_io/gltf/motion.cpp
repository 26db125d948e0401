#include "scene_io/gltf/motion.h"

#include <algorithm>
#include <utility>

namespace kairos::gltf {

namespace {

void sort_unique(std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
}

/// Sum of weight * matrix; the last row stays 0 0 0 1.
Mat4 blend(const std::vector<Mat4>& matrices, const Influence* begin, const Influence* end) {
  Mat4 result;
  result.m = {};
  for (const Influence* influence = begin; influence != end; ++influence) {
    const auto& m = matrices[influence->joint].m;
    const double weight = static_cast<double>(influence->weight);
    for (size_t column = 0; column < 4; ++column)
      for (size_t row = 0; row < 3; ++row) result.m[column][row] += weight * m[column][row];
  }
  result.m[3][3] = 1;
  return result;
}

}  // namespace

MeshMotion::MeshMotion(std::shared_ptr<const NodeGraph> graph, int node, std::shared_ptr<const Primitive> primitive,
                       std::shared_ptr<const Skin> skin, std::vector<double> weights, const Mat4& place)
    : graph_(std::move(graph)),
      node_(node),
      primitive_(std::move(primitive)),
      skin_(std::move(skin)),
      weights_(std::move(weights)),
      place_(place) {
  mirrors_ = determinant3(skin_ ? skin_->first_joint_at_rest(*graph_) : graph_->world_at_rest(node_) * place_) < 0;
}

const Track* MeshMotion::moving_weights() const {
  if (primitive_->targets.empty()) return nullptr;
  return graph_->nodes[static_cast<size_t>(node_)].moving_weights.get();
}

bool MeshMotion::is_static(double open, double close) const {
  if (const Track* weights = moving_weights(); weights && !weights->is_constant(open, close)) return false;
  if (!skin_) return graph_->is_static(node_, open, close);
  // Every entry stands for its own node only, so that shared ancestors are looked at once.
  return std::all_of(skin_->placed.begin(), skin_->placed.end(), [&](const Skin::Placed& placed) {
    return graph_->nodes[static_cast<size_t>(placed.node)].is_static(open, close);
  });
}

bool MeshMotion::is_linear_between_kinks() const {
  const Track* weights = moving_weights();
  if (weights && !weights->is_straight()) return false;
  const bool points_move = weights && !weights->is_piecewise_constant();
  if (!skin_) return graph_->is_straight(node_, points_move);
  return std::all_of(skin_->joints.begin(), skin_->joints.end(),
                     [&](uint32_t joint) { return graph_->is_straight(skin_->placed[joint].node, points_move); });
}

std::vector<double> MeshMotion::kinks(double open, double close) const {
  std::vector<double> result;
  if (const Track* weights = moving_weights()) weights->add_kinks(open, close, result);
  if (skin_)
    for (const Skin::Placed& placed : skin_->placed)
      graph_->nodes[static_cast<size_t>(placed.node)].add_kinks(open, close, result);
  else
    graph_->add_kinks(node_, open, close, result);
  sort_unique(result);
  return result;
}

std::vector<double> MeshMotion::weights_at(double time, Side side) const {
  std::vector<double> result = weights_;
  if (const Track* track = moving_weights()) {
    result.resize(track->width());
    track->evaluate(time, side, result);
  }
  result.resize(primitive_->targets.size(), 0.0);
  return result;
}

Vec3d MeshMotion::morphed(Vec3f base, std::vector<Vec3f> MorphTarget::*part, const std::vector<double>& weights,
                          size_t v) const {
  Vec3d result = to_double(base);
  for (size_t i = 0; i < weights.size(); ++i)
    if (const auto& displacements = primitive_->targets[i].*part; weights[i] != 0 && !displacements.empty())
      result += to_double(displacements[v]) * weights[i];
  return result;
}

template <class Put>
void MeshMotion::for_each_vertex(double time, Side side, const Put& put) const {
  if (!skin_) {
    const Mat4 matrix = world(time, side);
    for (size_t v = 0; v < vertex_count(); ++v) put(v, matrix);
    return;
  }
  const std::vector<Mat4> matrices = skin_->joint_matrices(*graph_, time, side);
  const Influence* influences = primitive_->influences.data();
  const auto& begin = primitive_->influence_begin;
  for (size_t v = 0; v < vertex_count(); ++v) put(v, blend(matrices, influences + begin[v], influences + begin[v + 1]));
}

void MeshMotion::positions(double time, Side side, std::span<Vec3d> out) const {
  const std::vector<double> weights = weights_at(time, side);
  for_each_vertex(time, side, [&](size_t v, const Mat4& matrix) {
    out[v] = transform_point(matrix, morphed(primitive_->positions[v], &MorphTarget::positions, weights, v));
  });
}

void MeshMotion::normals(double time, Side side, std::span<Vec3f> out) const {
  const std::vector<double> weights = weights_at(time, side);
  // Cofactors take a normal to the side that the vertices' order gives; mirrored triangles have theirs turned round.
  const double facing = mirrors_ ? -1 : 1;
  const auto unit = [](Vec3d n) {
    const Vec3d u = normalize(n);
    return u == Vec3d{} ? Vec3f{0, 0, 1} : to_float(u);  // of a surface that has collapsed
  };
  if (!skin_) {  // one matrix for all
    const Mat4 matrix = normal_matrix(world(time, side));
    for (size_t v = 0; v < vertex_count(); ++v)
      out[v] =
          unit(transform_vector(matrix, morphed(primitive_->normals[v], &MorphTarget::normals, weights, v)) * facing);
    return;
  }
  for_each_vertex(time, side, [&](size_t v, const Mat4& matrix) {
    const Vec3d n = morphed(primitive_->normals[v], &MorphTarget::normals, weights, v);
    out[v] = unit(transform_vector(normal_matrix(matrix), n) * facing);
  });
}

/// What lies in the surface goes as the surface goes. Where the mesh is mirrored its normals are turned round, and the
/// side that is left of them changes.
void MeshMotion::tangents(double time, Side side, std::span<Vec4f> out) const {
  const std::vector<double> weights = weights_at(time, side);
  const float facing = mirrors_ ? -1 : 1;
  for_each_vertex(time, side, [&](size_t v, const Mat4& matrix) {
    const Vec4f& base = primitive_->tangents[v];
    const Vec3d along = morphed({base.x, base.y, base.z}, &MorphTarget::tangents, weights, v);
    const Vec3f unit = to_float(normalize(transform_vector(matrix, along)));
    out[v] = {unit.x, unit.y, unit.z, base.w * facing};
  });
}

std::shared_ptr<const VertexShape> MeshMotion::shape() const {
  if (skin_ || !primitive_->targets.empty()) return nullptr;
  return std::make_shared<const VertexShape>(primitive_->shape());
}

std::vector<double> NodeMotion::kinks(double open, double close) const {
  std::vector<double> result;
  graph_->add_kinks(node_, open, close, result);
  sort_unique(result);
  return result;
}

Mat4 CameraMotion::at(double time, Side side) const {
  const Mat4 world = NodeMotion::at(time, side);
  const Vec3d eye{world.m[3][0], world.m[3][1], world.m[3][2]};
  const Vec3d back{world.m[2][0], world.m[2][1], world.m[2][2]}, up{world.m[1][0], world.m[1][1], world.m[1][2]};
  return look_at(eye, eye - normalize(back), up);
}

}  // namespace kairos::gltf
