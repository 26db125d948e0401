// Animations, the node graph, skins and morph targets of glTF, against answers worked out by hand.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

using testing::HasSubstr;

const double kPi = std::acos(-1.0);
const float kHalf = std::sqrt(0.5f);

void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-6) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(GltfAnimation, LinearRotationIsASlerpAlongTheShortestArc) {
  for (const float sign : {1.0f, -1.0f}) {  // q and -q are the same rotation
    GltfBuilder gltf;
    const int node = gltf.triangle_node({1, 0, 0, 0, 0, 0, 0, 0, 1});
    gltf.animate(node, "rotation", {0, 2}, {0, 0, 0, 1, 0, 0, sign * kHalf, sign * kHalf}, "VEC4");  // 90 degrees, z
    const Scene scene = gltf.parse();
    for (const double time : {0.0, 0.5, 1.0, 1.7, 2.0}) {
      const double angle = kPi / 2 * time / 2;
      expect_near(positions_at(scene, time)[0], {std::cos(angle), std::sin(angle), 0});
    }
    const VertexMotion& motion = *scene.meshes[0].motion;
    EXPECT_FALSE(motion.is_linear_between_kinks());
    EXPECT_FALSE(motion.is_static(0.5, 0.6));
    EXPECT_TRUE(motion.is_static(2, 5)) << "after the last key it holds still";
  }
}

TEST(GltfAnimation, CubicSplineIsTheHermiteFormula) {
  GltfBuilder gltf;
  const int node = gltf.triangle_node();
  // Keys at 1 and 3 seconds: [in-tangent, value, out-tangent] each.
  gltf.animate(node, "translation", {1, 3}, {9, 9, 9, 1, 2, 3, 4, 0, -1, -2, 1, 0, 5, 5, 5, 9, 9, 9}, "VEC3",
               "CUBICSPLINE");
  const Scene scene = gltf.parse();
  const Vec3d p0{1, 2, 3}, m0{4, 0, -1}, m1{-2, 1, 0}, p1{5, 5, 5};
  for (const double time : {1.0, 1.3, 2.0, 2.9, 3.0}) {
    const double s = (time - 1) / 2;
    // The same curve by de Casteljau over its Bezier points: another route to it than the one in the code.
    const Vec3d b0 = p0, b1 = p0 + m0 * (2.0 / 3), b2 = p1 - m1 * (2.0 / 3), b3 = p1;
    const Vec3d c0 = lerp(b0, b1, s), c1 = lerp(b1, b2, s), c2 = lerp(b2, b3, s);
    expect_near(positions_at(scene, time)[0], lerp(lerp(c0, c1, s), lerp(c1, c2, s), s));
  }
  expect_near(positions_at(scene, 0)[0], p0);
  expect_near(positions_at(scene, 99)[0], p1);
}

TEST(GltfAnimation, StepJumpsAtItsKeys) {
  GltfBuilder gltf;
  const int node = gltf.triangle_node();
  gltf.animate(node, "translation", {1, 2}, {5, 0, 0, 7, 0, 0}, "VEC3", "STEP");
  const Scene scene = gltf.parse();
  const auto x = [&](double time, Side side) { return positions_at(scene, time, side)[0].x; };
  EXPECT_EQ(x(0, Side::before), 5);
  EXPECT_EQ(x(1, Side::before), 5) << "the first key is no jump";
  EXPECT_EQ(x(1.999, Side::after), 5);
  EXPECT_EQ(x(2, Side::before), 5);
  EXPECT_EQ(x(2, Side::after), 7);
  EXPECT_EQ(x(3, Side::before), 7);
  const VertexMotion& motion = *scene.meshes[0].motion;
  EXPECT_TRUE(motion.is_linear_between_kinks());
  EXPECT_EQ(motion.kinks(0, 3), (std::vector<double>{1, 2}));
  EXPECT_EQ(motion.kinks(1, 2), std::vector<double>{}) << "kinks lie strictly inside";
  EXPECT_TRUE(motion.is_static(0, 1.5));
  EXPECT_TRUE(motion.is_static(2, 4));
  EXPECT_FALSE(motion.is_static(1.5, 2.5));
}

