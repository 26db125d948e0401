// What make_shot does besides choosing motion keys: shutter, cameras, framing, bad triangles, notes.
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/scene.h>

#include "synthetic_scene.h"

namespace kairos {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

SceneMesh make_still_triangle() {
  SceneMesh mesh = make_path_mesh(3, [](size_t v, double, Side) {
    return Vec3d{static_cast<double>(v % 2), static_cast<double>(v / 2), -5};
  });
  motion_of(mesh).still = true;
  return mesh;
}

template <class Body>
std::string message_of(ErrorCode code, const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code);
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

TEST(Shutter, OwnFrameAndDefault) {
  Scene scene = make_scene(make_still_triangle());
  scene.shutter = {3, 4};
  Shot shot = make_shot(scene);
  EXPECT_EQ(shot.shutter_open, 3);
  EXPECT_EQ(shot.shutter_close, 4);

  ShotOptions options;
  options.frame = 12;
  shot = make_shot(scene, options);  // 24 frames per unit of time, open for half a frame
  EXPECT_DOUBLE_EQ(shot.shutter_open, 0.5);
  EXPECT_DOUBLE_EQ(shot.shutter_close, 12.5 / 24);
  options.fps = 10;
  options.shutter = {-0.25, 0.25};
  shot = make_shot(scene, options);
  EXPECT_DOUBLE_EQ(shot.shutter_open, 1.175);
  EXPECT_DOUBLE_EQ(shot.shutter_close, 1.225);

  scene.shutter.reset();
  scene.fps = 48;
  shot = make_shot(scene);
  EXPECT_EQ(shot.shutter_open, 0);
  EXPECT_DOUBLE_EQ(shot.shutter_close, 0.5 / 48);
}

// Everything turns, kinks and jumps; at one instant it is where it is from then on.
TEST(Shutter, OfNoLengthShowsOneInstant) {
  const auto place = [](size_t v, double time, Side side) {
    const double jump = time > 2 || (time == 2 && side == Side::after) ? 10 : 0;
    return Vec3d{std::cos(time) + static_cast<double>(v % 2) + jump, std::sin(time) + static_cast<double>(v / 2), -5};
  };
  Scene scene = make_scene(make_path_mesh(3, place));
  motion_of(scene.meshes[0]).all_kinks = {2};
  motion_of(scene.meshes[0]).normal = [](size_t, double time) {
    return Vec3f{std::sin(static_cast<float>(time)), 0, std::cos(static_cast<float>(time))};
  };
  camera_motion_of(scene).still = false;
  camera_motion_of(scene).placement = [](double time) { return turned(time); };
  for (const double time : {0.0, 1.5, 2.0}) {
    scene.shutter = {time, time};
    const Shot shot = make_shot(scene);
    EXPECT_EQ(shot.shutter_open, time);
    EXPECT_EQ(shot.shutter_close, time);
    EXPECT_FALSE(shot.camera_moves);
    const Mesh& mesh = shot.meshes.at(0);
    ASSERT_TRUE(mesh.is_static());
    EXPECT_EQ(mesh.normals.at(0).at(0),
              (Vec3f{std::sin(static_cast<float>(time)), 0, std::cos(static_cast<float>(time))}));
    const Mat4 camera = inverse_affine(turned(time));
    for (size_t v = 0; v < 3; ++v)
      EXPECT_EQ(mesh.positions[0][v], to_float(transform_point(camera, place(v, time, Side::after))));
    for (const double when : {0.0, 0.5, 1.0})
      EXPECT_EQ(shot.world_from_camera(when), make_shot(scene).world_from_camera(0)) << "a camera at rest";
  }
}

TEST(Shutter, NonsenseIsRefused) {
  Scene scene = make_scene(make_still_triangle());
  ShotOptions options;
  options.shutter = {0.5, 0.25};
  EXPECT_THAT(message_of(ErrorCode::bad_usage, [&] { make_shot(scene, options); }), HasSubstr("shutter"));
  options.shutter = {0, kNan};
  message_of(ErrorCode::bad_usage, [&] { make_shot(scene, options); });
  options.shutter = {0, 1};
  options.frame = 1e300;
  message_of(ErrorCode::bad_usage, [&] { make_shot(scene, options); });
  options.frame = 0;
  for (double fps : {0.0, -24.0, kNan}) {
    options.fps = fps;
    message_of(ErrorCode::bad_usage, [&] { make_shot(scene, options); });
  }
  options = {};
  for (double tolerance : {0.0, -1.0, kNan}) {
    options.motion_tolerance = tolerance;
    message_of(ErrorCode::bad_usage, [&] { make_shot(scene, options); });
  }
  options = {};
  options.width = -5;
  message_of(ErrorCode::bad_usage, [&] { make_shot(scene, options); });
}

TEST(OneSided, AsTheMaterialSaysUnlessLightGoesThroughIt) {
  Scene scene = make_scene(make_still_triangle());
  const auto is_one_sided = [&](bool double_sided, float transmission) {
    scene.materials.assign(1, Material{});
    scene.materials[0].double_sided = double_sided;
    scene.materials[0].transmission = transmission;
    return make_shot(scene).meshes.at(0).one_sided;
  };
  EXPECT_FALSE(is_one_sided(true, 0));
  EXPECT_TRUE(is_one_sided(false, 0));
  EXPECT_FALSE(is_one_sided(false, 0.5f)) << "the border of a body of glass has two sides";
}

TEST(Camera, ByNameOrIndex) {
  Scene scene = make_scene(make_still_triangle());
  SceneCamera second = scene.cameras[0];
  second.name = "side";
  second.vfov = 1;
  scene.cameras.push_back(second);
  ShotOptions options;
  options.camera = "side";
  EXPECT_EQ(make_shot(scene, options).projection.vfov, 1);
  options.camera = "1";
  EXPECT_EQ(make_shot(scene, options).projection.vfov, 1);
  for (const char* wrong : {"top", "2", "-1", "1x"}) {
    options.camera = wrong;
    const std::string message = message_of(ErrorCode::bad_usage, [&] { make_shot(scene, options); });
    EXPECT_THAT(message, HasSubstr(wrong));
    EXPECT_THAT(message, HasSubstr("0 'main', 1 'side'"));
  }
  scene.cameras[0].vfov = kNan;
  message_of(ErrorCode::bad_input, [&] { make_shot(scene); });
  scene.cameras[0].vfov = 1;
  camera_motion_of(scene).placement = [](double) { return scaling({1, 0, 1}); };
  EXPECT_THAT(message_of(ErrorCode::bad_input, [&] { make_shot(scene); }), HasSubstr("camera 'main'"));
}

TEST(Camera, RotationAndImageSize) {
  Scene scene = make_scene(make_still_triangle());
  camera_motion_of(scene).placement = [](double time) { return translation({1, 2, 3}) * turned(time); };
  camera_motion_of(scene).still = false;
  scene.image_size = {320, 200};
  ShotOptions options;
  options.height = 100;
  const Shot shot = make_shot(scene, options);
  EXPECT_EQ(shot.projection.width, 320);
  EXPECT_EQ(shot.projection.height, 100);
  const Vec3d z = shot.world_from_camera(0.5)[2];
  EXPECT_NEAR(z.x, std::sin(0.5), 1e-12);
  EXPECT_NEAR(z.z, std::cos(0.5), 1e-12);
  EXPECT_EQ(make_shot(make_scene(make_still_triangle())).projection.height, 540);
}

TEST(MakeShot, SaysWhenTheShutterMissesTheAnimation) {
  Scene scene = make_scene(make_still_triangle());
  scene.animations = {{"rest", {{0.0, 100.0}}, false}, {"walk", {{2.0, 3.0}}, true}, {"run", {{2.5, 4.0}}, true}};
  scene.notes = {"chosen"};
  const auto notes = [&](double open, double close) {
    ShotOptions options;
    options.fps = 1;
    options.shutter = {open, close};
    return make_shot(scene, options).notes;
  };
  EXPECT_THAT(notes(0, 1), Contains(HasSubstr("open before the animation, which runs from 2 to 4")));
  EXPECT_THAT(notes(0, 2), Contains(HasSubstr("before the animation")));
  EXPECT_THAT(notes(4, 5), Contains(HasSubstr("after the animation")));
  for (const auto& [open, close] : {std::pair{1.0, 2.5}, {3.5, 5.0}, {2.0, 2.0}, {1.0, 6.0}})
    EXPECT_THAT(notes(open, close), testing::Not(Contains(HasSubstr("the animation")))) << open << " " << close;
  EXPECT_THAT(notes(0, 1), Contains("chosen"));
  scene.animations[2].range.reset();
  EXPECT_THAT(notes(0, 1), testing::Not(Contains(HasSubstr("the animation")))) << "who knows when it runs?";
}

/// Everything is on screen, and fills a good part of it in at least one direction.
void expect_framed(Scene scene, int width, int height) {
  scene.cameras.clear();
  ShotOptions options;
  options.width = width;
  options.height = height;
  const Shot shot = make_shot(scene, options);
  EXPECT_THAT(shot.notes, Contains(HasSubstr("no camera")));
  Vec2d lower{1e9, 1e9}, upper{-1e9, -1e9};
  for (int i = 0; i <= 500; ++i)
    for (const Mesh& mesh : shot.meshes)
      for (const Triangle& triangle : mesh.triangles)
        for (uint32_t v : triangle) {
          const Vec3d p = position_at(mesh, v, i / 500.0);
          ASSERT_LT(p.z, 0);
          const Vec2d on_screen = project(shot.projection, p);
          lower = {std::min(lower.x, on_screen.x), std::min(lower.y, on_screen.y)};
          upper = {std::max(upper.x, on_screen.x), std::max(upper.y, on_screen.y)};
        }
  EXPECT_GE(lower.x, 0);
  EXPECT_GE(lower.y, 0);
  EXPECT_LE(upper.x, width);
  EXPECT_LE(upper.y, height);
  EXPECT_GT(std::max((upper.x - lower.x) / width, (upper.y - lower.y) / height), 0.8);
}

TEST(Framing, MovingThingsStayOnScreen) {
  const auto orbit = [](size_t v, double time, Side) {
    const double angle = 5 * time, x = static_cast<double>(v);
    return Vec3d{1000 + 3 * std::cos(angle) + 0.2 * std::sin(x), 50 + 3 * std::sin(angle) + 0.2 * std::cos(x),
                 -70 + time + 0.1 * x};
  };
  SceneMesh far_vertex = make_still_triangle();  // a vertex that no triangle uses does not count
  motion_of(far_vertex).vertices = 4;
  motion_of(far_vertex).path = [](size_t v, double, Side) {
    return v == 3 ? Vec3d{1e6, 0, 0} : Vec3d{1000 + static_cast<double>(v % 2), 50 + static_cast<double>(v / 2), -70};
  };
  Scene scene = make_scene(make_path_mesh(30, orbit));
  scene.meshes.push_back(far_vertex);
  expect_framed(scene, 960, 540);
  expect_framed(scene, 300, 900);
  Scene flat = make_scene(make_path_mesh(3, [](size_t v, double, Side) {
    return Vec3d{static_cast<double>(v) * 0.55, static_cast<double>(v * v) * 0.4, static_cast<double>(v)};
  }));
  expect_framed(flat, 960, 540);
}

TEST(Framing, NothingToSeeIsNoError) {
  Scene empty;
  empty.materials.emplace_back();
  EXPECT_TRUE(make_shot(empty).meshes.empty());
  Scene point = make_scene(make_path_mesh(3, [](size_t, double, Side) { return Vec3d{1e5, 2, 3}; }));
  point.cameras.clear();
  const Shot shot = make_shot(point);
  EXPECT_TRUE(shot.meshes[0].triangles.empty());
  const Vec3f p = shot.meshes[0].positions[0][0];
  EXPECT_LT(p.z, 0);
  EXPECT_NEAR(p.x / p.z, 0, 1e-3);
  Scene lost = make_scene(make_path_mesh(3, [](size_t, double, Side) { return Vec3d{kNan, 2, 3}; }));
  lost.cameras.clear();
  EXPECT_TRUE(make_shot(lost).meshes[0].triangles.empty());
}

TEST(BadTriangles, AreDroppedCountedAndReportedOnce) {
  // Triangles 0 and 4 are fine; 1 has a NaN at late times only, 2 no area ever, 3 the same vertex twice, 4 no area at
  // both keys but some in between, 5 is infinite in float only.
  SceneMesh mesh = make_path_mesh(18, [](size_t v, double time, Side) {
    const double corner = static_cast<double>(v % 3);
    switch (v / 3) {
      case 1:
        return Vec3d{v == 4 && time > 0.75 ? kNan : corner, corner * corner, -5};
      case 2:
        return Vec3d{corner + time, 2 * corner, -5};
      case 4:
        return Vec3d{corner * (1 - time), corner == 2 ? 3 * time : corner * time, -5};
      case 5:
        return Vec3d{corner, corner == 2 ? 1e39 : 0, -5};
      default:
        return Vec3d{corner, corner * corner, -5 - time};
    }
  });
  mesh.triangles.edit()[3] = {9, 9, 11};
  motion_of(mesh).linear = true;
  Scene scene = make_scene(mesh);
  scene.meshes.push_back(make_still_triangle());
  scene.meshes[0].name = "broken";
  const Shot shot = make_shot(scene);
  const Mesh& cleaned = shot.meshes[0];
  validate_mesh(cleaned);
  EXPECT_EQ(cleaned.triangles.size(), 2u);
  EXPECT_EQ(cleaned.prim_id(0), 0u);
  EXPECT_EQ(cleaned.prim_id(1), 4u);
  EXPECT_EQ(cleaned.triangles[1], (Triangle{12, 13, 14}));
  EXPECT_THAT(shot.notes, Contains("dropped 4 bad triangles (2 not finite, 2 of zero area), first in mesh 'broken'"));

  scene.meshes[0].prim_ids = std::vector<uint32_t>{10, 11, 12, 13, 14, 15};
  EXPECT_EQ(make_shot(scene).meshes[0].prim_id(1), 14u);
  ShotOptions strict;
  strict.strict = true;
  EXPECT_THAT(message_of(ErrorCode::bad_input, [&] { make_shot(scene, strict); }), HasSubstr("mesh 'broken'"));
}

TEST(Notes, TellKeysAndWarnings) {
  Scene scene = make_scene(make_still_triangle());
  scene.warnings = {"a feature is left out"};
  SceneMesh mover = make_path_mesh(3, [](size_t v, double time, Side) {
    return Vec3d{static_cast<double>(v % 2) + time, static_cast<double>(v / 2), -5};
  });
  mover.name = "mover";
  scene.meshes.push_back(mover);
  const Shot shot = make_shot(scene);
  EXPECT_THAT(shot.warnings, Contains("a feature is left out"));
  EXPECT_THAT(shot.notes, testing::Not(Contains("a feature is left out"))) << "said twice";
  EXPECT_THAT(shot.notes, Contains("1 of 2 meshes move: 1 with 2 keys (most: 'mover')"));
}

}  // namespace
}  // namespace kairos
