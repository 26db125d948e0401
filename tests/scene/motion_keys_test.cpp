// Motion keys: how many, where, and how far from the truth linear motion between them is.
#include <random>

#include <gtest/gtest.h>

#include <kairos/scene.h>

#include "scene/view.h"
#include "seed.h"
#include "synthetic_scene.h"

namespace kairos {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr size_t kPoints = 30;

/// A disc of points that turns by `turn` radians about its axis, 8 m before the camera, tilted.
SceneMesh make_rotor(double turn) {
  return make_path_mesh(kPoints, [turn](size_t v, double time, Side) {
    const double angle = 2 * kPi * static_cast<double>(v * v) / kPoints + turn * time,
                 radius = 0.1 * static_cast<double>(v);
    return Vec3d{radius * std::cos(angle), radius * std::sin(angle), -8 + 0.4 * radius * std::cos(angle)};
  });
}

/// The largest distance between a mesh's linear motion and `path` (camera space) at 1000 random times, where that is on
/// screen.
double measure(const Shot& shot, const std::function<Vec3d(size_t, double)>& camera_path,
               const std::function<Vec3d(Vec3d, double)>& to_camera) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(0, 1);
  double worst = 0;
  const Mesh& mesh = shot.meshes[0];
  for (int i = 0; i < 1000; ++i) {
    const double time = uniform(random);
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3d truth = camera_path(v, time);
      const Vec2d a = project(shot.projection, truth);
      if (truth.z >= 0 || a.x < 0 || a.y < 0 || a.x > shot.projection.width || a.y > shot.projection.height) continue;
      const Vec2d b = project(shot.projection, to_camera(position_at(mesh, v, time), time));
      worst = std::max(worst, std::hypot(a.x - b.x, a.y - b.y));
    }
  }
  return worst;
}
Vec3d same_space(Vec3d p, double) { return p; }

TEST(MotionKeys, RotationStaysWithinToleranceAndKeysGrowAsItShrinks) {
  const Scene scene = make_scene(make_rotor(1.5));
  const auto path = [&](size_t v, double time) {
    return static_cast<const PathMotion&>(*scene.meshes[0].motion).path(v, time, Side::after);
  };
  size_t last_keys = 0;
  for (double tolerance : {10.0, 1.0, 0.1, 0.01}) {
    ShotOptions options;
    options.motion_tolerance = tolerance;
    const Shot shot = make_shot(scene, options);
    validate_mesh(shot.meshes[0]);
    const double error = measure(shot, path, same_space);
    EXPECT_LE(error, tolerance);
    EXPECT_GT(error, tolerance / 16) << "more keys than needed";
    EXPECT_GT(shot.meshes[0].key_count(), last_keys);
    last_keys = shot.meshes[0].key_count();
    EXPECT_EQ((last_keys - 1) & (last_keys - 2), 0u) << "2^k spans";
  }
}

TEST(MotionKeys, MotionThatCrossesItsChordInTheMiddleIsNotMissed) {
  const auto path = [](size_t v, double time) {
    return Vec3d{static_cast<double>(v % 5) + time + 0.2 * std::sin(2 * kPi * time), static_cast<double>(v % 3), -20};
  };
  Scene scene = make_scene(make_path_mesh(15, [&](size_t v, double time, Side) { return path(v, time); }));
  const Shot shot = make_shot(scene);
  EXPECT_GT(shot.meshes[0].key_count(), 2u);
  EXPECT_LE(measure(shot, path, same_space), 0.1);
}

TEST(MotionKeys, PanOfTheCamera) {
  // A chord of the circle around the eye is left by a^3 / 15.6 radians at most, a the span's angle halved: 10 degrees
  // make 0.05 pixel on 540 lines at 45 degrees, and up to 2.2 times that at the picture's corner.
  Scene scene = make_scene(make_path_mesh(kPoints, [](size_t v, double, Side) {
    const double angle = 0.05 * static_cast<double>(v);
    return Vec3d{10 * std::sin(angle), 0.1 * static_cast<double>(v % 7), -10 * std::cos(angle)};
  }));
  motion_of(scene.meshes[0]).still = true;
  const double pan = 40 * kPi / 180;
  camera_motion_of(scene).placement = [pan](double time) { return turned(-pan * time); };
  camera_motion_of(scene).still = false;
  const auto path = [&](size_t v, double time) {
    return transform_point(turned(pan * time), motion_of(scene.meshes[0]).path(v, 0, Side::after));
  };
  const Shot shot = make_shot(scene);
  EXPECT_TRUE(shot.camera_moves);
  EXPECT_GE(shot.meshes[0].key_count(), 5u);
  EXPECT_LE(shot.meshes[0].key_count(), 9u);
  EXPECT_LE(measure(shot, path, same_space), 0.1);

  ShotOptions in_world;
  in_world.space = ShotOptions::Space::world;
  EXPECT_EQ(make_shot(scene, in_world).meshes[0].key_count(), 1u);
}

