// Closed meshes that move and deform: from inside, something is seen at every instant, and only one thing at a time.
#include <algorithm>
#include <map>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include <kairos/tracer.h>

#include "soup.h"

namespace kairos {
namespace {

using test::seed;

/// A unit sphere of 20 * 4^levels triangles, counter-clockwise seen from outside.
Mesh make_icosphere(int levels) {
  Mesh mesh;
  mesh.name = "sphere";
  const float g = 1.618034f;
  std::vector<Vec3f> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                            {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(points.size()));
      if (is_new) points.push_back(points[a] + points[b]);
      return at->second;
    };
    for (Vec3f& p : points) p = normalize(p);
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3f& p : points) p = normalize(p);
  mesh.positions = {points};
  return mesh;
}

/// Gives `mesh` keys at `times`: at each it has turned on, and every vertex has another distance from the middle,
/// between 1 and 1 + roughness.
void animate(Mesh& mesh, std::vector<float> times, float turn, float roughness, std::mt19937& random) {
  const std::vector<Vec3f> rest = mesh.positions[0];
  std::uniform_real_distribution<float> uniform(0, 1);
  mesh.positions.clear();
  for (size_t k = 0; k < times.size(); ++k) {
    const float angle = turn * static_cast<float>(k), c = std::cos(angle), s = std::sin(angle);
    mesh.positions.emplace_back();
    for (Vec3f p : rest) {
      const float size = 1 + roughness * uniform(random);
      mesh.positions.back().push_back(Vec3f{c * p.x + s * p.z, p.y, c * p.z - s * p.x} * size);
    }
  }
  mesh.key_times = std::move(times);
}

Vec3f vertex_at(const Mesh& mesh, uint32_t vertex, float time) {
  if (mesh.is_static()) return mesh.positions[0][vertex];
  size_t k = 0;
  while (k + 2 < mesh.key_count() && time >= mesh.key_times[k + 1]) ++k;
  const float begin = mesh.key_times[k], end = mesh.key_times[k + 1];
  return lerp(mesh.positions[k][vertex], mesh.positions[k + 1][vertex], (time - begin) / (end - begin));
}