TEST(GltfAnimation, LinearTranslationHoldsOutsideOfItsKeys) {
  GltfBuilder gltf;
  const int node = gltf.triangle_node();
  gltf.animate(node, "translation", {1, 2, 4}, {0, 0, 0, 2, 0, 0, 2, 8, 0}, "VEC3");
  const Scene scene = gltf.parse();
  expect_near(positions_at(scene, -1)[0], {0, 0, 0});
  expect_near(positions_at(scene, 1.25)[0], {0.5, 0, 0});
  expect_near(positions_at(scene, 3)[0], {2, 4, 0});
  expect_near(positions_at(scene, 10)[0], {2, 8, 0});
  const VertexMotion& motion = *scene.meshes[0].motion;
  EXPECT_TRUE(motion.is_linear_between_kinks());
  EXPECT_EQ(motion.kinks(0, 4), (std::vector<double>{1, 2}));
}

TEST(GltfAnimation, TwoKeysAtOneTimeAreAJump) {
  GltfBuilder gltf;
  const int node = gltf.triangle_node();
  gltf.animate(node, "translation", {0, 1, 1, 2}, {0, 0, 0, 1, 0, 0, 5, 0, 0, 7, 0, 0}, "VEC3");
  const Scene scene = gltf.parse();
  expect_near(positions_at(scene, 1, Side::before)[0], {1, 0, 0});
  expect_near(positions_at(scene, 1, Side::after)[0], {5, 0, 0});
  EXPECT_EQ(scene.meshes[0].motion->kinks(0, 2), std::vector<double>{1});
}

TEST(GltfAnimation, OnlyMotionThatAddsUpIsCalledLinear) {
  // A parent that scales carries a child that moves: the product is quadratic. Two translations only add.
  for (const bool parent_scales : {false, true}) {
    GltfBuilder gltf;
    const int child = gltf.triangle_node();
    const int parent = gltf.push("nodes", {{"children", {child}}});
    gltf.animate(child, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
    gltf.animate(parent, parent_scales ? "scale" : "translation", {0, 1}, {1, 1, 1, 3, 1, 1}, "VEC3");
    const Scene scene = gltf.parse();
    EXPECT_EQ(scene.meshes[0].motion->is_linear_between_kinks(), !parent_scales);
    const double middle = positions_at(scene, 0.5)[0].x;
    const double mean = (positions_at(scene, 0)[0].x + positions_at(scene, 1)[0].x) / 2;
    EXPECT_EQ(std::abs(middle - mean) < 1e-6, !parent_scales);
  }
}

TEST(GltfAnimation, MatricesAndTrsComposeDownTheGraph) {
  GltfBuilder gltf;
  const int leaf = gltf.triangle_node({1, 0, 0, 0, 0, 0, 0, 1, 0}, {{"scale", {2, 3, 4}}, {"translation", {0, 0, 1}}});
  gltf.push("nodes", {{"children", {leaf}}, {"rotation", {0, 0, kHalf, kHalf}}});
  gltf.push("nodes", {{"children", {1}}, {"matrix", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 10, 20, 30, 1}}});  // x <-> z
  const Scene scene = gltf.parse();
  // (1,0,0) -> (2,0,1) -> turned (0,2,1) -> swapped (1,2,0) -> moved
  expect_near(positions_at(scene, 0)[0], {11, 22, 30});
}

GltfBuilder two_joint_skin(const std::vector<float>& weights) {
  GltfBuilder gltf;
  gltf.mesh_node({{"attributes",
                   {{"POSITION", gltf.accessor<float>({0, 0, 0, 0, 1, 0, 0, 2, 0}, "VEC3")},
                    {"JOINTS_0", gltf.accessor<uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4")},
                    {"WEIGHTS_0", gltf.accessor<float>(weights, "VEC4")}}}},
                 {{"skin", 0}, {"translation", {100, 100, 100}}});  // which skinned meshes ignore
  gltf.push("nodes", {{"children", {2}}, {"name", "hip"}});
  gltf.push("nodes", {{"translation", {0, 1, 0}}, {"name", "knee"}});
  const std::vector<float> bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  gltf.push("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", gltf.accessor(bind, "MAT4")}});
  gltf.animate(2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf}, "VEC4");
  gltf.root["scenes"] = {{{"nodes", {0, 1}}}};
  return gltf;
}

