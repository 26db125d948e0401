#include "discrete/placed_object.h"

#include <algorithm>
#include <cmath>

#include "math/transform.h"

namespace kairos {

namespace {

Vec4f mix(const Vec4f& a, const Vec4f& b, double weight) {
  const auto at = [&](float from, float to) {
    return static_cast<float>(static_cast<double>(from) +
                              (static_cast<double>(to) - static_cast<double>(from)) * weight);
  };
  return {at(a.x, b.x), at(a.y, b.y), at(a.z, b.z), at(a.w, b.w)};
}

AffineMap mix(const AffineMap& a, const AffineMap& b, double weight) {
  AffineMap map;
  for (size_t axis = 0; axis < 3; ++axis) map.rows[axis] = mix(a.rows[axis], b.rows[axis], weight);
  return map;
}

Mat4 linear_part(const AffineMap& map) {
  Mat4 matrix;
  for (size_t row = 0; row < 3; ++row) {
    matrix.m[0][row] = static_cast<double>(map.rows[row].x);
    matrix.m[1][row] = static_cast<double>(map.rows[row].y);
    matrix.m[2][row] = static_cast<double>(map.rows[row].z);
  }
  return matrix;
}

}  // namespace

PlacedObject::PlacedObject(const Mesh& mesh, UniformRun run, size_t parts) {
  for (size_t key = run.first; key < run.last; ++key)
    for (size_t part = 0; part < parts; ++part)
      maps_.push_back(
          mix(mesh.placements[key], mesh.placements[key + 1], static_cast<double>(part) / static_cast<double>(parts)));
  maps_.push_back(mesh.placements[run.last]);
}

void PlacedObject::fill(RTCGeometry geometry, RTCScene object) const {
  rtcSetGeometryInstancedScene(geometry, object);
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(maps_.size()));
  for (size_t step = 0; step < maps_.size(); ++step) {
    float rows[12];
    for (size_t axis = 0; axis < 3; ++axis) {
      const Vec4f& row = maps_[step].rows[axis];
      const float values[4] = {row.x, row.y, row.z, row.w};
      std::copy_n(values, 4, rows + 4 * axis);
    }
    rtcSetGeometryTransform(geometry, static_cast<unsigned>(step), RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
  }
}

Vec3f PlacedObject::normal(Vec3f of_object, float time) const {
  if (maps_.empty()) return of_object;
  const double place = static_cast<double>(time) * static_cast<double>(maps_.size() - 1);
  const size_t first = std::min(static_cast<size_t>(place), maps_.size() - 1);
  const size_t second = std::min(first + 1, maps_.size() - 1);
  const Mat4 matrix = normal_matrix(linear_part(mix(maps_[first], maps_[second], place - static_cast<double>(first))));
  return to_float(normalize(transform_vector(matrix, to_double(of_object))));
}

}  // namespace kairos