TEST(MotionKeys, InWorldSpaceTheMovingCameraJudges) {
  Scene scene = make_scene(make_rotor(1.5));
  const auto placement = [](double time) { return translation({0, 0, 20 * time}) * turned(0.1 * time); };
  camera_motion_of(scene).placement = placement;
  camera_motion_of(scene).still = false;
  const auto to_camera = [&](Vec3d p, double time) { return transform_point(inverse_affine(placement(time)), p); };
  const auto path = [&](size_t v, double time) {
    return to_camera(motion_of(scene.meshes[0]).path(v, time, Side::after), time);
  };
  ShotOptions options;
  options.space = ShotOptions::Space::world;
  const Shot shot = make_shot(scene, options);
  EXPECT_LE(measure(shot, path, to_camera), 0.1);
  EXPECT_GT(measure(shot, path, to_camera), 0.1 / 16);
  const Vec3d x = shot.world_from_camera(0.7)[0];
  EXPECT_EQ(x, (Vec3d{1, 0, 0}));
}

TEST(MotionKeys, JumpHasBothSides) {
  Scene scene = make_scene(make_path_mesh(3, [](size_t v, double time, Side side) {
    const bool after = time > 0.25 || (time == 0.25 && side == Side::after);
    return Vec3d{static_cast<double>(v % 2) + time + (after ? 2 : 0), static_cast<double>(v / 2), -5};
  }));
  motion_of(scene.meshes[0]).linear = true;
  motion_of(scene.meshes[0]).all_kinks = {0.25};
  for (bool linear : {true, false}) {
    motion_of(scene.meshes[0]).linear = linear;
    const Shot shot = make_shot(scene);
    validate_mesh(shot.meshes[0]);
    EXPECT_EQ(shot.meshes[0].key_times, (std::vector<float>{0, 0.25f, 0.25f, 1}));
    EXPECT_EQ(shot.meshes[0].positions[1][0], (Vec3f{0.25f, 0, -5}));
    EXPECT_EQ(shot.meshes[0].positions[2][0], (Vec3f{2.25f, 0, -5}));
    EXPECT_EQ(shot.meshes[0].positions[3][0], (Vec3f{3, 0, -5}));
  }
}

TEST(MotionKeys, CornersAreExactAndSingle) {
  Scene scene = make_scene(make_path_mesh(3, [](size_t v, double time, Side) {
    const double x = time < 0.25 ? time : time < 0.5 ? 0.5 - time : 0;
    return Vec3d{x + static_cast<double>(v % 2), static_cast<double>(v / 2), -5};
  }));
  motion_of(scene.meshes[0]).all_kinks = {0.25, 0.5};
  for (bool linear : {true, false}) {
    motion_of(scene.meshes[0]).linear = linear;
    const Shot shot = make_shot(scene);
    EXPECT_EQ(shot.meshes[0].key_times, (std::vector<float>{0, 0.25f, 0.5f, 1}));
    EXPECT_EQ(shot.meshes[0].positions[1][0].x, 0.25f);
  }
}

TEST(MotionKeys, KinksThatFloatsCannotTellApartAreOne) {
  Scene scene = make_scene(make_path_mesh(3, [](size_t v, double time, Side) {
    return Vec3d{std::max(0.0, time - 0.5) + static_cast<double>(v % 2), static_cast<double>(v / 2), -5};
  }));
  motion_of(scene.meshes[0]).linear = true;
  motion_of(scene.meshes[0]).all_kinks = {1e-9, 0.5, 0.5 + 1e-9, 1 - 1e-9};
  const Shot shot = make_shot(scene);
  EXPECT_EQ(shot.meshes[0].key_times, (std::vector<float>{0, 0.5f, 1}));
  // Yet a long row of close kinks is not one.
  motion_of(scene.meshes[0]).all_kinks.clear();
  for (int i = 1; i < 20000; ++i) motion_of(scene.meshes[0]).all_kinks.push_back(0.25 + i * 1e-7);
  EXPECT_GT(make_shot(scene).meshes[0].key_count(), 1000u);
}

