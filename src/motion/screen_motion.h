// What moving triangles do on screen: where each may be seen while the shutter is open, how fast it goes and which way.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <kairos/render.h>
#include <kairos/scene.h>

#include "motion/shape_boxes.h"

namespace kairos {

/// Sums over the moving triangles that may be seen in a pixel. Integers, hence the same for any order of summation, and
/// whatever else is summed up beside it.
struct PixelMotion {
  int64_t count = 0;
  int64_t speed = 0, depth = 0;               // see TriangleOnScreen
  int64_t along = 0, across = 0, weight = 0;  // over the square of pixels that share a direction

  bool moves() const { return count > 0; }
  /// Mean of how far they move on screen, in pixels per shutter; 0 without any.
  double mean_speed() const;
  /// Geometric mean of the depth of the nearest vertex, in scene units; infinity without any.
  double mean_depth() const;
  /// Radians from the first axis of the screen towards the second, of motion there and back alike; nothing where what
  /// moves goes different ways.
  std::optional<double> direction() const;
};

/// One moving triangle in one key span.
struct TriangleOnScreen {
  Crop pixels;                                ///< in which it may be seen, within the frame; not empty
  int64_t speed = 0, depth = 0;               ///< of its fastest vertex; binary logarithm of its nearest; in units
  int64_t along = 0, across = 0, weight = 0;  ///< cosine and sine of twice the direction's angle times the weight
};

/// Side of the squares of pixels that share a direction.
inline constexpr int kDirectionCell = 4;

/// Pixels that may be asked for what moves in them wherever the picture is cut: spread evenly over the frame, the first
/// ones as evenly as all.
struct LookPixel {
  int x = 0, y = 0;
};
inline constexpr uint32_t kLeastLookPixels = 256, kMostLookPixels = 4096;
/// One for 64 pixels of the frame, within these limits.
std::vector<LookPixel> look_pixels(const Projection& frame);

/// The moving triangles of a shot, found by where they are on screen. Conservative: made from the screen bounds of each
/// triangle's path, cut off at the near side. Meshes with more than one key count as moving as a whole. Instances count
/// as the boxes that their object's triangles lie in, a hundred in each: they are there for what is too large to look
/// at triangle by triangle.
///
/// Keeps bounds of a few hundred triangles each and projects those again that are asked for: memory is small, and a
/// part of the frame costs what may be seen in it.
class ScreenMotion {
 public:
  /// margin: pixels around a pixel's area that its filter reaches. The shot must outlive this.
  ScreenMotion(const Shot& shot, double margin);

  const Projection& frame() const { return shot_.projection; }
  /// True when nothing moves in any pixel of the frame.
  bool empty() const { return pieces_.empty(); }

  /// Calls `visit` with all triangles that may be seen in a part of the frame, some at a time, in no particular order,
  /// perhaps with others that may not; one call at a time, from any thread.
  void visit(const Crop& part, const std::function<void(std::span<const TriangleOnScreen>)>& visit) const;

  /// Of one of the look_pixels(); nullptr for others.
  const PixelMotion* at_look(int x, int y) const;

 private:
  /// Triangles, or boxes of an instance's object, [begin, end) of a mesh between two of its keys.
  struct Piece {
    uint32_t mesh, key, begin, end;
    Crop bounds;  ///< of all their pixels
  };
  class Looks;

  void project(const Piece& piece, std::vector<TriangleOnScreen>& out) const;

  const Shot& shot_;
  double margin_;
  std::map<const Mesh*, std::vector<BoxCorners>> boxes_;  // of instances' objects
  std::vector<Piece> pieces_;                             // those of which anything may be seen
  struct Look {
    uint64_t pixel;  // row and column in one number
    PixelMotion motion;
  };
  std::vector<Look> looks_;  // ascending
};

}  // namespace kairos
