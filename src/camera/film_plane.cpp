#include "camera/film_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <kairos/error.h>

namespace kairos {

namespace {

constexpr double kMostAspect = 1e3, kMostShift = 1e3;

double determinant(Vec2d a, Vec2d b) { return a.x * b.y - a.y * b.x; }

/// Where a point (x, y) of the plane comes to lie in the picture: x from_x + y from_y + offset, from -1 to 1.
struct ClipFromPlane {
  Vec2d from_x, from_y, offset;

  explicit ClipFromPlane(const Matrix& m, bool orthographic) {
    const double w = orthographic ? m[3][3] : -m[2][3];
    from_x = {m[0][0] / w, m[0][1] / w};
    from_y = {m[1][0] / w, m[1][1] / w};
    offset = orthographic ? Vec2d{m[3][0] / w, m[3][1] / w} : Vec2d{-m[2][0] / w, -m[2][1] / w};
  }
};

void check_matrix(const Matrix& m, const std::string& place) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::bad_input, place, "a projection matrix " + why);
  };
  for (const auto& column : m)
    for (const double entry : column)
      if (!std::isfinite(entry)) refuse("with an entry that is not finite cannot be used");
  const bool perspective = m[3][3] == 0 && m[2][3] < 0, orthographic = m[2][3] == 0 && m[3][3] > 0;
  if (m[0][3] != 0 || m[1][3] != 0 || !(perspective || orthographic))
    refuse(
        fmt::format("ends in the row ({}, {}, {}, {}), and not in (0, 0, -1, 0) or (0, 0, 0, 1) times a positive "
                    "number: the view must go along -z",
                    m[0][3], m[1][3], m[2][3], m[3][3]));
  if (perspective && (m[3][0] != 0 || m[3][1] != 0))
    refuse("with its eye beside the origin cannot be used; move the camera instead");
  if (orthographic && (m[2][0] != 0 || m[2][1] != 0))
    refuse("whose rays are not along -z cannot be used; turn the camera instead");
  const ClipFromPlane clip(m, orthographic);
  const double area = determinant(clip.from_x, clip.from_y);
  if (!std::isfinite(area) || !std::isfinite(1 / area)) refuse("that shows all points on a line cannot be used");
}

}  // namespace

FilmPlane::FilmPlane(const Projection& projection)
    : width_(projection.width), height_(projection.height), orthographic_(is_orthographic(projection)) {
  if (projection.matrix) {
    const ClipFromPlane clip(*projection.matrix, orthographic_);
    const double area = determinant(clip.from_x, clip.from_y);
    right_ = {clip.from_y.y / area, -clip.from_x.y / area};
    up_ = {-clip.from_y.x / area, clip.from_x.x / area};
    middle_ = {-clip.offset.x * right_.x - clip.offset.y * up_.x, -clip.offset.x * right_.y - clip.offset.y * up_.y};
    from_x_ = {clip.from_x.x * width_ / 2, clip.from_x.y * height_ / 2};
    from_y_ = {clip.from_y.x * width_ / 2, clip.from_y.y * height_ / 2};
    pixel_side_ = std::sqrt(4 / (std::abs(area) * width_ * height_));
    // The larger singular value.
    const double a = dot_2(from_x_, from_x_), b = dot_2(from_x_, from_y_), c = dot_2(from_y_, from_y_);
    pixels_per_unit_ = std::sqrt((a + c + std::hypot(a - c, 2 * b)) / 2);
    return;
  }
  const double half_height = orthographic_ ? projection.view_height / 2 : std::tan(projection.vfov / 2);
  const double half_width = half_height * width_ / height_ * projection.pixel_aspect;
  right_ = {half_width, 0};
  up_ = {0, half_height};
  middle_ = {2 * half_height * projection.shift[0], 2 * half_height * projection.shift[1]};
  from_y_ = {0, height_ / 2 / half_height};
  from_x_ = {from_y_.y / projection.pixel_aspect, 0};
  pixel_side_ = 2 * half_height / height_ * std::sqrt(projection.pixel_aspect);
  pixels_per_unit_ = std::max(from_x_.x, from_y_.y);
}

double FilmPlane::farthest_corner() const {
  double farthest = 0;
  for (const double x : {0.0, width_})
    for (const double y : {0.0, height_}) {
      const Vec2d corner = at(x, y);
      farthest = std::max(farthest, dot_2(corner, corner));
    }
  return farthest;
}

void check_lens(const Lens& lens, const std::string& place) {
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::bad_input, place, why); };
  if (lens.matrix) return check_matrix(*lens.matrix, place);
  if (lens.orthographic && !(lens.view_height > 0 && std::isfinite(lens.view_height)))
    refuse(fmt::format("a view height of {} is not positive", lens.view_height));
  if (!lens.orthographic && !(lens.vfov > 0 && lens.vfov < std::numbers::pi))
    refuse(fmt::format("a field of view of {} rad is not inside (0, pi)", lens.vfov));
  if (!(lens.pixel_aspect >= 1 / kMostAspect && lens.pixel_aspect <= kMostAspect))
    refuse(
        fmt::format("a pixel aspect of {} is not between {} and {}", lens.pixel_aspect, 1 / kMostAspect, kMostAspect));
  for (const double shift : lens.shift)
    if (!(std::abs(shift) <= kMostShift))
      refuse(fmt::format("a lens shift of {} is not between {} and {} heights of the view", shift, -kMostShift,
                         kMostShift));
}

}  // namespace kairos