TEST(GltfAnimation, ASkinBlendsTheMatricesOfItsJoints) {
  const Scene scene = two_joint_skin({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0}).parse();
  const auto rest = positions_at(scene, 0);
  expect_near(rest[0], {0, 0, 0});
  expect_near(rest[1], {0, 1, 0});
  expect_near(rest[2], {0, 2, 0});
  const auto bent = positions_at(scene, 1);  // the knee at (0, 1, 0) turned by 90 degrees
  expect_near(bent[0], {0, 0, 0});
  expect_near(bent[1], {0, 1, 0});
  expect_near(bent[2], {-1, 1, 0});
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfAnimation, SkinWeightsAreNormalisedAndNeverNan) {
  const Scene scene =
      two_joint_skin({4, 0, 0, 0, 0, 0, 0, 0, -1, 3, std::numeric_limits<float>::quiet_NaN(), INFINITY}).parse();
  const auto bent = positions_at(scene, 1);
  expect_near(bent[0], {0, 0, 0});   // 4 counts as 1
  expect_near(bent[1], {0, 1, 0});   // without weight: follows its first joint
  expect_near(bent[2], {-1, 1, 0});  // what is negative or not finite counts as 0
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfAnimation, JointsOutOfRangeAreAnError) {
  GltfBuilder gltf = two_joint_skin({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0});
  gltf.root["skins"][0]["joints"] = {1};
  EXPECT_THROW(gltf.parse(), Error);
}

TEST(GltfAnimation, MorphWeightsMovePositionsAndNormals) {
  GltfBuilder gltf;
  const auto vec3 = [&](const std::vector<float>& v) { return gltf.accessor(v, "VEC3"); };
  nlohmann::json primitive;
  primitive["attributes"] = {{"POSITION", vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})},
                             {"NORMAL", vec3({0, 0, 1, 0, 0, 1, 0, 0, 1})}};
  primitive["targets"] = {
      {{"POSITION", vec3({0, 0, 2, 0, 0, 0, 0, 0, 0})}, {"NORMAL", vec3({1, 0, -1, 0, 0, 0, 0, 0, 0})}},
      {{"POSITION", vec3({0, 4, 0, 0, 0, 0, 0, 0, 0})}}};
  const int node = gltf.mesh_node(primitive);
  gltf.root["meshes"][0]["weights"] = {0.5, 0.25};
  const Scene rest = gltf.parse();
  expect_near(positions_at(rest, 0)[0], {0, 1, 1});
  expect_near(to_double(normals_at(rest, 0)[0]), {std::sqrt(0.5), 0, std::sqrt(0.5)});

  gltf.animate(node, "weights", {0, 2}, {0, 0, 1, 3}, "SCALAR");
  const Scene scene = gltf.parse();
  expect_near(positions_at(scene, 0)[0], {0, 0, 0});
  expect_near(positions_at(scene, 1)[0], {0, 6, 1});
  expect_near(positions_at(scene, 2)[0], {0, 12, 2});
  expect_near(to_double(normals_at(scene, 2)[0]), {1, 0, 0});
  EXPECT_TRUE(scene.meshes[0].motion->is_linear_between_kinks());

  gltf.root["nodes"][0]["weights"] = {1, 0};
  gltf.root.erase("animations");
  expect_near(positions_at(gltf.parse(), 0)[0], {0, 0, 2});
}

TEST(GltfAnimation, IsPickedByNameOrIndex) {
  GltfBuilder gltf;
  const int node = gltf.triangle_node();
  gltf.animate(node, "translation", {0}, {1, 0, 0}, "VEC3");
  gltf.root["animations"][0]["name"] = "walk";
  nlohmann::json run = gltf.root["animations"][0];
  run["name"] = "run";
  run["samplers"][0]["output"] = gltf.accessor<float>({2, 0, 0}, "VEC3");
  gltf.push("animations", run);
  const auto x = [&](const std::string& animation) {
    LoadOptions options;
    options.animation = animation;
    return positions_at(gltf.parse(options), 0)[0].x;
  };
  EXPECT_EQ(x(""), 1);
  EXPECT_EQ(x("walk"), 1);
  EXPECT_EQ(x("run"), 2);
  EXPECT_EQ(x("1"), 2);
  EXPECT_EQ(x("none"), 0);
  try {
    x("jump");
    FAIL() << "there is no such animation";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("'walk', 'run'"), std::string::npos) << error.what();
  }
}

