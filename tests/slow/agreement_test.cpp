// Time-continuous rays and Embree's discrete rays, two programs that share no code, see the same at any instant.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "data_folders.h"
#include "discrete/discrete_scene.h"
#include "soup.h"
#include "synthetic_scene.h"

namespace kairos {
namespace {

constexpr int kPairs = 10000;
/// So near to a segment's end, or in barycentric coordinates to an edge, either may be right.
constexpr double kNearEnd = 1e-4, kNearEdge = 1e-4;
/// Relative. Surfaces that are no farther apart are one; distances of one triangle may differ by kSameDistance: Embree
/// computes in float, which on triangles seen at a grazing angle shows.
constexpr double kSameSurface = 1e-5, kSameDistance = 1e-4;
/// What float positions resolve, as a part of their distance from the origin.
constexpr double kResolved = 2e-6;

/// Where a ray meets a triangle's plane.
struct Point {
  double dist = 0;
  /// By how much dist may be off since positions are floats: the more, the flatter the ray meets the plane.
  double resolved = 0;
  /// So near to an edge that either side of it may be right: by kNearEdge, or by what float positions resolve.
  bool near_edge = false;
};

Point meet(const Mesh& mesh, uint32_t triangle, const Ray& ray, double time) {
  std::array<Vec3d, 3> p;
  for (size_t v = 0; v < 3; ++v) p[v] = position_at(mesh, mesh.triangles[triangle][v], time) - to_double(ray.origin);
  const Vec3d d = to_double(ray.direction);
  const Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
  const double across = dot(normal, d), resolution = kResolved * (length(to_double(ray.origin)) + length(p[0]));
  Point point;
  point.dist = dot(p[0], normal) / across;
  point.resolved = resolution * length(normal) / std::abs(across);
  for (size_t v = 0; v < 3; ++v) {
    const Vec3d a = p[(v + 1) % 3], b = p[(v + 2) % 3];
    const double side = dot(d, cross(a, b));
    const double off = std::abs(side) / length(cross(d, b - a));  // from the ray to the edge's line
    point.near_edge |= side / across < kNearEdge || off < resolution;
  }
  return point;
}

/// A ray through a random film point or, half of the time, from anywhere around to a random point of the scene.
Ray random_ray(const Shot& shot, float time, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  if (random() % 2) {
    const double tangent = std::tan(shot.projection.vfov / 2),
                 aspect = double(shot.projection.width) / shot.projection.height;
    const double x = 2 * uniform(random) - 1, y = 2 * uniform(random) - 1;
    return {{}, to_float(Vec3d{x * tangent * aspect, y * tangent, -1})};
  }
  const auto random_point = [&] {
    const Mesh* mesh = nullptr;
    do mesh = &shot.meshes[random() % shot.meshes.size()];
    while (mesh->triangles.empty());
    const Triangle& triangle = mesh->triangles[random() % mesh->triangles.size()];
    const double u = uniform(random), v = uniform(random) * (1 - u);
    return position_at(*mesh, triangle[0], time) * (1 - u - v) + position_at(*mesh, triangle[1], time) * u +
           position_at(*mesh, triangle[2], time) * v;
  };
  const Vec3d a = random_point(), b = random_point();
  return {to_float(a + (a - b) * uniform(random)), to_float((b - a) * (0.5 + uniform(random)))};
}

std::string text_of(const Ray& ray, double time, const Segment* segment, const std::optional<DiscreteHit>& hit) {
  std::ostringstream out;
  out.precision(9);
  out << "ray " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z << "  " << ray.direction.x << " "
      << ray.direction.y << " " << ray.direction.z << " at time " << time << "\n  tc: ";
  if (segment)
    out << "mesh " << segment->mesh << " triangle " << segment->triangle << " [" << segment->begin << ", "
        << segment->end << ") dist " << segment->dist_begin << " to " << segment->dist_end;
  else
    out << "nothing";
  out << "\n  Embree: ";
  if (hit)
    out << "mesh " << hit->mesh << " triangle " << hit->triangle << " dist " << hit->dist << " u " << hit->u << " v "
        << hit->v;
  else
    out << "nothing";
  return out.str();
}

/// Whether both saw the same, or a case in which either may be right.
bool agree(const Shot& shot, const Ray& ray, double time, const Segment* seen, const std::optional<DiscreteHit>& hit) {
  if (!seen && !hit) return true;
  const Point point = seen ? meet(shot.meshes[seen->mesh], seen->triangle, ray, time) : Point{};
  const Point other = hit ? meet(shot.meshes[hit->mesh], hit->triangle, ray, time) : Point{};
  if (seen && hit) {
    const bool same = seen->mesh == hit->mesh && seen->triangle == hit->triangle && seen->front == hit->front;
    if (std::abs(point.dist - hit->dist) <= point.resolved + (same ? kSameDistance : kSameSurface) * point.dist)
      return true;
  }
  const auto doubtful = [&](const Point& p) { return p.near_edge || std::abs(p.dist) <= p.resolved; };
  return (seen && doubtful(point)) || (hit && doubtful(other));
}

/// The distances that a segment claims at its ends, against the triangle's plane at those times.
bool right_at_ends(const Shot& shot, const Ray& ray, const Segment& segment) {
  // From just inside, since at a jump the mesh is elsewhere, and ends may have been moved by a millionth to meet
  // others.
  constexpr double kInside = 2e-6, kClose = 1e-3;
  const double far = std::max(segment.dist_begin, segment.dist_end);
  const auto right = [&](double time, double dist) {
    const Point point = meet(shot.meshes[segment.mesh], segment.triangle, ray, time);
    return std::abs(point.dist - dist) <= kClose * far + point.resolved;
  };
  return right(segment.begin + kInside, segment.dist_begin) && right(segment.end - kInside, segment.dist_end);
}

void expect_agreement(const Shot& shot) {
  for (const std::string& note : shot.notes) std::printf("%s\n", note.c_str());
  const Tracer tracer(shot.meshes);
  const DiscreteScene discrete(shot.meshes);
  Tracer::Workspace workspace;
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(0, 1);
  int compared = 0, moving = 0, wrong = 0;
  for (int i = 0; i < kPairs; ++i) {
    const float time = uniform(random);
    const Ray ray = random_ray(shot, time, random);
    const auto segments = tracer.trace(ray, Visibility::visible, workspace);
    const auto hit = discrete.intersect(ray, time);
    const Segment* seen = nullptr;
    bool near_end = false;
    for (const Segment& s : segments) {
      near_end |= std::abs(s.begin - time) < kNearEnd || std::abs(s.end - time) < kNearEnd;
      if (s.begin <= time && time < s.end) seen = &s;
    }
    if (near_end) continue;
    ++compared;
    moving += seen && hit && !shot.meshes[seen->mesh].is_static();
    const bool right = agree(shot, ray, time, seen, hit) && (!seen || right_at_ends(shot, ray, *seen));
    if (!right && ++wrong <= 5) ADD_FAILURE() << text_of(ray, time, seen, hit);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(compared, kPairs * 9 / 10);
  EXPECT_GT(moving, kPairs / 10);
}

TEST(Agreement, SyntheticScene) {
  // A floor that stands still, a turning rotor, a waving sheet, something that jumps, and a camera that turns.
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3d> blades;
  for (int i = 0; i < 300; ++i) blades.push_back({uniform(random), uniform(random), 0.2 * uniform(random)});
  Scene scene = make_scene(make_path_mesh(300, [blades](size_t v, double time, Side) {
    const Mat4 turn = rotation({0, 0, std::sin(time), std::cos(time)});
    return transform_point(turn, blades[v]) + Vec3d{-1, 0, -6};
  }));

  constexpr uint32_t kSide = 30;
  SceneMesh sheet = make_path_mesh(kSide * kSide, [](size_t v, double time, Side) {
    const double x = static_cast<double>(v % kSide) / kSide - 0.5, y = static_cast<double>(v / kSide) / kSide - 0.5;
    return Vec3d{1 + 2 * x + time, 2 * y, -6 + 0.3 * std::sin(12 * x + 6 * time)};
  });
  sheet.triangles.edit().clear();
  for (uint32_t y = 0; y + 1 < kSide; ++y)
    for (uint32_t x = 0; x + 1 < kSide; ++x) {
      const uint32_t v = y * kSide + x;
      sheet.triangles.edit().insert(sheet.triangles.edit().end(),
                                    {{v, v + 1, v + kSide}, {v + 1, v + kSide + 1, v + kSide}});
    }
  SceneMesh jumper = make_path_mesh(150, [blades](size_t v, double time, Side side) {
    const bool after = time > 0.4 || (time == 0.4 && side == Side::after);
    return blades[v] * 0.5 + Vec3d{after ? 1.5 : -1.5, 1 + time, -5};
  });
  motion_of(jumper).all_kinks = {0.4};
  SceneMesh floor = make_path_mesh(6, [](size_t v, double, Side) {
    const std::array<Vec3d, 6> corners{Vec3d{-9, -1, -1}, {9, -1, -1},  {9, -1, -20},
                                       {-9, -1, -1},      {9, -1, -20}, {-9, -1, -20}};
    return corners[v];
  });
  motion_of(floor).still = true;
  for (const SceneMesh& mesh : {sheet, jumper, floor}) scene.meshes.push_back(mesh);
  expect_agreement(make_shot(scene));

  camera_motion_of(scene).placement = [](double time) { return translation({time, 0, 0}) * turned(0.4 * time - 0.2); };
  camera_motion_of(scene).still = false;
  const Shot shot = make_shot(scene);
  for (const Mesh& mesh : shot.meshes) EXPECT_GT(mesh.key_count(), 2u);
  expect_agreement(shot);
}

/// Third-party scenes.
struct Animated {
  const char* name;
  const char* file;
  double frame;
};
constexpr Animated kAnimated[] = {
    {"fan", "vintage-fan/vintageFan_animated.gltf", 10},
    {"mannequin", "mannequiny/mannequiny.glb", 5},
    {"robot", "robot-expressive/robot.glb", 7},
    {"barbarian", "kaykit-adventurers/Barbarian.glb", 6},
    {"fox", "gltf-khronos/Fox/Fox.glb", 4},
};

class AgreementOnScenes : public ::testing::TestWithParam<Animated> {};

TEST_P(AgreementOnScenes, SeesWhatEmbreeSees) {
  const auto path = scenes_folder() / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no third-party scene " << path << "; set KAIROS_SCENES";
  ShotOptions options;
  options.frame = GetParam().frame;
  options.shutter = {0, 1};
  const Shot shot = make_shot(*load_scene({path.string()}), options);
  expect_agreement(shot);
}

INSTANTIATE_TEST_SUITE_P(Animated, AgreementOnScenes, ::testing::ValuesIn(kAnimated),
                         [](const auto& chosen) { return std::string(chosen.param.name); });

}  // namespace
}  // namespace kairos