TEST(MotionKeys, NothingMovesOneKey) {
  const auto still = [](size_t v, double, Side) {
    return Vec3d{static_cast<double>(v % 2), static_cast<double>(v / 2), -5};
  };
  Scene scene = make_scene(make_path_mesh(3, still));
  EXPECT_EQ(make_shot(scene).meshes[0].key_count(), 1u) << "measured";
  motion_of(scene.meshes[0]).linear = true;
  motion_of(scene.meshes[0]).all_kinks = {0.1, 0.2};
  EXPECT_EQ(make_shot(scene).meshes[0].key_count(), 1u) << "keys that are all the same";
  motion_of(scene.meshes[0]).still = true;
  EXPECT_EQ(make_shot(scene).meshes[0].key_count(), 1u) << "known";
  camera_motion_of(scene).still = false;
  const Shot shot = make_shot(scene);
  EXPECT_FALSE(shot.camera_moves) << "a camera whose keys are all the same";
  EXPECT_EQ(shot.meshes[0].key_count(), 1u);
}

TEST(MotionKeys, AttachedToTheCameraOneKey) {
  const auto car = [](double time) { return translation({30 * time, 2 * time * time, 0}) * turned(0.5 * time); };
  Scene scene = make_scene(make_path_mesh(30, [&](size_t v, double time, Side) {
    const double x = static_cast<double>(v);
    return transform_point(car(time), {std::sin(x) + 1e-12, 0.1 * x, -x});  // vertex 0 is in the eye itself
  }));
  camera_motion_of(scene).placement = car;
  camera_motion_of(scene).still = false;
  const Shot shot = make_shot(scene);
  EXPECT_TRUE(shot.camera_moves);
  EXPECT_EQ(shot.meshes[0].key_count(), 1u);
  ShotOptions options;
  options.space = ShotOptions::Space::world;
  EXPECT_GT(make_shot(scene, options).meshes[0].key_count(), 2u);
}

TEST(MotionKeys, CameraThatOnlyTravelsNeedsTwo) {
  Scene scene = make_scene(make_path_mesh(3, [](size_t v, double, Side) {
    return Vec3d{static_cast<double>(v % 2), static_cast<double>(v / 2), -5};
  }));
  motion_of(scene.meshes[0]).still = true;
  camera_motion_of(scene).placement = [](double time) { return translation({time, 0.3 * time, -time}); };
  camera_motion_of(scene).still = false;
  const Shot shot = make_shot(scene);
  EXPECT_EQ(shot.meshes[0].key_times, (std::vector<float>{0, 1}));
  EXPECT_EQ(shot.meshes[0].positions[1][0], (Vec3f{-1, -0.3f, -4}));
}

TEST(MotionKeys, ShutterThatMissesTheKeysOrCutsThem) {
  Scene scene = make_scene(make_path_mesh(3, [](size_t v, double time, Side) {
    const double held = std::clamp(time, 0.0, 1.0);
    return Vec3d{held + static_cast<double>(v % 2), static_cast<double>(v / 2), -5};
  }));
  motion_of(scene.meshes[0]).linear = true;
  motion_of(scene.meshes[0]).all_kinks = {0, 1};
  scene.shutter = {2, 3};
  EXPECT_EQ(make_shot(scene).meshes[0].key_count(), 1u);
  scene.shutter = {0.5, 1.5};
  const Mesh cut = make_shot(scene).meshes[0];
  EXPECT_EQ(cut.key_times, (std::vector<float>{0, 0.5f, 1}));
  EXPECT_EQ(cut.positions[0][0].x, 0.5f);
  EXPECT_EQ(cut.positions[1][0].x, 1.0f);
  EXPECT_EQ(cut.positions[2][0].x, 1.0f);
  scene.shutter = {0.25, 0.75};
  const Mesh inside = make_shot(scene).meshes[0];
  EXPECT_EQ(inside.key_times, (std::vector<float>{0, 1}));
  EXPECT_EQ(inside.positions[0][0].x, 0.25f);
  EXPECT_EQ(inside.positions[1][0].x, 0.75f);
}

