#include "scene_io/pbrt/curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

constexpr double kTolerance = 0.1;  // pixels: how far triangles may be from the curve
// Without a view, what a strand of hair needs.
constexpr int kPiecesUnseen = 8, kSidesUnseen = 3;
constexpr int kMostPieces = 64, kMostSides = 32;

using Bezier = std::array<Vec3d, 4>;

/// A quadratic Bézier curve as a cubic one.
Bezier elevated(Vec3d a, Vec3d b, Vec3d c) { return {a, lerp(a, b, 2 / 3.0), lerp(b, c, 1 / 3.0), c}; }

/// A uniform B-spline's segments share all but one of their control points; polar forms give their Bézier points.
Bezier from_spline(const Vec3d* p, int64_t degree) {
  if (degree == 2) return elevated(lerp(p[0], p[1], 0.5), p[1], lerp(p[1], p[2], 0.5));
  const Vec3d b = lerp(p[1], p[2], 1 / 3.0), c = lerp(p[1], p[2], 2 / 3.0);
  return {lerp(lerp(p[0], p[1], 2 / 3.0), b, 0.5), b, c, lerp(c, lerp(p[2], p[3], 1 / 3.0), 0.5)};
}

Vec3d point_at(const Bezier& p, double u) {
  const double v = 1 - u;
  return p[0] * (v * v * v) + p[1] * (3 * v * v * u) + p[2] * (3 * v * u * u) + p[3] * (u * u * u);
}

/// Its direction; zero only for a curve that is a point.
Vec3d direction_at(const Bezier& p, double u) {
  const double v = 1 - u;
  const Vec3d speed = (p[1] - p[0]) * (v * v) + (p[2] - p[1]) * (2 * v * u) + (p[3] - p[2]) * (u * u);
  if (const Vec3d direction = normalize(speed); direction != Vec3d{}) return direction;
  // Where control points meet, the next ones say which way it goes.
  for (const Vec3d& way : {p[2] - p[0], p[3] - p[1], p[3] - p[0]})
    if (const Vec3d direction = normalize(way); direction != Vec3d{}) return direction;
  return {};
}

/// The part of `v` that is across `direction`, as a unit vector; any across it where there is none.
Vec3d across(Vec3d v, Vec3d direction) {
  if (const Vec3d side = normalize(v - direction * dot(v, direction)); side != Vec3d{}) return side;
  const Vec3d axis = std::abs(direction.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalize(cross(direction, axis));
}

/// How finely a segment is cut.
struct Cut {
  int pieces = kPiecesUnseen, sides = kSidesUnseen;
};

Cut cut_of(const CurveSegment& segment, const std::optional<CurveView>& view) {
  Cut cut;
  if (!view) return cut;
  const Bezier& p = segment.points;
  const Vec3d center = (p[0] + p[1] + p[2] + p[3]) / 4.0;
  double reach = 0;
  for (const Vec3d& point : p) reach = std::max(reach, length(point - center));
  const double thickest = std::max(segment.width0, segment.width1);
  const double pixels = view->screen.pixels_per_unit(view->world_from_shape, center, reach + thickest / 2);
  // A chord leaves a cubic by an eighth of the square of its stretch of u times the second derivative, which is at most
  // six times the largest second difference of the control points.
  const double bend = std::max(length(p[0] - p[1] * 2.0 + p[2]), length(p[1] - p[2] * 2.0 + p[3]));
  const double pieces = std::ceil(std::sqrt(0.75 * bend * pixels / kTolerance));
  cut.pieces = pieces < kMostPieces ? std::max(1, static_cast<int>(pieces)) : kMostPieces;
  const double sides = std::ceil(std::numbers::pi * std::sqrt(thickest / 2 * pixels / (2 * kTolerance)));
  cut.sides = sides < kMostSides ? std::max(3, static_cast<int>(sides)) : kMostSides;
  return cut;
}

class Mesher {
 public:
  Mesher(std::vector<Triangle>& triangles, std::vector<Vec2f>& uvs, Vertices& vertices)
      : triangles_(triangles), uvs_(uvs), vertices_(vertices) {}

  /// A strip whose front is on the side that `normal` points to.
  template <class Normal>
  void ribbon(const CurveSegment& segment, int pieces, const Normal& normal) {
    const uint32_t first = next();
    for (int i = 0; i <= pieces; ++i) {
      const double u = static_cast<double>(i) / pieces;
      const Vec3d p = point_at(segment.points, u), along = direction_at(segment.points, u);
      const Vec3d up = across(normal(u, p), along), side = cross(along, up);
      const double half = (segment.width0 + (segment.width1 - segment.width0) * u) / 2;
      add(p - side * half, up, u, 0);
      add(p + side * half, up, u, 1);
    }
    for (uint32_t i = 0; i < static_cast<uint32_t>(pieces); ++i) quad(first + 2 * i, 2);
  }

  void tube(const CurveSegment& segment, Cut cut) {
    // Seen from a side that is as likely as any other, a prism is as wide as its perimeter divided by pi (Cauchy).
    const double turn = 2 * std::numbers::pi / cut.sides, fuller = turn / 2 / std::sin(turn / 2);
    const uint32_t first = next(), row = static_cast<uint32_t>(cut.sides) + 1;
    Vec3d out;  // kept from ring to ring, so that the tube does not twist
    for (int i = 0; i <= cut.pieces; ++i) {
      const double u = static_cast<double>(i) / cut.pieces;
      const Vec3d p = point_at(segment.points, u), along = direction_at(segment.points, u);
      out = across(out, along);
      const Vec3d side = cross(along, out);
      const double radius = fuller * (segment.width0 + (segment.width1 - segment.width0) * u) / 2;
      for (int k = 0; k <= cut.sides; ++k) {
        const double angle = k == cut.sides ? 0 : k * turn;
        const Vec3d normal = out * std::cos(angle) + side * std::sin(angle);
        add(p + normal * radius, normal, u, static_cast<double>(k) / cut.sides);
      }
    }
    for (uint32_t i = 0; i < static_cast<uint32_t>(cut.pieces); ++i)
      for (uint32_t k = 0; k + 1 < row; ++k) quad(first + i * row + k, row);
  }

 private:
  uint32_t next() const { return static_cast<uint32_t>(vertices_.positions.size()); }

  void add(Vec3d position, Vec3d normal, double u, double v) {
    vertices_.positions.push_back(to_float(position));
    vertices_.normals.push_back(to_float(normal));
    uvs_.push_back({static_cast<float>(u), static_cast<float>(v)});
  }

  /// Between two vertices and those that follow `row` later.
  void quad(uint32_t a, uint32_t row) {
    triangles_.push_back({a, a + 1, a + row + 1});
    triangles_.push_back({a, a + row + 1, a + row});
  }

  std::vector<Triangle>& triangles_;
  std::vector<Vec2f>& uvs_;
  Vertices& vertices_;
};

std::vector<Bezier> read_segments(const Parameters& parameters) {
  const int64_t degree = parameters.integer("degree", 3);
  const std::string basis = parameters.string("basis", "bezier");
  const bool spline = basis == "bspline";
  if (degree != 2 && degree != 3)
    fail(parameters.place(), fmt::format("a curve of degree {}: it must be 2 or 3", degree));
  if (!spline && basis != "bezier")
    fail(parameters.place(), "the basis '" + printable(basis) + "' of a curve is neither bezier nor bspline");
  std::vector<Vec3d> points;
  for (const Vec3f& point : parameters.vec3_list("P")) {
    if (!is_finite(point)) fail(parameters.place(), "a curve has a point that is not finite");
    points.push_back(to_double(point));
  }
  const auto order = static_cast<size_t>(degree);
  if (points.size() <= order || (!spline && (points.size() - 1) % order != 0))
    fail(parameters.place(),
         fmt::format("{} points make no curve of degree {} and basis '{}'", points.size(), degree, basis));
  std::vector<Bezier> segments;
  for (size_t first = 0; first + order < points.size(); first += spline ? 1 : order) {
    const Vec3d* p = &points[first];
    segments.push_back(spline        ? from_spline(p, degree)
                       : degree == 2 ? elevated(p[0], p[1], p[2])
                                     : Bezier{p[0], p[1], p[2], p[3]});
  }
  return segments;
}

}  // namespace