Vec3f random_vector(std::mt19937& random, float size) {
  std::uniform_real_distribution<float> uniform(-size, size);
  const float x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

/// From `origin` at a random point, edge or vertex of a random triangle where that is at a random time or, every other
/// time, at a key's.
Ray aimed_ray(const Mesh& mesh, Vec3f origin, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  float time = uniform(random);
  if (!mesh.is_static() && random() % 2) time = mesh.key_times[random() % mesh.key_count()];
  const Triangle& triangle = mesh.triangles[random() % mesh.triangles.size()];
  const Vec3f a = vertex_at(mesh, triangle[0], time), b = vertex_at(mesh, triangle[1], time),
              c = vertex_at(mesh, triangle[2], time);
  const float u = uniform(random), v = uniform(random) * (1 - u);
  switch (random() % 3) {
    case 0:
      return {origin, a - origin};
    case 1:
      return {origin, lerp(a, b, u) - origin};
    default:
      return {origin, a + (b - a) * u + (c - a) * v - origin};
  }
}

/// Whether visible segments follow each other from 0 to 1 without a gap and without covering an instant twice.
::testing::AssertionResult fills_the_shutter(std::span<const Segment> segments) {
  double total = 0, reached = 0;
  bool joined = true;
  for (const Segment& s : segments) {
    joined = joined && s.begin == static_cast<float>(reached) && s.begin < s.end;
    reached = s.end;
    total += s.duration();
  }
  if (joined && reached == 1 && std::abs(total - 1) <= 1e-6) return ::testing::AssertionSuccess();
  std::ostringstream out;
  out.precision(9);
  out << "total " << total << "\n";
  for (const Segment& s : segments)
    out << "  [" << s.begin << ", " << s.end << ") triangle " << s.triangle << " dist " << s.dist_begin << " to "
        << s.dist_end << "\n";
  return ::testing::AssertionFailure() << out.str();
}

std::string text_of(const Ray& ray) {
  std::ostringstream out;
  out.precision(9);
  out << "ray " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z << "  " << ray.direction.x << " "
      << ray.direction.y << " " << ray.direction.z;
  return out.str();
}

void expect_closed(const Mesh& mesh, float origin_size, int rays, const TracerOptions& options, std::mt19937& random) {
  const std::vector<Mesh> meshes{mesh};
  const Tracer tracer(meshes, options);
  Tracer::Workspace workspace;
  int broken = 0;
  for (int i = 0; i < rays && broken < 5; ++i) {
    const Ray ray = aimed_ray(mesh, random_vector(random, origin_size), random);
    const auto fills = fills_the_shutter(tracer.trace(ray, Visibility::visible, workspace));
    broken += !fills;
    EXPECT_TRUE(fills) << text_of(ray) << " " << to_string(tracer.instruction_set())
                       << (options.precision == Precision::fast ? " fast" : " exact");
  }
}

Mesh make_turning_sphere(std::mt19937& random) {
  Mesh mesh = make_icosphere(3);
  animate(mesh, {0, 0.2f, 0.7f, 1}, 0.5f, 0.15f, random);
  return mesh;
}

TEST(ClosedMesh, NoGapFromInside) {
  std::mt19937 random(seed());
  const Mesh mesh = make_turning_sphere(random);
  expect_closed(mesh, 0.3f, 100000, {}, random);
}

TEST(ClosedMesh, NoGapWithAnyInstructionSetAndPrecision) {
  std::mt19937 random(seed());
  const Mesh mesh = make_turning_sphere(random);
  for (InstructionSet set : supported_instruction_sets())
    for (Precision precision : {Precision::exact, Precision::fast})
      expect_closed(mesh, 0.3f, 10000, {precision, set}, random);
}

void expect_closed_to_packets(const Mesh& mesh, InstructionSet set, std::mt19937& random) {
  const Tracer tracer(std::vector{mesh}, {Precision::fast, set});
  Tracer::Workspace workspace;
  int broken = 0;
  for (int i = 0; i < 1000 && broken < 5; ++i) {
    const Ray aimed = aimed_ray(mesh, random_vector(random, 0.3f), random);
    std::vector<Ray> rays(1 + static_cast<size_t>(i) % Tracer::kMaxPacket, aimed);
    for (size_t r = 1; r < rays.size(); ++r) rays[r].direction += random_vector(random, 0.01f);
    for (const SeenByRay& seen : tracer.trace_packet(rays, Visibility::visible, workspace)) {
      const auto fills = fills_the_shutter(seen.segments);
      broken += !fills;
      EXPECT_TRUE(fills) << text_of(aimed) << " " << rays.size() << " rays " << to_string(set);
    }
  }
}

TEST(ClosedMesh, NoGapInPackets) {
  std::mt19937 random(seed());
  const Mesh turning = make_turning_sphere(random), still = make_icosphere(3);
  for (InstructionSet set : supported_instruction_sets())
    for (const Mesh& mesh : {turning, still}) expect_closed_to_packets(mesh, set, random);
}

TEST(ClosedMesh, NoGapInWhatHardlyMovesOrStandsStill) {
  std::mt19937 random(seed());
  Mesh mesh = make_icosphere(2);
  expect_closed(mesh, 0.3f, 10000, {}, random);
  animate(mesh, {0, 1}, 1e-4f, 0, random);
  expect_closed(mesh, 0.3f, 10000, {}, random);
}

TEST(ClosedMesh, NoGapWhereRaysRunAlongPlanesEdgesAndCorners) {
  // A box whose faces, edges and corners meet rays exactly, at once or all along: every number is a small dyadic one.
  Mesh box;
  box.name = "box";
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const auto corners = [](Vec3f center, float size) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 8; ++i)
      points.push_back(center + Vec3f{i & 1 ? size : -size, i & 2 ? size : -size, i & 4 ? size : -size});
    return points;
  };
  const Vec3f moves[] = {{0, 0, 0}, {0.5f, 0, 0}, {0.25f, 0.25f, 0}, {0.25f, 0.5f, -0.25f}, {0.5f, 0.5f, 0.5f}};
  for (Vec3f move : moves)
    for (float size : {1.0f, 2.0f}) {
      box.positions = {corners(move * -1.0f, 1), corners(move, size)};
      box.key_times = {0, 1};
      if (move == Vec3f{} && size == 1) box.positions.resize(1);
      const std::vector<Mesh> meshes{box};
      for (InstructionSet set : supported_instruction_sets())
        for (Precision precision : {Precision::exact, Precision::fast}) {
          const Tracer tracer(meshes, {precision, set});
          Tracer::Workspace workspace;
          int broken = 0;
          for (int x = -4; x <= 4; ++x)
            for (int y = -4; y <= 4; ++y)
              for (int z = -4; z <= 4; ++z) {
                if (x == 0 && y == 0 && z == 0) continue;
                const Ray ray{{}, {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}};
                const auto fills = fills_the_shutter(tracer.trace(ray, Visibility::visible, workspace));
                if (!fills && ++broken < 4)
                  ADD_FAILURE() << fills.message() << text_of(ray) << " move " << move.x << " " << move.y << " "
                                << move.z << " size " << size << " " << to_string(set)
                                << (precision == Precision::fast ? " fast" : " exact");
              }
          EXPECT_EQ(broken, 0) << move.x << " " << move.y << " " << move.z << " size " << size << " " << to_string(set)
                               << (precision == Precision::fast ? " fast" : " exact");
        }
    }
}