TEST(MotionKeys, HopelessMotionStopsAtTheLimitAndSaysSo) {
  Scene scene = make_scene(make_path_mesh(3, [](size_t v, double time, Side) {
    const double angle = 1e5 * time + static_cast<double>(v);
    return Vec3d{std::cos(angle), std::sin(angle), -5};
  }));
  const Shot shot = make_shot(scene);
  EXPECT_EQ(shot.meshes[0].key_count(), 4097u);
  validate_mesh(shot.meshes[0]);
  bool said = false;
  for (const std::string& note : shot.notes) said |= note.find("4096 spans") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(MotionKeys, PassingThroughTheEyeEnds) {
  Scene scene = make_scene(make_path_mesh(3, [](size_t v, double time, Side) {
    const double x = static_cast<double>(v);
    return Vec3d{x * (time - 0.5), 0.1 * x * std::sin(time), 10 * (time - 0.5) + 0.01 * std::cos(9 * time)};
  }));
  const Shot shot = make_shot(scene);
  validate_mesh(shot.meshes[0]);
  EXPECT_LE(shot.meshes[0].key_count(), 4097u);
}

TEST(View, ScreenDistanceIsPixelsOrALittleMore) {
  const Scene scene = make_scene(make_rotor(1));
  const Projection projection;
  const View view(scene.cameras[0], projection, ShotOptions::Space::camera, {0, 1});
  constexpr double kNear = 1e-3;
  for (int y = 0; y <= projection.height; y += 54)
    for (int x = 0; x <= projection.width; x += 96) {
      const double scale = projection.height / 2.0 / std::tan(projection.vfov / 2), depth = 3 + 0.01 * x;
      const Vec3d p{(x - 480) / scale * depth, (270 - y) / scale * depth, -depth};
      for (const Vec3d& step : {Vec3d{1e-3, 0, 0}, Vec3d{0, 1e-3, 0}, Vec3d{1e-3, -1e-3, 1e-3}}) {
        const Vec2d a = project(projection, p), b = project(projection, p + step);
        const double pixels = std::hypot(a.x - b.x, a.y - b.y), distance = view.screen_distance(p, p + step, kNear);
        EXPECT_GE(distance, 0.999 * pixels);
        EXPECT_LE(distance, 1.5 * pixels + 0.01);
      }
    }
  EXPECT_NEAR(view.screen_distance({1, 1, -7}, {1.001, 1.001, -7.007}, kNear), 0, 1e-9) << "along the view ray";
  EXPECT_TRUE(std::isinf(view.screen_distance({0, 0, -1}, {0, 0, 1}, kNear)));
  EXPECT_GT(view.screen_distance({0, 1e-9, 1}, {0.1, 0, 1}, kNear), 60) << "behind the eye";
  EXPECT_LT(view.screen_distance({0, 0, 0}, {1e-9, 0, 0}, kNear), 0.01) << "in the eye";
}

TEST(MotionKeys, OrthographicCamera) {
  Scene scene = make_scene(make_rotor(1.5));
  scene.cameras[0].orthographic = true;
  scene.cameras[0].view_height = 8;
  const auto path = [&](size_t v, double time) { return motion_of(scene.meshes[0]).path(v, time, Side::after); };
  const Shot shot = make_shot(scene);
  const double error = measure(shot, path, same_space);
  EXPECT_LE(error, 0.1);
  EXPECT_GT(error, 0.1 / 16);
}

TEST(MotionKeys, NormalsFollowOnlyWhereTheyTurn) {
  Scene scene = make_scene(make_rotor(1.5));
  motion_of(scene.meshes[0]).normal = [](size_t, double) { return Vec3f{0, 0, 1}; };
  EXPECT_EQ(make_shot(scene).meshes[0].normals.size(), 1u);
  motion_of(scene.meshes[0]).normal = [](size_t, double time) {
    return to_float(Vec3d{std::cos(1.5 * time), std::sin(1.5 * time), 0});
  };
  const Mesh mesh = make_shot(scene).meshes[0];
  ASSERT_EQ(mesh.normals.size(), mesh.key_count());
  EXPECT_EQ(mesh.normals.back()[0], to_float(Vec3d{std::cos(1.5), std::sin(1.5), 0}));
}

TEST(MotionKeys, SameForAnyNumberOfThreads) {
  constexpr size_t kMany = 120000;  // several blocks of vertices
  Scene scene = make_scene(make_path_mesh(kMany, [](size_t v, double time, Side) {
    const double angle = static_cast<double>(v) + time, radius = 1 + 1e-5 * static_cast<double>(v);
    return Vec3d{radius * std::cos(angle), radius * std::sin(angle), -8};
  }));
  for (int i = 0; i < 20; ++i) scene.meshes.push_back(make_rotor(0.1 * i));
  ShotOptions options;
  options.threads = 1;
  const Shot one = make_shot(scene, options);
  options.threads = 2;
  const Shot two = make_shot(scene, options);
  ASSERT_EQ(one.meshes.size(), two.meshes.size());
  for (size_t m = 0; m < one.meshes.size(); ++m) {
    EXPECT_EQ(one.meshes[m].key_times, two.meshes[m].key_times);
    EXPECT_TRUE(one.meshes[m].positions == two.meshes[m].positions);
  }
  EXPECT_EQ(one.notes, two.notes);
}

}  // namespace
}  // namespace kairos
