// What moves where on screen: the same whatever part of the frame is asked about, and at the price of that part.
#include "motion/motion_mask.h"

#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "integrators/shot_parts.h"
#include "soup.h"

namespace kairos {
namespace {

Shot random_shot(std::mt19937& random, int width, int height) {
  Shot shot;
  for (const test::Motion motion : {test::Motion::translation, test::Motion::deform, test::Motion::still})
    shot.meshes.push_back(test::random_soup(random, motion, 700));  // more than one piece
  shot.projection.width = width;
  shot.projection.height = height;
  return shot;
}

void expect_same(const PixelMotion& a, const PixelMotion& b, int x, int y) {
  EXPECT_EQ(a.count, b.count) << x << ' ' << y;
  EXPECT_EQ(a.speed, b.speed) << x << ' ' << y;
  EXPECT_EQ(a.depth, b.depth) << x << ' ' << y;
  EXPECT_EQ(a.along, b.along) << x << ' ' << y;
  EXPECT_EQ(a.across, b.across) << x << ' ' << y;
  EXPECT_EQ(a.weight, b.weight) << x << ' ' << y;
}

TEST(MotionMask, IsTheSameInAnyPart) {
  std::mt19937 random(test::seed());
  const int width = 150, height = 90;
  const Shot shot = random_shot(random, width, height);
  const auto motion = std::make_shared<const ScreenMotion>(shot, 0.5);
  const MotionMask whole(motion, {0, width, 0, height});
  std::uniform_int_distribution<int> any_x(0, width - 1), any_y(0, height - 1);
  int moving = 0;
  for (int round = 0; round < 30 && !testing::Test::HasFailure(); ++round) {
    const auto [x0, x1] = std::minmax({any_x(random), any_x(random)});
    const auto [y0, y1] = std::minmax({any_y(random), any_y(random)});
    const MotionMask part(motion, {x0, x1 + 1, y0, y1 + 1});
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        expect_same(part.at(x, y), whole.at(x, y), x, y);
        moving += part.moves(x, y);
      }
    for (const LookPixel& look : look_pixels(shot.projection))
      expect_same(part.at(look.x, look.y), whole.at(look.x, look.y), look.x, look.y);
  }
  EXPECT_GT(moving, 100);
}

TEST(MotionMask, LooksAreTheSameAsPixels) {
  std::mt19937 random(test::seed());
  for (const auto& [width, height] : {std::pair(640, 333), std::pair(31, 7), std::pair(1, 1), std::pair(2, 500)}) {
    const Shot shot = random_shot(random, width, height);
    const auto motion = std::make_shared<const ScreenMotion>(shot, 1.5);
    const MotionMask whole(motion, {0, width, 0, height});
    for (const LookPixel& look : look_pixels(shot.projection)) {
      ASSERT_NE(motion->at_look(look.x, look.y), nullptr);
      expect_same(*motion->at_look(look.x, look.y), whole.at(look.x, look.y), look.x, look.y);
    }
  }
}

TEST(MotionMask, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(test::seed());
  const int width = 200, height = 100;
  Shot shot = random_shot(random, width, height);
  shot.meshes.push_back(test::random_soup(random, test::Motion::deform, 20000));
  const auto make = [&](int threads) {
    std::unique_ptr<MotionMask> mask;
    with_threads(threads, [&] {
      mask = std::make_unique<MotionMask>(std::make_shared<const ScreenMotion>(shot, 0.5), Crop{0, width, 0, height});
    });
    return mask;
  };
  const auto one = make(1), two = make(2);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) expect_same(one->at(x, y), two->at(x, y), x, y);
}

// One more power of two is one more in the depth, exactly, and nothing else.
TEST(MotionMask, ScalesWithTheScene) {
  std::mt19937 random(test::seed());
  Shot shot = random_shot(random, 60, 40);
  const auto look = [&] { return MotionMask(std::make_shared<const ScreenMotion>(shot, 0.5), Crop{0, 60, 0, 40}); };
  const MotionMask before = look();
  for (const int k : {-100, -3, 100}) {
    Shot scaled = shot;
    for (Mesh& mesh : scaled.meshes)
      for (auto& key : mesh.positions)
        for (Vec3f& p : key) p = {std::ldexp(p.x, k), std::ldexp(p.y, k), std::ldexp(p.z, k)};
    const MotionMask after(std::make_shared<const ScreenMotion>(scaled, 0.5), Crop{0, 60, 0, 40});
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 60; ++x) {
        EXPECT_EQ(after.speed(x, y), before.speed(x, y));
        EXPECT_EQ(after.direction(x, y), before.direction(x, y));
        EXPECT_EQ(after.depth(x, y), std::ldexp(before.depth(x, y), k));
      }
  }
}

TEST(MotionMask, APartOfAHugeFrameIsSmall) {
  std::mt19937 random(test::seed());
  const Shot shot = random_shot(random, 65536, 65536);
  ShotParts parts(shot);
  const Crop crop{30000, 30016, 40000, 40016};
  const MotionMask& mask = parts.motion_mask(0.5, crop);
  EXPECT_LE(mask.part().x1 - mask.part().x0, 512);
  EXPECT_LE(mask.part().y1 - mask.part().y0, 512);
  EXPECT_EQ(&parts.motion_mask(0.5, Crop{30016, 30032, 40000, 40016}), &mask) << "of a neighbour";
}

}  // namespace
}  // namespace kairos
