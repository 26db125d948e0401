// An instance is seen as the mesh that it stands for: by rays over time of every kind, by discrete rays, in pictures.
#include <cmath>

#include <gtest/gtest.h>

#include <kairos/make_scene.h>
#include <kairos/render.h>

#include "discrete/discrete_scene.h"
#include "gltf_builder.h"
#include "soup.h"
#include "temp_folder.h"

namespace kairos::test {
namespace {

class Placements {
 public:
  explicit Placements(uint32_t number) : random_(number) {}

  float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  std::mt19937& random() { return random_; }

  std::shared_ptr<const Mesh> object(uint32_t triangles) {
    Mesh soup = random_soup(random_, Motion::still, triangles);
    soup.positions.resize(1);
    soup.key_times.clear();
    for (Vec3f& p : soup.positions[0]) p = (p - Vec3f{0, 0, -8}) * 0.4f;
    return std::make_shared<const Mesh>(std::move(soup));
  }

  /// Of any orientation, uneven size and place; mirrored half of the time.
  AffineMap map() {
    AffineMap map;
    for (Vec4f& row : map.rows) row = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), 0};
    map.rows[0].w = uniform(-2, 2);
    map.rows[1].w = uniform(-2, 2);
    map.rows[2].w = uniform(-12, -4);
    return map;
  }

  /// Still where keys is 1; otherwise each key is some way off the first, and two of several may be a jump.
  Mesh instance(std::shared_ptr<const Mesh> object, uint32_t keys) {
    Mesh mesh;
    mesh.object = std::move(object);
    mesh.placements.push_back(map());
    for (uint32_t key = 1; key < keys; ++key) {
      AffineMap next = mesh.placements[0];
      const AffineMap other = map();
      for (size_t axis = 0; axis < 3; ++axis) {
        Vec4f &to = next.rows[axis], by = other.rows[axis];
        to = {to.x + 0.2f * by.x, to.y + 0.2f * by.y, to.z + 0.2f * by.z, to.w + uniform(-1.5f, 1.5f)};
      }
      mesh.placements.push_back(next);
    }
    if (keys < 2) return mesh;
    for (uint32_t key = 0; key < keys; ++key)
      mesh.key_times.push_back(static_cast<float>(key) / static_cast<float>(keys - 1));
    if (keys > 3 && uniform(0, 1) < 0.5f) mesh.key_times[2] = mesh.key_times[1];
    return mesh;
  }

  /// Instances that stand still and that move, and a mesh of its own among them.
  std::vector<Mesh> meshes(bool one_sided) {
    const auto small = object(5), large = object(60);
    std::vector<Mesh> meshes{random_soup(random_, Motion::deform, 20)};
    for (uint32_t i = 0; i < 24; ++i) {
      meshes.push_back(instance(i % 3 == 0 ? small : large, 1 + i % 4));
      meshes.back().one_sided = one_sided && i % 2 == 0;
    }
    return meshes;
  }

 private:
  std::mt19937 random_;
};

std::vector<Mesh> all_expanded(const std::vector<Mesh>& meshes) {
  std::vector<Mesh> result;
  for (const Mesh& mesh : meshes) result.push_back(expanded(mesh));
  return result;
}

void expect_same(std::span<const Segment> a, std::span<const Segment> b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].begin, b[i].begin);
    EXPECT_EQ(a[i].end, b[i].end);
    EXPECT_EQ(a[i].dist_begin, b[i].dist_begin);
    EXPECT_EQ(a[i].dist_end, b[i].dist_end);
    EXPECT_EQ(a[i].mesh, b[i].mesh);
    EXPECT_EQ(a[i].triangle, b[i].triangle);
    EXPECT_EQ(a[i].front, b[i].front);
  }
}

/// For how long two lists say the same.
double agreement(std::span<const Segment> a, std::span<const Segment> b) {
  double sum = 0;
  for (const Segment& s : a)
    for (const Segment& t : b)
      if (s.mesh == t.mesh && s.triangle == t.triangle && s.front == t.front)
        sum += std::max(0.0f, std::min(s.end, t.end) - std::max(s.begin, t.begin));
  return sum;
}
double duration(std::span<const Segment> segments) {
  double sum = 0;
  for (const Segment& s : segments) sum += s.duration();
  return sum;
}

