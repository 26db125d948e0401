// The current transform of a pbrt scene file: two matrices, for the start and the end of the motion.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "scene_io/pbrt/motion.h"
#include "scene_io/pbrt/tokens.h"

namespace kairos::pbrt {

/// Directions and angles as pbrt's statements have them; each gives the matrix that is put to the right of the current.
Mat4 rotation_about(double degrees, Vec3d axis);
/// Camera from world: x to the right, y up, z forward, which is left-handed. Not finite where there is no direction.
Mat4 pbrt_look_at(Vec3d eye, Vec3d target, Vec3d up);

struct TransformPair {
  Mat4 start, end;
  friend bool operator==(const TransformPair&, const TransformPair&) = default;
};

/// Does its last row differ from 0 0 0 1?
bool projects(const Mat4& matrix);
/// A point by a matrix that may project. Not finite where it goes to infinity.
Vec3d project_point(const Mat4& matrix, Vec3d point);

class CurrentTransform {
 public:
  /// Performs a transform statement, whose name was just taken from `tokens`. Returns false where `statement` is none.
  /// Throws Error(bad_input) for malformed arguments or a result that is not finite.
  bool perform(std::string_view statement, Tokens& tokens);

  /// Does neither matrix project? pbrt allows it for lights and shapes; what cannot have it calls require_affine, which
  /// throws Error(bad_input): "`who` cannot ...".
  bool is_affine() const;
  void require_affine(const std::string& who, const Place& place) const;

  /// Sets both to the identity, whatever is active.
  void reset() { pair_ = {}; }
  void set(const TransformPair& pair) { pair_ = pair; }
  const TransformPair& pair() const { return pair_; }

  /// Which of the two statements change: saved and restored with the attributes.
  std::array<bool, 2> active{true, true};

  void name(const std::string& name, const TransformPair& pair) { named_[name] = pair; }

  /// World from the current space; times: when the first matrix is left and the second is reached.
  TransformPath path(std::array<double, 2> times) const {
    return TransformPath(AnimatedTransform(pair_.start, pair_.end, times));
  }

 private:
  void multiply(const Mat4& matrix, const Place& place);
  void replace(const TransformPair& by);
  void check(const Place& place) const;

  TransformPair pair_;
  std::map<std::string, TransformPair> named_;
};

}  // namespace kairos::pbrt
