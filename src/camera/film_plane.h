// Film points and the plane that they lie on: the one place that knows what a lens does.
#pragma once

#include <string>

#include <kairos/scene.h>

namespace kairos {

/// Whatever says so: the matrix, where there is one.
inline bool is_orthographic(const Lens& lens) { return lens.matrix ? (*lens.matrix)[3][3] != 0 : lens.orthographic; }

/// Throws Error(bad_input, place) for a lens through which nothing can be seen.
void check_lens(const Lens& lens, const std::string& place);

/// The plane z = -1 of camera space, on which a film point is where the ray through it passes; of an orthographic view
/// any plane z = const. Film points are pixels from the frame's upper left corner, right and down.
class FilmPlane {
 public:
  /// The projection has a size above 0 and passes check_lens.
  explicit FilmPlane(const Projection& projection);

  bool orthographic() const { return orthographic_; }

  Vec2d at(double x, double y) const {
    const double u = 2 * x / width_ - 1, v = 1 - 2 * y / height_;
    return {u * right_.x + v * up_.x + middle_.x, u * right_.y + v * up_.y + middle_.y};
  }

  /// The film point at which a point of the plane lies.
  Vec2d film(Vec2d point) const {
    const double x = point.x - middle_.x, y = point.y - middle_.y;
    return {width_ / 2 + (x * from_x_.x + y * from_y_.x), height_ / 2 - (x * from_x_.y + y * from_y_.y)};
  }

  /// Side of a square as large as a pixel on the plane.
  double pixel_side() const { return pixel_side_; }
  /// The most pixels that a step of length 1 on the plane leads over, in any direction.
  double pixels_per_unit() const { return pixels_per_unit_; }
  /// Squared distance from the view axis of the farthest of the frame's corners.
  double farthest_corner() const;

 private:
  static double dot_2(Vec2d a, Vec2d b) { return a.x * b.x + a.y * b.y; }

  double width_, height_;
  bool orthographic_;
  Vec2d middle_, right_, up_;  // of the picture: its middle, and from there to the middle of its right and upper edge
  Vec2d from_x_, from_y_;      // pixels right and up over which a step of 1 along each axis of the plane leads
  double pixel_side_ = 0, pixels_per_unit_ = 0;
};

}  // namespace kairos