TEST(Instances, GiveTheSegmentsOfExpandedMeshes) {
  Placements placements(seed());
  for (const bool one_sided : {false, true}) {
    const std::vector<Mesh> meshes = placements.meshes(one_sided), copies = all_expanded(meshes);
    for (const InstructionSet set : supported_instruction_sets())
      for (const Precision precision : {Precision::fast, Precision::exact}) {
        TracerOptions options;
        options.precision = precision;
        options.instruction_set = set;
        const Tracer instanced(meshes, options), plain(copies, options);
        EXPECT_LT(instanced.memory_bytes(), plain.memory_bytes());
        Tracer::Workspace a, b;
        double seen = 0, same = 0;
        for (int i = 0; i < 60; ++i) {
          const Ray ray = random_ray(placements.random());
          // Every triangle that is met, to the bit: what is left out, and when, does not depend on the tree.
          expect_same(instanced.trace(ray, Visibility::all, a), plain.trace(ray, Visibility::all, b));
          const auto first = instanced.trace(ray, Visibility::visible, a),
                     second = plain.trace(ray, Visibility::visible, b);
          seen += duration(second);
          same += agreement(first, second);
          EXPECT_NEAR(duration(first), duration(second), 1e-4);
          const TraceLimits limits{0.2f, 0.7f, 9};
          double covered = 0, wanted = 0;
          for (const TimeRange& range : instanced.occluded(ray, a, limits)) covered += range.end - range.begin;
          for (const TimeRange& range : plain.occluded(ray, b, limits)) wanted += range.end - range.begin;
          EXPECT_NEAR(covered, wanted, 1e-4);
        }
        // Which of two that cross is in front is decided on pieces that the tree's order may cut elsewhere.
        EXPECT_GT(same, 0.999 * seen);
        EXPECT_GT(seen, 5);
      }
  }
}

TEST(Instances, GivePacketsWhatTheyGiveSingleRays) {
  Placements placements(seed());
  const std::vector<Mesh> meshes = placements.meshes(true);
  const Tracer tracer(meshes, TracerOptions{Precision::fast, {}, nullptr, false, 0});
  Tracer::Workspace a, b;
  double seen = 0, same = 0;
  for (const size_t count : {size_t{3}, size_t{16}})
    for (int i = 0; i < 40; ++i) {
      std::vector<Ray> rays(count, random_ray(placements.random()));
      for (Ray& ray : rays)
        ray.direction += Vec3f{placements.uniform(-0.01f, 0.01f), placements.uniform(-0.01f, 0.01f), 0};
      const auto together = tracer.trace_packet(rays, Visibility::visible, a);
      for (size_t r = 0; r < count; ++r) {
        const auto alone = tracer.trace(rays[r], Visibility::visible, b);
        seen += duration(alone);
        same += agreement(together[r].segments, alone);
      }
    }
  EXPECT_GT(same, 0.998 * seen);
  EXPECT_GT(seen, 50);
}

TEST(Instances, GiveDiscreteRaysTheSameHits) {
  Placements placements(seed());
  const std::vector<Mesh> meshes = placements.meshes(true), copies = all_expanded(meshes);
  for (const int keys : {0, 5}) {
    DiscreteOptions options;
    options.keys = keys;
    const DiscreteScene instanced(meshes, options), plain(copies, options);
    std::vector<Ray> rays;
    std::vector<float> times;
    for (int i = 0; i < 1000; ++i) {
      rays.push_back(random_ray(placements.random()));
      times.push_back(placements.uniform(0, 1));
    }
    std::vector<std::optional<DiscreteHit>> first(rays.size()), second(rays.size());
    instanced.intersect(rays, times, first);
    plain.intersect(rays, times, second);
    int hits = 0, different = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      const auto alone = instanced.intersect(rays[i], times[i]);
      for (const auto& hit : {first[i], alone}) {
        hits += hit ? 1 : 0;
        const bool agrees =
            hit.has_value() == second[i].has_value() &&
            (!hit || (hit->mesh == second[i]->mesh && hit->triangle == second[i]->triangle &&
                      hit->front == second[i]->front && std::abs(hit->dist - second[i]->dist) < 1e-4f * hit->dist));
        different += agrees ? 0 : 1;
      }
    }
    EXPECT_GT(hits, 200);
    EXPECT_LE(different, 8);  // rays that graze an edge
  }
}

