// From records to means over a pixel.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/picture.h>

#include "pixel/record_builder.h"

namespace kairos {
namespace {

/// A ray over time, of parts with one knot each.
class Pixel {
 public:
  explicit Pixel(Vec3f background) { builder_.begin_pixel(0, 0, background); }

  struct Part {
    float begin, end;
    Vec3f colour;
    uint32_t mesh;
    float dist = 1;
    float opacity = 1;
    uint32_t layer = 0;
  };
  Pixel& ray(const std::vector<Part>& parts, uint32_t segments, float time = PixelRay::kAll) {
    const uint32_t first = add(parts);
    builder_.add_ray({{}, 1, time, first, static_cast<uint32_t>(parts.size()), segments});
    return *this;
  }
  Pixel& still_ray(const std::vector<Part>& parts, float time) {
    const uint32_t first = add(parts);
    builder_.add_still_ray({{}, 1, time, first, static_cast<uint32_t>(parts.size()), 0});
    return *this;
  }
  RecordBuilder& builder() { return builder_; }
  PixelMeans means(const TimeWeight& weight = {}) { return reduce(builder_.finish(), weight); }

 private:
  uint32_t add(const std::vector<Part>& parts) {
    const uint32_t first = builder_.part_count();
    for (const Part& p : parts) {
      const uint32_t knot = builder_.add_knot(p.begin, p.colour, {0, 0, 1}, p.colour);
      builder_.add_part({{p.begin, p.end, p.dist, p.dist + 1, p.mesh, 0, true}, knot, 1, p.layer, p.opacity});
    }
    return first;
  }
  RecordBuilder builder_;
};

TEST(Reduce, WeighsByDurationAndFillsTheRestWithBackground) {
  const PixelMeans means =
      Pixel({0, 0, 4}).ray({{0, 0.25f, {1, 0, 0}, 7}, {0.5f, 0.75f, {0, 2, 0}, 2, 0.5f}}, 2).ray({}, 0).means();
  EXPECT_EQ(means.colour, (Vec3f{0.125f, 0.25f, 3}));
  EXPECT_EQ(means.normal, (Vec3f{0, 0, 0.25f}));
  EXPECT_EQ(means.coverage, 0.25f);
  EXPECT_EQ(means.depth, 0.5f);
  EXPECT_EQ(means.visibility_segments, 1);
  EXPECT_EQ(means.mesh_id, 3u) << "of equals the lowest index, plus one";
}

TEST(Reduce, ADiscreteSampleCountsAsAWholeRay) {
  const PixelMeans means = Pixel({0, 0, 1}).ray({{0.3f, 0.3f, {1, 1, 0}, 0}}, 1, 0.3f).ray({}, 0, 0.7f).means();
  EXPECT_EQ(means.colour, (Vec3f{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(means.coverage, 0.5f);
}

TEST(Reduce, NoRaysHaveNothing) {
  const PixelMeans means = Pixel({1, 1, 1}).means();
  EXPECT_EQ(means.colour, Vec3f{});
  EXPECT_EQ(means.coverage, 0);
  EXPECT_EQ(means.mesh_id, 0u);
  EXPECT_TRUE(std::isinf(means.depth));
}

TEST(Reduce, ComposesLayersFromFrontToBack) {
  const PixelMeans means =
      Pixel({0, 0, 1})
          .ray({{0, 0.5f, {1, 0, 0}, 4, 2, 0.25f, 0}, {0, 0.5f, {0, 1, 0}, 5, 3, 0.5f, 1}, {0.5f, 1, {8, 8, 8}, 6, 9}},
               3)
          .means();
  EXPECT_EQ(means.colour, (Vec3f{4 + 0.5f * 0.25f, 4 + 0.5f * 0.375f, 4 + 0.5f * 0.375f}));
  EXPECT_EQ(means.coverage, 0.5f + 0.5f * 0.625f);
  EXPECT_EQ(means.depth, 2);
  EXPECT_EQ(means.mesh_id, 6u) << "the heaviest layer, and of equals the lowest index";
}

TEST(Reduce, TakesTheSkyForNothing) {
  const PixelMeans means =
      Pixel({9, 9, 9}).ray({{0, 1, {1, 0, 0}, 0, 2, 0.25f, 0}, {0, 1, {0, 1, 0}, kNoMesh, INFINITY, 1, 1}}, 1).means();
  EXPECT_EQ(means.colour, (Vec3f{0.25f, 0.75f, 0}));
  EXPECT_EQ(means.coverage, 0.25f);
}

// Of a colour that is linear in time, under a weight that is: 2 t times (1, 0, 0) + t (-1, 3, 0).
TEST(Reduce, IntegratesStraightLinesBetweenKnotsExactly) {
  Pixel pixel({});
  RecordBuilder& builder = pixel.builder();
  const uint32_t knot = builder.add_knot(0, {1, 0, 0}, {}, {});
  builder.add_knot(0.25f, {0.75f, 0.75f, 0}, {}, {});
  builder.add_knot(1, {0, 3, 0}, {}, {});
  builder.add_part({{0, 1, 1, 1, 0, 0, true}, knot, 3});
  builder.add_ray({{}, 1, PixelRay::kAll, 0, 1, 1});
  const PixelMeans box = pixel.means(), ramp = pixel.means(TimeWeight({{0, 0}, {1, 2}}));
  EXPECT_FLOAT_EQ(box.colour.x, 0.5f);
  EXPECT_FLOAT_EQ(box.colour.y, 1.5f);
  EXPECT_FLOAT_EQ(ramp.colour.x, 2 * (0.5f - 1.0f / 3));
  EXPECT_FLOAT_EQ(ramp.colour.y, 2.0f);
  EXPECT_FLOAT_EQ(ramp.coverage, 1);
}

TEST(Reduce, KeepsTheColoursOfTheFirstAndLastKnotBeyondThem) {
  Pixel pixel({});
  RecordBuilder& builder = pixel.builder();
  const uint32_t knot = builder.add_knot(0.5f, {2, 0, 0}, {}, {});
  builder.add_knot(0.75f, {4, 0, 0}, {}, {});
  builder.add_part({{0, 1, 1, 1, 0, 0, true}, knot, 2});
  builder.add_ray({{}, 1, PixelRay::kAll, 0, 1, 1});
  EXPECT_FLOAT_EQ(pixel.means().colour.x, 0.5f * 2 + 0.25f * 3 + 0.25f * 4);
}

TEST(Reduce, WeighsInstantsAndGapsByTheCurve) {
  const TimeWeight second_half({{0.5, 2}, {1, 2}});
  const PixelMeans means = Pixel({0, 0, 1})
                               .ray({{0, 0.75f, {1, 0, 0}, 3}}, 1)          // half of its weight, half background
                               .ray({{0.2f, 0.2f, {5, 5, 5}, 4}}, 1, 0.2f)  // none
                               .ray({{0.7f, 0.7f, {0, 4, 0}, 5}}, 1, 0.7f)
                               .ray({}, 0, 0.9f)
                               .means(second_half);
  EXPECT_EQ(means.colour, (Vec3f{0.125f, 2, 0.125f + 0.5f}));
  EXPECT_EQ(means.coverage, 0.125f + 0.5f);
  EXPECT_EQ(means.mesh_id, 6u);
}

// The share times (S - S'): what stands still, sampled by three rays more than the pixel has.
TEST(Reduce, AddsTheStillTermByItsShareAndTheIntegralOfTheWeight) {
  Pixel pixel({0, 0, 1});
  pixel.ray({{0, 0.5f, {1, 0, 0}, 0}, {0.5f, 1, {0, 1, 0}, 1}}, 2);  // moves; stands still
  pixel.still_ray({{0.6f, 0.6f, {0, 1, 0}, 1}}, 0.6f);
  pixel.still_ray({{0.7f, 0.7f, {0, 2, 0}, 1}}, 0.7f);
  pixel.still_ray({{0.8f, 0.8f, {0, 2, 0}, 1}}, 0.8f);
  pixel.still_ray({}, 0.9f);
  pixel.builder().set_still(1, 0.5f);
  // S = (0, 1.25, 0.25), S' = (0, 1, 0).
  EXPECT_EQ(pixel.means().colour, (Vec3f{0.5f, 0.5f + 0.125f, 0.125f}));
  EXPECT_EQ(pixel.means().coverage, 1 - 0.125f);
  EXPECT_EQ(pixel.means(TimeWeight({{0, 2}, {0.5, 2}})).colour, (Vec3f{1, 0.125f, 0.125f}));
  EXPECT_EQ(pixel.means(TimeWeight({{0, 3}, {1, 3}})).colour, (Vec3f{1.5f, 1.5f + 0.375f, 0.375f}));
}

/// Where it takes away more than there is, a picture shows nothing, and the record keeps what is right in the mean.
TEST(Reduce, NoPictureIsBelowZero) {
  Pixel pixel({0, 0, 1});
  pixel.ray({}, 0);
  pixel.still_ray({{0.6f, 0.6f, {1, 0, 0}, 1}}, 0.6f);
  pixel.still_ray({}, 0.9f);
  pixel.builder().set_still(1, 1);
  EXPECT_EQ(pixel.means().colour, (Vec3f{-0.5f, 0, 1.5f}));
  Projection frame;
  frame.width = frame.height = 1;
  Picture picture(frame, RenderParams());
  picture.add(pixel.builder().finish());
  const Image image = picture.take_shown();
  EXPECT_EQ(image.find("R")->values[0], 0);
  EXPECT_EQ(image.find("B")->values[0], 1.5f);
}

}  // namespace
}  // namespace kairos
