// The node graph with the animation that plays on it: world from node at any time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "math/transform.h"
#include "scene/scene.h"
#include "scene_io/gltf/document.h"
#include "scene_io/gltf/track.h"

namespace kairos::gltf {

struct Node {
  int parent = -1;
  bool has_matrix = false;
  Mat4 matrix;  ///< where the file gives one instead of translation, rotation and scale
  Vec3d translation, scale{1, 1, 1};
  Quaternion rotation;
  std::shared_ptr<const Track> moving_translation, moving_rotation, moving_scale;  ///< null: at rest
  std::shared_ptr<const Track> moving_weights;                                     ///< of the node's morph targets

  Mat4 at_rest() const;
  Mat4 at(double time, Side side) const;  ///< parent from node
  bool is_static(double open, double close) const;
  void add_kinks(double open, double close, std::vector<double>& kinks) const;
};

/// A forest: every node has at most one parent and is no ancestor of itself. Immutable once made.
class NodeGraph {
 public:
  /// Throws Error for anything that is not a forest, or is deeper than a file that means something.
  explicit NodeGraph(const Document& document);

  std::vector<Node> nodes;

  Mat4 world_at_rest(int node) const;
  Mat4 world(int node, double time, Side side) const;

  bool is_static(int node, double open, double close) const;
  void add_kinks(int node, double open, double close, std::vector<double>& kinks) const;

  /// True when points fixed to `node` (or, with `points_move`, moving straight relative to it) move straight at
  /// constant speed in the world between kinks: nothing above turns, and nothing that scales carries what moves.
  bool is_straight(int node, bool points_move) const;
};

/// Plays the animation that `wanted` names (see LoadOptions) on the graph, or all of them: of two that move the same
/// the first one counts. The scene is told which there are. Throws Error when there is none such.
void play_animations(Document& document, const std::string& wanted, NodeGraph& graph, Scene& scene, Warnings& warnings);

/// Index of the element named `wanted`, or else of that number. -1 when there is none.
int find_by_name_or_index(const std::vector<std::string>& names, const std::string& wanted);

/// "'walk', 'run'", for messages.
std::string listed(const std::vector<std::string>& names);

}  // namespace kairos::gltf
