// Motion of glTF meshes and cameras: the node graph, skins and morph targets evaluated at any time.
#pragma once

#include <memory>
#include <vector>

#include "scene/motion.h"
#include "scene_io/gltf/nodes.h"
#include "scene_io/gltf/primitive.h"

namespace kairos::gltf {

/// A skin's joints with everything above them, arranged so that one pass gives all of their placements.
struct Skin {
  struct Placed {
    int node;
    int parent;  ///< index of the parent's entry, always an earlier one; -1 for a root
  };
  std::vector<Placed> placed;
  std::vector<uint32_t> joints;    ///< [joint] index into `placed`
  std::vector<Mat4> inverse_bind;  ///< [joint]

  /// World from the mesh's own space, per joint.
  std::vector<Mat4> joint_matrices(const NodeGraph& graph, double time, Side side) const;
  Mat4 first_joint_at_rest(const NodeGraph& graph) const;
};

/// Throws Error for joints that do not exist or inverse bind matrices that are missing or not finite.
Skin read_skin(Document& document, size_t index, const NodeGraph& graph);

class MeshMotion final : public VertexMotion {
 public:
  /// skin: null unless the primitive is skinned. weights: of the morph targets where no animation moves them. place:
  /// of an instance, in its node's space; not for what is skinned.
  MeshMotion(std::shared_ptr<const NodeGraph> graph, int node, std::shared_ptr<const Primitive> primitive,
             std::shared_ptr<const Skin> skin, std::vector<double> weights, const Mat4& place = {});

  size_t vertex_count() const override { return primitive_->positions.size(); }
  bool has_normals() const override { return !primitive_->normals.empty(); }
  bool is_static(double open, double close) const override;
  bool is_linear_between_kinks() const override;
  std::vector<double> kinks(double open, double close) const override;
  void positions(double time, Side side, std::span<Vec3d> out) const override;
  void normals(double time, Side side, std::span<Vec3f> out) const override;
  bool has_tangents() const override { return !primitive_->tangents.empty(); }
  void tangents(double time, Side side, std::span<Vec4f> out) const override;
  std::shared_ptr<const VertexShape> shape() const override;
  Mat4 placement(double time, Side side) const override { return world(time, side); }
  bool turns_normals() const override { return mirrors_; }

  /// True when the rest pose mirrors: the triangles are to be turned round.
  bool mirrors() const { return mirrors_; }

 private:
  std::vector<double> weights_at(double time, Side side) const;
  const Track* moving_weights() const;
  /// `base` of vertex `v`, displaced by the morph targets.
  Vec3d morphed(Vec3f base, std::vector<Vec3f> MorphTarget::*part, const std::vector<double>& weights, size_t v) const;
  Mat4 world(double time, Side side) const { return graph_->world(node_, time, side) * place_; }
  /// Calls put(vertex, matrix) with world from the mesh's own space for every vertex.
  template <class Put>
  void for_each_vertex(double time, Side side, const Put& put) const;

  std::shared_ptr<const NodeGraph> graph_;
  int node_;
  std::shared_ptr<const Primitive> primitive_;
  std::shared_ptr<const Skin> skin_;
  std::vector<double> weights_;
  Mat4 place_;
  bool mirrors_ = false;
};

/// Whatever a node carries, with the node's scale.
class NodeMotion : public TransformMotion {
 public:
  NodeMotion(std::shared_ptr<const NodeGraph> graph, int node) : graph_(std::move(graph)), node_(node) {}
  bool is_static(double open, double close) const override { return graph_->is_static(node_, open, close); }
  std::vector<double> kinks(double open, double close) const override;
  Mat4 at(double time, Side side) const override { return graph_->world(node_, time, side); }

 private:
  std::shared_ptr<const NodeGraph> graph_;
  int node_;
};

/// A camera: the node's place and directions without scale, mirroring or shear. Looks along the node's -z.
class CameraMotion final : public NodeMotion {
 public:
  using NodeMotion::NodeMotion;
  Mat4 at(double time, Side side) const override;
};

}  // namespace kairos::gltf