/// Exporters write one animation for each object.
TEST(GltfAnimation, AllPlayTogetherAndOfTwoThatMoveTheSameTheFirst) {
  GltfBuilder gltf;
  const int left = gltf.triangle_node(), right = gltf.triangle_node();
  gltf.animate(left, "translation", {0, 2}, {1, 0, 0, 1, 0, 0}, "VEC3");
  nlohmann::json other = gltf.root["animations"][0];
  gltf.root["animations"][0]["name"] = "left";
  other["name"] = "right";
  other["samplers"][0]["output"] = gltf.accessor<float>({2, 0, 0, 2, 0, 0}, "VEC3");
  other["channels"][0]["target"]["node"] = right;
  gltf.push("animations", other);
  gltf.root["accessors"][1]["min"] = {0};  // of the key times
  LoadOptions options;
  Scene one = gltf.parse();
  EXPECT_EQ(positions_at(one, 0, Side::after, 1)[0].x, 0);
  ASSERT_EQ(one.notes.size(), 1u);
  EXPECT_THAT(one.notes[0], HasSubstr("of 2 animations the first plays; not 'right'"));
  EXPECT_TRUE(one.animations.at(0).plays);
  EXPECT_FALSE(one.animations.at(1).plays);
  options.animation = "all";
  options.strict = true;
  Scene all = gltf.parse(options);
  EXPECT_EQ(positions_at(all, 0)[0].x, 1);
  EXPECT_EQ(positions_at(all, 0, Side::after, 1)[0].x, 2);
  EXPECT_TRUE(all.notes.empty());
  gltf.root["animations"][1]["channels"][0]["target"]["node"] = left;
  EXPECT_THROW(gltf.parse(options), Error);
  options.strict = false;
  all = gltf.parse(options);
  EXPECT_EQ(positions_at(all, 0)[0].x, 1);
  EXPECT_THAT(all.warnings, testing::ElementsAre(HasSubstr("goes as the first of them says")));
  gltf.root["animations"][0]["name"] = "all";
  EXPECT_FALSE(gltf.parse(options).animations.at(1).plays) << "a name of the file's own goes first";
}

TEST(GltfAnimation, SaysWhenItRuns) {
  GltfBuilder gltf;
  gltf.animate(gltf.triangle_node(), "translation", {10, 12.5}, {1, 0, 0, 1, 0, 0}, "VEC3");
  EXPECT_FALSE(gltf.parse().animations.at(0).range) << "the file has to";
  const int times = gltf.root["animations"][0]["samplers"][0]["input"];
  gltf.root["accessors"][static_cast<size_t>(times)]["min"] = {10};
  gltf.root["accessors"][static_cast<size_t>(times)]["max"] = {12.5};
  EXPECT_EQ(gltf.parse().animations.at(0).range, (std::array{10.0, 12.5}));
}

TEST(GltfAnimation, PointersMoveNodesAndAreNamedOtherwise) {
  GltfBuilder gltf;
  gltf.animate(gltf.triangle_node(), "translation", {0, 1}, {1, 0, 0, 1, 0, 0}, "VEC3");
  nlohmann::json& target = gltf.root["animations"][0]["channels"][0]["target"];
  const auto point = [&](const std::string& pointer) {
    target = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
    return gltf.parse();
  };
  EXPECT_EQ(positions_at(point("/nodes/0/translation"), 0)[0].x, 1);
  EXPECT_THAT(point("/nodes/0/translation").warnings, testing::IsEmpty());
  EXPECT_THAT(point("/nodes/12/extensions/KHR_node_visibility/visible").warnings,
              testing::ElementsAre(HasSubstr("'/nodes/N/extensions/KHR_node_visibility/visible' is left out")));
  EXPECT_THAT(point("/materials/0/emissiveFactor").warnings, testing::ElementsAre(HasSubstr("/materials/N/")));
  EXPECT_THROW(point("/nodes/7/translation"), Error);
}

TEST(GltfAnimation, BadKeysAreAnError) {
  const auto parse = [](const std::vector<float>& times, const std::vector<float>& values) {
    GltfBuilder gltf;
    const int node = gltf.triangle_node();
    gltf.animate(node, "translation", times, values, "VEC3");
    return gltf.parse();
  };
  EXPECT_NO_THROW(parse({0, 1}, {0, 0, 0, 1, 1, 1}));
  EXPECT_THROW(parse({1, 0}, {0, 0, 0, 1, 1, 1}), Error) << "times descend";
  EXPECT_THROW(parse({0, std::nanf("")}, {0, 0, 0, 1, 1, 1}), Error);
  EXPECT_THROW(parse({0, 1}, {0, 0, 0, INFINITY, 1, 1}), Error);
  EXPECT_THROW(parse({0, 1}, {0, 0, 0}), Error) << "one value too few";
  EXPECT_THROW(parse({}, {}), Error);
}

}  // namespace
}  // namespace kairos
