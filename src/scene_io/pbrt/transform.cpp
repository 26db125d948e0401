#include "scene_io/pbrt/transform.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

/// `count` numbers, in brackets or not.
std::vector<double> take_numbers(Tokens& tokens, size_t count) {
  const bool bracket = tokens.peek().kind == Token::Kind::open;
  if (bracket) tokens.take();
  std::vector<double> numbers(count);
  for (double& number : numbers) number = tokens.take_number();
  if (bracket) {
    if (tokens.peek().kind != Token::Kind::close) fail(tokens.place(), "']' is missing after the last number");
    tokens.take();
  }
  return numbers;
}

Vec3d vec3_at(const std::vector<double>& n, size_t i) { return {n[i], n[i + 1], n[i + 2]}; }

/// 16 numbers, column after column for who multiplies column vectors from the right.
Mat4 take_matrix(Tokens& tokens) {
  const Place place = tokens.place();
  const std::vector<double> numbers = take_numbers(tokens, 16);
  Mat4 matrix;
  for (size_t c = 0; c < 4; ++c)
    for (size_t r = 0; r < 4; ++r) matrix.m[c][r] = numbers[4 * c + r];
  const auto& m = matrix.m;
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0) return matrix;
  if (m[3][3] == 0) fail(place, "numbers 4, 8, 12 and 16 of the matrix are all 0");
  for (auto& column : matrix.m)
    for (double& entry : column) entry /= numbers[15];
  return matrix;
}

bool is_finite_matrix(const Mat4& matrix) {
  for (const auto& column : matrix.m)
    for (const double entry : column)
      if (!std::isfinite(entry)) return false;
  return true;
}

}  // namespace

Mat4 rotation_about(double degrees, Vec3d axis) {
  const double half = degrees * std::numbers::pi / 360;
  const Vec3d n = normalize(axis) * std::sin(half);
  return rotation(normalize(Quaternion{n.x, n.y, n.z, std::cos(half)}));
}

Mat4 pbrt_look_at(Vec3d eye, Vec3d target, Vec3d up) {
  const Vec3d forward = normalize(target - eye);
  const Vec3d right = normalize(cross(normalize(up), forward)), true_up = cross(forward, right);
  return inverse_affine(Mat4{{{{right.x, right.y, right.z, 0},
                               {true_up.x, true_up.y, true_up.z, 0},
                               {forward.x, forward.y, forward.z, 0},
                               {eye.x, eye.y, eye.z, 1}}}});
}

bool projects(const Mat4& matrix) {
  const auto& m = matrix.m;
  return m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1;
}

Vec3d project_point(const Mat4& matrix, Vec3d point) {
  const auto& m = matrix.m;
  const double w = m[0][3] * point.x + m[1][3] * point.y + m[2][3] * point.z + m[3][3];
  const Vec3d moved = transform_point(matrix, point);
  return w == 1 ? moved : moved / w;
}

bool CurrentTransform::is_affine() const { return !projects(pair_.start) && !projects(pair_.end); }

void CurrentTransform::require_affine(const std::string& who, const Place& place) const {
  if (!is_affine()) fail(place, who + " cannot have a transform that projects (whose last row is not 0 0 0 1)");
}

void CurrentTransform::check(const Place& place) const {
  if (!is_finite_matrix(pair_.start) || !is_finite_matrix(pair_.end))
    fail(place, "the transform is not finite after this");
}

void CurrentTransform::multiply(const Mat4& matrix, const Place& place) {
  if (active[0]) pair_.start = pair_.start * matrix;
  if (active[1]) pair_.end = pair_.end * matrix;
  check(place);
}

void CurrentTransform::replace(const TransformPair& by) {
  if (active[0]) pair_.start = by.start;
  if (active[1]) pair_.end = by.end;
}

bool CurrentTransform::perform(std::string_view statement, Tokens& tokens) {
  const Place place = tokens.place();
  if (statement == "Identity") {
    replace({});
  } else if (statement == "Translate") {
    multiply(translation(vec3_at(take_numbers(tokens, 3), 0)), place);
  } else if (statement == "Scale") {
    multiply(scaling(vec3_at(take_numbers(tokens, 3), 0)), place);
  } else if (statement == "Rotate") {
    const std::vector<double> n = take_numbers(tokens, 4);
    if (length(normalize(vec3_at(n, 1))) == 0) fail(place, "the axis of a rotation has no direction");
    multiply(rotation_about(n[0], vec3_at(n, 1)), place);
  } else if (statement == "LookAt") {
    const std::vector<double> n = take_numbers(tokens, 9);
    const Mat4 matrix = pbrt_look_at(vec3_at(n, 0), vec3_at(n, 3), vec3_at(n, 6));
    if (!is_finite_matrix(matrix)) fail(place, "LookAt has no direction: eye and target meet, or up is along the view");
    multiply(matrix, place);
  } else if (statement == "Transform") {
    const Mat4 matrix = take_matrix(tokens);
    replace({matrix, matrix});
    check(place);
  } else if (statement == "ConcatTransform") {
    multiply(take_matrix(tokens), place);
  } else if (statement == "CoordinateSystem") {
    named_[tokens.take_string()] = pair_;
  } else if (statement == "CoordSysTransform") {
    const std::string name = tokens.take_string();
    const auto found = named_.find(name);
    if (found == named_.end()) fail(place, "no coordinate system '" + printable(name) + "' was named before");
    replace(found->second);
  } else if (statement == "ActiveTransform") {
    const Token which = tokens.take();
    if (which.text != "StartTime" && which.text != "EndTime" && which.text != "All")
      fail(place, "ActiveTransform needs StartTime, EndTime or All");
    active = {which.text != "EndTime", which.text != "StartTime"};
  } else {
    return false;
  }
  return true;
}

}  // namespace kairos::pbrt