/// A ring of small shapes with normals, half of them mirrored, that a camera passes by.
std::shared_ptr<const Scene> ring() {
  SceneDescription scene;
  MeshDescription shape;
  shape.positions = {{{10, 10, 10}, {11, 10, 10}, {10, 11, 10}, {10, 10, 11}}};
  shape.normals = {{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  shape.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  scene.meshes.push_back(shape);
  for (int i = 0; i < 12; ++i) {
    InstanceDescription& instance = scene.instances.emplace_back();
    const double angle = i * 0.52, c = std::cos(angle), s = std::sin(angle), flip = i % 2 == 0 ? 1 : -1;
    const double x = 2 * c, y = 2 * s, moved = 0.1 * i;
    // About the shape's corner at (10, 10, 10).
    const auto matrix = [&](double shift) -> Matrix {
      return {{{c, s, 0, 0},
               {-s * flip, c * flip, 0, 0},
               {0, 0, 1, 0},
               {x + shift - 10 * (c - s * flip), y - 10 * (s + c * flip), -16, 1}}};
    };
    instance.placement = {{0, matrix(0)}, {1, matrix(i % 3 == 0 ? 0 : moved)}};
  }
  scene.cameras.push_back({});
  scene.cameras[0].keys = {{0, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {1, {0.3, 0, 0}, {0.4, 0, -1}, {0, 1, 0}}};
  scene.image_size = {48, 48};
  return make_scene(scene);
}

TEST(Instances, MakeTheSamePictures) {
  ShotOptions options;
  options.instances = ShotOptions::Instances::never;
  const Shot plain = make_shot(*ring(), options);
  options.instances = ShotOptions::Instances::always;
  const Shot instanced = make_shot(*ring(), options);
  for (size_t m = 0; m < instanced.meshes.size(); ++m) {
    ASSERT_TRUE(instanced.meshes[m].object);
    // Those that are mirrored are another object's: its triangles are turned round.
    EXPECT_EQ(instanced.meshes[m].object, instanced.meshes[m % 2].object);
  }
  for (size_t m = 0; m < plain.meshes.size(); ++m) {
    const Mesh copy = expanded(instanced.meshes[m]);
    const Mesh& mesh = plain.meshes[m];
    ASSERT_EQ(copy.triangles, mesh.triangles);
    for (size_t key = 0; key < std::min(copy.key_count(), mesh.key_count()); key += mesh.key_count() - 1)
      for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        const size_t last = key == 0 ? 0 : copy.key_count() - 1;
        EXPECT_LT(length(copy.positions[last][v] - mesh.positions[key][v]), 1e-5f);
        EXPECT_LT(length(copy.normals[copy.normals.size() == 1 ? 0 : last][v] -
                         mesh.normals[mesh.normals.size() == 1 ? 0 : key][v]),
                  1e-5f);
      }
  }
  for (const IntegratorKind integrator : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed}) {
    RenderParams params;
    params.integrator = integrator;
    params.shading = ShadingKind::normal;
    params.spp = params.tc_rays = 32;
    const Image a = render(instanced, params), b = render(plain, params);
    double difference = 0, level = 0;
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < a.channels[c].values.size(); ++i) {
        difference += std::abs(double(a.channels[c].values[i]) - double(b.channels[c].values[i]));
        level += double(b.channels[c].values[i]);
      }
    EXPECT_GT(level, 50);
    // Points along the motion lie elsewhere, as its directions are known of boxes alone: noise.
    EXPECT_LT(difference, 0.01 * level) << static_cast<int>(integrator);
  }
}

TEST(Instances, AreLeftAloneWhereTheyAreFlatOrFew) {
  SceneDescription scene;
  MeshDescription shape;
  shape.positions = {{{0, 0, -5}, {1, 0, -5}, {0, 1, -5}, {0, 0, -6}}};
  shape.triangles = {{0, 1, 2}, {0, 1, 3}};
  scene.meshes.push_back(shape);
  scene.instances.resize(3);
  scene.instances[1].placement = {{0, {{{1, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 1, 0}, {2, 0, 0, 1}}}}};  // flat
  scene.cameras.push_back({});
  scene.cameras[0].keys.push_back({});
  ShotOptions options;
  for (const Mesh& mesh : make_shot(*make_scene(scene), options).meshes) EXPECT_FALSE(mesh.object);
  options.instances = ShotOptions::Instances::always;
  const Shot shot = make_shot(*make_scene(scene), options);
  EXPECT_TRUE(shot.meshes[0].object);
  EXPECT_FALSE(shot.meshes[1].object);
  EXPECT_EQ(shot.meshes[0].object, shot.meshes[2].object);
}

