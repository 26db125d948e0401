// From colours to the screen.
#include "image/view_transform.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "seed.h"

namespace kairos {
namespace {

Vec3f filmic(Vec3f colour, double exposure = 0) { return seen_on_screen(colour, ViewTransform::filmic, exposure); }

TEST(ViewTransform, StandardCutsOffAtWhite) {
  EXPECT_EQ(seen_on_screen({0.25f, 1, 3}, ViewTransform::standard, 0), (Vec3f{0.25f, 1, 1}));
  EXPECT_EQ(seen_on_screen({0.25f, 0.125f, 0.0625f}, ViewTransform::standard, 1), (Vec3f{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(seen_on_screen({0.5f, 0.5f, 0.5f}, ViewTransform::filmic, -1), (Vec3f{0.25f, 0.25f, 0.25f}));
}

TEST(ViewTransform, FilmicKeepsBlackMidGreyAndWhatIsNotBright) {
  for (const Vec3f colour :
       {Vec3f{0, 0, 0}, Vec3f{0.18f, 0.18f, 0.18f}, Vec3f{0.7f, 0.1f, 0}, Vec3f{0.3f, 0.6f, 0.69f}})
    EXPECT_EQ(filmic(colour), colour);
}

TEST(ViewTransform, TheShoulderIsTheHyperbolaOfTheDocs) {
  EXPECT_EQ(filmic_shoulder(0.7), 0.7);
  EXPECT_DOUBLE_EQ(filmic_shoulder(1), 0.85);
  EXPECT_DOUBLE_EQ(filmic_shoulder(1.3), 0.9);
  EXPECT_DOUBLE_EQ(filmic_shoulder(3.4), 0.97);
  EXPECT_NEAR((filmic_shoulder(0.7 + 1e-6) - 0.7) / 1e-6, 1, 1e-5) << "goes on in the same direction";
}

TEST(ViewTransform, IsMonotoneAndNeverReachesWhiteThatAFloatCouldTellFromIt) {
  double before = -1;
  for (double value = 0; value < 1e5; value = value * 1.01 + 1e-4) {
    const double shown = filmic_shoulder(value);
    EXPECT_GT(shown, before);
    EXPECT_LT(shown, 1);
    before = shown;
  }
}

TEST(ViewTransform, BrightColoursPaleAndKeepTheOrderOfTheirParts) {
  const Vec3f red = filmic({100, 1, 0});
  EXPECT_GT(red.x, 0.99f);
  EXPECT_GT(red.y, red.z);
  EXPECT_GT(red.z, 0.8f) << "so bright a red is almost white";
  const Vec3f dim = filmic({1, 0.01f, 0});
  EXPECT_NEAR(dim.x, 0.85, 1e-6);
  EXPECT_LT(dim.z, 0.05f) << "a red that is not is red";
}

TEST(ViewTransform, AnyColourIsAColour) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> exponent(-130, 127);
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  const auto any = [&] {
    const float special[] = {0, -1, kInfinity, -kInfinity, kNan, std::numeric_limits<float>::max()};
    const uint32_t which = random() % 12;
    return which < 6 ? special[which] : std::exp2(exponent(random));
  };
  for (int i = 0; i < 20000; ++i) {
    const Vec3f colour{any(), any(), any()};
    for (const ViewTransform view : {ViewTransform::standard, ViewTransform::filmic})
      for (const double exposure : {-100.0, 0.0, 100.0}) {
        const Vec3f seen = seen_on_screen(colour, view, exposure);
        for (int c = 0; c < 3; ++c)
          ASSERT_TRUE(seen[c] >= 0 && seen[c] <= 1) << colour[0] << ' ' << colour[1] << ' ' << colour[2];
      }
  }
}

}  // namespace
}  // namespace kairos