/// Into a closed mesh a ray goes as often as it comes out: at every instant as many triangles show their front as show
/// their back, if it starts outside; one more shows its back, if it starts inside.
void expect_balanced(const Tracer& tracer, const Ray& ray, int inside, Tracer::Workspace& workspace) {
  const auto segments = tracer.trace(ray, Visibility::all, workspace);
  std::vector<std::pair<float, int>> changes;  // of backs minus fronts
  for (const Segment& s : segments) {
    changes.emplace_back(s.begin, s.front ? -1 : 1);
    changes.emplace_back(s.end, s.front ? 1 : -1);
  }
  changes.emplace_back(0.0f, 0);
  changes.emplace_back(1.0f, 0);
  std::sort(changes.begin(), changes.end());
  // Ends that belong together may differ by rounding.
  constexpr float kSameTime = 2e-6f;
  int balance = 0;
  for (size_t i = 0; i + 1 < changes.size(); ++i) {
    balance += changes[i].second;
    if (changes[i + 1].first - changes[i].first > kSameTime) {
      ASSERT_EQ(balance, inside) << "at " << (changes[i].first + changes[i + 1].first) / 2 << ", " << text_of(ray);
    }
  }
}

TEST(ClosedMesh, RaysGoInAsOftenAsTheyComeOut) {
  std::mt19937 random(seed());
  const Mesh mesh = make_turning_sphere(random);
  const std::vector<Mesh> meshes{mesh};
  for (InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(meshes, {Precision::exact, set});
    Tracer::Workspace workspace;
    for (int i = 0; i < 10000 && !::testing::Test::HasFailure(); ++i) {
      const Vec3f outside = normalize(random_vector(random, 1)) * 2.0f;
      expect_balanced(tracer, aimed_ray(mesh, outside, random), 0, workspace);
      expect_balanced(tracer, aimed_ray(mesh, random_vector(random, 0.3f), random), 1, workspace);
    }
  }
}

}  // namespace
}  // namespace kairos