TEST(Instances, AreSharedWhereCopiesAreManyForThePicture) {
  SceneDescription scene;
  MeshDescription shape;
  shape.positions.emplace_back();
  constexpr uint32_t kTriangles = 100;  // a fan
  for (uint32_t i = 0; i < kTriangles + 2; ++i) {
    const float angle = 0.01f * static_cast<float>(i);
    shape.positions[0].push_back({std::cos(angle), std::sin(angle), i % 2 == 0 ? -5.0f : -5.1f});
  }
  for (uint32_t i = 0; i < kTriangles; ++i) shape.triangles.push_back({0, i + 1, i + 2});
  scene.meshes.push_back(shape);
  scene.instances.resize(3);
  scene.cameras.push_back({});
  scene.cameras[0].keys.push_back({});
  ShotOptions options;
  options.width = 15;  // two triangles for each pixel are as many as there are
  for (const int height : {9, 10}) {
    options.height = height;
    for (const Mesh& mesh : make_shot(*make_scene(scene), options).meshes)
      EXPECT_EQ(mesh.object != nullptr, height == 9) << height;
  }
}

/// Files that place a tetrahedron three times, the third one mirrored, in each format that can say so.
std::vector<std::string> files_with_copies(const TempFolder& folder) {
  GltfBuilder gltf;
  const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<uint16_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  gltf.mesh_node(
      {{"attributes", {{"POSITION", gltf.accessor(corners, "VEC3")}}}, {"indices", gltf.accessor(indices, "SCALAR")}});
  gltf.push("nodes", {{"mesh", 0}, {"translation", {2, 0, 0}}});
  gltf.push("nodes", {{"mesh", 0}, {"translation", {4, 0, 0}}, {"scale", {-1, 1, 1}}});
  GltfBuilder copies = gltf;
  copies.root["nodes"] = nlohmann::json::array();
  copies.push("nodes",
              {{"mesh", 0},
               {"extensions",
                {{"EXT_mesh_gpu_instancing",
                  {{"attributes",
                    {{"TRANSLATION", copies.accessor(std::vector<float>{0, 0, 0, 2, 0, 0, 4, 0, 0}, "VEC3")},
                     {"SCALE", copies.accessor(std::vector<float>{1, 1, 1, 1, 1, 1, -1, 1, 1}, "VEC3")}}}}}}}});
  const std::string obj =
      folder.write("shape.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto at = [](int x, int sign) {
    return "{\"matrix\": [" + std::to_string(sign) + ",0,0,0, 0,1,0,0, 0,0,1,0, " + std::to_string(x) + ",0,0,1]}";
  };
  std::string meshes, includes;
  for (const auto& [x, sign] : {std::pair{0, 1}, std::pair{2, 1}, std::pair{4, -1}}) {
    const std::string comma = meshes.empty() ? "" : ", ";
    meshes += comma + "{\"keys\": [\"shape.obj\"], \"transform\": " + at(x, sign) + "}";
    includes += comma + "{\"file\": \"shape.obj\", \"transform\": " + at(x, sign) + "}";
  }
  const std::string pbrt =
      "Camera \"perspective\"\nWorldBegin\nObjectBegin \"a\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 "
      "0 1] "
      "\"integer indices\" [0 2 1 0 1 3 0 3 2 1 2 3]\nObjectEnd\nObjectInstance \"a\"\nTranslate 2 0 0\n"
      "ObjectInstance \"a\"\nTranslate 2 0 0\nScale -1 1 1\nObjectInstance \"a\"\n";
  return {folder.write("nodes.gltf", gltf.text()), folder.write("copies.gltf", copies.text()),
          folder.write("meshes.json", "{\"kairos\": 1, \"meshes\": [" + meshes + "]}"),
          folder.write("includes.json", "{\"kairos\": 1, \"include\": [" + includes + "]}"),
          folder.write("objects.pbrt", pbrt)};
}

TEST(Instances, AreFoundInFilesOfEveryFormat) {
  const TempFolder folder;
  for (const std::string& file : files_with_copies(folder)) {
    SCOPED_TRACE(file);
    const auto scene = load_scene({file});
    ShotOptions options;
    options.space = ShotOptions::Space::world;
    const Shot plain = make_shot(*scene, options);
    options.instances = ShotOptions::Instances::always;
    const Shot shot = make_shot(*scene, options);
    ASSERT_EQ(shot.meshes.size(), 3u);
    EXPECT_TRUE(shot.meshes[0].object);
    EXPECT_EQ(shot.meshes[0].object, shot.meshes[1].object);
    // The mirrored one has its triangles turned round, and so is the only one of its object.
    for (size_t m = 0; m < 3; ++m) {
      EXPECT_FALSE(plain.meshes[m].object);
      const Mesh copy = expanded(shot.meshes[m]);
      EXPECT_EQ(copy.triangles, plain.meshes[m].triangles);
      for (size_t v = 0; v < copy.vertex_count(); ++v)
        EXPECT_LT(length(copy.positions[0][v] - plain.meshes[m].positions[0][v]), 1e-6f);
    }
  }
}

}  // namespace
}  // namespace kairos::test