Curve read_curve(const Parameters& parameters) {
  Curve curve;
  const std::string kind = parameters.string("type", "flat");
  if (kind != "flat" && kind != "ribbon" && kind != "cylinder")
    fail(parameters.place(), "the type '" + printable(kind) + "' of a curve is neither flat, ribbon nor cylinder");
  curve.kind = kind == "flat" ? Curve::Kind::flat : kind == "ribbon" ? Curve::Kind::ribbon : Curve::Kind::cylinder;
  parameters.find("splitdepth");  // how finely pbrt cuts
  const double width = parameters.number("width", 1);
  const double width0 = parameters.number("width0", width), width1 = parameters.number("width1", width);
  if (width0 < 0 || width1 < 0) fail(parameters.place(), "a curve's width must not be negative");
  const std::vector<Bezier> segments = read_segments(parameters);
  const std::vector<Vec3f> normals = parameters.vec3_list("N");
  if (curve.kind == Curve::Kind::ribbon && normals.size() != segments.size() + 1)
    fail(parameters.place(),
         fmt::format("a ribbon of {} segments needs {} normals 'N'", segments.size(), segments.size() + 1));
  for (size_t i = 0; i < segments.size(); ++i) {
    const double count = static_cast<double>(segments.size()), from = static_cast<double>(i) / count,
                 to = static_cast<double>(i + 1) / count;
    CurveSegment segment{segments[i], width0 + (width1 - width0) * from, width0 + (width1 - width0) * to, {}, {}};
    if (curve.kind == Curve::Kind::ribbon) {
      segment.normal0 = normalize(to_double(normals[i]));
      segment.normal1 = normalize(to_double(normals[i + 1]));
    }
    curve.segments.push_back(segment);
  }
  return curve;
}

void add_curve(const Curve& curve, const std::optional<CurveView>& view, std::vector<Triangle>& triangles,
               std::vector<Vec2f>& uvs, Vertices& vertices) {
  Mesher mesher(triangles, uvs, vertices);
  for (const CurveSegment& segment : curve.segments) {
    if (direction_at(segment.points, 0) == Vec3d{} || std::max(segment.width0, segment.width1) == 0) continue;
    const Cut cut = cut_of(segment, view);
    if (curve.kind == Curve::Kind::ribbon)
      mesher.ribbon(segment, cut.pieces, [&](double u, Vec3d) { return lerp(segment.normal0, segment.normal1, u); });
    else if (curve.kind == Curve::Kind::flat && view)
      mesher.ribbon(segment, cut.pieces,
                    [&](double, Vec3d p) { return -view->screen.view(view->world_from_shape, p); });
    else
      mesher.tube(segment, cut);
  }
}

}  // namespace kairos::pbrt
