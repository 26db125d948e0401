// The node test against exact answers: never narrower, and hardly wider.
#include "kernels/moving_box_test.h"

#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kernels/dispatch.h"
#include "oracle.h"
#include "seed.h"
#include "temp_folder.h"

namespace kairos {
namespace {

struct BoxCase {
  Ray ray;
  Vec3f lower[2], upper[2];
  std::optional<std::array<double, 2>> time;  ///< exact
  bool ill = false;                           ///< a miss by less than 1e-6
};

/// Exact up to double rounding; checked against rational arithmetic below.
std::optional<BoxInterval> reference(const BoxCase& c) {
  const Vec3d lower[2] = {to_double(c.lower[0]), to_double(c.lower[1])};
  const Vec3d upper[2] = {to_double(c.upper[0]), to_double(c.upper[1])};
  return intersect_moving_box(to_double(c.ray.origin), to_double(c.ray.direction), lower, upper);
}

/// All eight slots of a node hold the box of one case, so that every lane is seen.
NodeHits test_node(const Kernels& kernels, const BoxCase& c) {
  Node<kMovingKeys> node{};
  node.count = kWidth;
  for (size_t key = 0; key < 2; ++key)
    for (int axis = 0; axis < 3; ++axis)
      for (size_t slot = 0; slot < kWidth; ++slot) {
        node.lower[key][axis][slot] = c.lower[key][axis];
        node.upper[key][axis][slot] = c.upper[key][axis];
      }
  NodeHits hits;
  kernels.test_node(node, c.ray, hits);
  return hits;
}

/// A ray along an axis that begins in the plane of one of the box's faces only touches it there. Nodes are tested with
/// directions that are nowhere zero (kLeastDirection): whether such a ray is within or just beyond the face is open.
bool touches_face(const BoxCase& c) {
  for (int axis = 0; axis < 3; ++axis)
    for (size_t key = 0; key < 2; ++key)
      if (c.ray.direction[axis] == 0 &&
          (c.ray.origin[axis] == c.lower[key][axis] || c.ray.origin[axis] == c.upper[key][axis]))
        return true;
  return false;
}

void check(const std::vector<BoxCase>& cases, const char* what) {
  for (const InstructionSet set : supported_instruction_sets()) {
    const Kernels* kernels = find_kernels(set);
    if (kernels->test_node == nullptr) continue;  // the scalar kernels have no vector node test
    double excess = 0;
    size_t met = 0;
    for (const BoxCase& c : cases) {
      const NodeHits hits = test_node(*kernels, c);
      if (!c.time) {
        EXPECT_TRUE(hits.mask == 0 || c.ill) << what << ": a hit where there is none";
        continue;
      }
      if (hits.mask == 0 && touches_face(c)) continue;
      ASSERT_EQ(hits.mask, 0xffu) << what << ' ' << to_string(set) << ": a hit is missed";
      ++met;
      for (size_t slot = 0; slot < kWidth; ++slot) {
        ASSERT_LE(hits.begin[slot], (*c.time)[0]) << what << ' ' << to_string(set);
        ASSERT_GE(hits.end[slot], (*c.time)[1]) << what << ' ' << to_string(set);
      }
      excess += ((*c.time)[0] - hits.begin[0]) + (hits.end[0] - (*c.time)[1]);
      const auto exact = reference(c);
      if (exact) {
        EXPECT_LE(hits.dist[0], exact->dist * (1 + 1e-6) + 1e-12) << what;
      }
    }
    ASSERT_GT(met, cases.size() / 10) << what << ": too few hits to tell";
    EXPECT_LT(excess / static_cast<double>(met), 1e-3) << what << ' ' << to_string(set);
  }
}

TEST(MovingBox, IntervalsContainTheTrueOnesForRandomBoxes) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  std::vector<BoxCase> cases;
  for (int i = 0; i < 100000; ++i) {
    BoxCase c;
    const float scale = std::exp(uniform(-5, 5)), extent = std::exp(uniform(-8, 1));
    for (int axis = 0; axis < 3; ++axis) {
      c.ray.origin[axis] = uniform(-4, 4) * scale;
      for (size_t key = 0; key < 2; ++key) {
        const float center = uniform(-3, 3) * scale, half = uniform(0, 1) < 0.1f ? 0 : uniform(0, extent) * scale;
        c.lower[key][axis] = center - half;
        c.upper[key][axis] = center + half;
      }
    }
    const float time = uniform(0, 1);
    for (int axis = 0; axis < 3; ++axis) {  // aim at the box, or along an axis
      const float mid0 = 0.5f * (c.lower[0][axis] + c.upper[0][axis]),
                  mid1 = 0.5f * (c.lower[1][axis] + c.upper[1][axis]);
      c.ray.direction[axis] = mid0 + time * (mid1 - mid0) + uniform(-1, 1) * extent * scale - c.ray.origin[axis];
      if (uniform(0, 1) < 0.1f) c.ray.direction[axis] *= uniform(0, 1) < 0.5f ? 0.0f : 1e-6f;
    }
    if (c.ray.direction == Vec3f{}) continue;
    if (const auto exact = reference(c)) {
      // The reference's own rounding is of the order of 1e-16 over the slope of its conditions; stay clear of it.
      if (exact->end - exact->begin < 1e-9) continue;
      c.time = {exact->begin + 1e-10, exact->end - 1e-10};
    } else {
      c.ill = true;  // whether it is a near miss is not known
    }
    cases.push_back(c);
  }
  check(cases, "random boxes");
}

std::vector<BoxCase> read_cases(const std::string& path) {
  std::vector<BoxCase> cases;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const auto json = nlohmann::json::parse(line);
    const auto vector = [&](const char* name) {
      return Vec3f{json.at(name).at(0).get<float>(), json.at(name).at(1).get<float>(),
                   json.at(name).at(2).get<float>()};
    };
    BoxCase c{{vector("origin"), vector("direction")},
              {vector("lower0"), vector("lower1")},
              {vector("upper0"), vector("upper1")},
              {},
              json.at("ill")};
    if (!json.at("begin").is_null()) c.time = {json.at("begin").get<double>(), json.at("end").get<double>()};
    cases.push_back(c);
  }
  return cases;
}

std::vector<BoxCase> exact_cases() {
  const TempFolder folder;
  test::ask_oracle("moving_boxes.py", folder.path("boxes.jsonl"), test::seed(), "4000");
  return read_cases(folder.path("boxes.jsonl"));
}

TEST(MovingBoxOracle, VectorTestsAreNeverNarrowerThanTheTruth) { check(exact_cases(), "oracle"); }

TEST(MovingBoxOracle, TheReferenceIsExact) {
  for (const BoxCase& c : exact_cases()) {
    const auto got = reference(c);
    if (c.ill) continue;
    ASSERT_EQ(got.has_value(), c.time.has_value());
    if (!got) continue;
    EXPECT_NEAR(got->begin, (*c.time)[0], 1e-12);
    EXPECT_NEAR(got->end, (*c.time)[1], 1e-12);
  }
}

}  // namespace
}  // namespace kairos
