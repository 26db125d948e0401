// Pictures that hold all of the shutter's time, against what records say under the same weight.
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/object_layers.h>
#include <kairos/picture.h>
#include <kairos/time_picture.h>

#include "pixel/record_builder.h"
#include "seed.h"

namespace kairos {
namespace {

using testing::HasSubstr;

constexpr int kMeshes = 6;
constexpr int kWidth = 40, kHeight = 35;  // more than a tile, and no multiple of one

Shot shot_of_size(int width, int height) {
  Shot shot;
  shot.projection.width = width;
  shot.projection.height = height;
  return shot;
}

class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}

  double real(double least, double most) { return std::uniform_real_distribution<>(least, most)(engine_); }
  int whole(int least, int most) { return std::uniform_int_distribution<>(least, most)(engine_); }
  bool chance(double share) { return real(0, 1) < share; }
  Vec3f colour(double brightness) {
    const auto value = [&] { return static_cast<float>(real(0, brightness)); };
    return {value(), value(), value()};
  }

 private:
  std::mt19937 engine_;
};

/// What is seen at an instant or over a stretch of time, with layers or without.
void add_parts(Random& random, RecordBuilder& out, float begin, float end, double brightness) {
  const int layers = random.chance(0.2) ? random.whole(2, 3) : 1;
  for (int layer = 0; layer < layers; ++layer) {
    const bool veil = layers > 1 && (layer + 1 < layers || random.chance(0.5));
    const int knots = begin < end && random.chance(0.3) ? random.whole(2, 4) : 1;  // instants have one
    float time = begin - 0.01f;
    const uint32_t first = out.knot_count();
    for (int k = 0; k < knots; ++k) {
      out.add_knot(time, random.colour(brightness), {}, {});
      if (!random.chance(0.1)) time += static_cast<float>(random.real(0, end - begin + 0.02));
    }
    const uint32_t mesh = random.chance(0.1) ? kNoMesh : static_cast<uint32_t>(random.whole(0, kMeshes - 1));
    const auto dist = [&] { return static_cast<float>(layer + (random.chance(0.3) ? 1 : random.real(1, 2))); };
    const float dist_begin = dist(), dist_end = begin < end ? dist() : dist_begin;
    out.add_part({{begin, end, dist_begin, dist_end, mesh, 0, true},
                  first,
                  static_cast<uint32_t>(knots),
                  static_cast<uint32_t>(layer),
                  veil ? 0.5f : 1});
  }
}

/// A pixel of a few rays, some of which see much.
const PixelRecord& random_record(Random& random, RecordBuilder& out, int x, int y) {
  const double brightness = random.chance(0.1) ? 100 : 1;
  out.begin_pixel(x, y, random.colour(brightness));
  const int rays = random.whole(1, 8), most = random.chance(0.3) ? 40 : 4;
  for (int r = 0; r < rays; ++r) {
    const uint32_t first = out.part_count();
    float now = random.chance(0.5) ? 0 : static_cast<float>(random.real(0, 0.5));
    for (int left = random.whole(0, most); left > 0 && now < 1; --left) {
      const float end =
          left == 1 && random.chance(0.5) ? 1.0f : std::min(1.0f, now + static_cast<float>(random.real(0, 2.0 / most)));
      add_parts(random, out, now, end, brightness);
      now = random.chance(0.8) ? end : std::min(1.0f, end + static_cast<float>(random.real(0, 0.1)));
    }
    out.add_ray({{}, static_cast<float>(random.real(0.5, 2)), PixelRay::kAll, first, out.part_count() - first, 1});
  }
  if (random.chance(0.3)) {
    for (int r = 0; r < 3; ++r) {
      const uint32_t first = out.part_count();
      if (random.chance(0.8)) add_parts(random, out, 0.5f, 0.5f, brightness);
      out.add_still_ray({{}, 1, 0.5f, first, out.part_count() - first, 1});
    }
    out.set_still(1, 0.25f);
  }
  return out.finish();
}

/// A weight with the integral 1: a box, or any curve.
TimeWeight random_weight(Random& random) {
  std::vector<TimeWeight::Point> points;
  if (random.chance(0.5)) {
    const double open = random.real(0, 0.9), close = std::min(1.0, open + random.real(0.05, 0.5));
    points = {{open, 1}, {close, 1}};
  } else {
    double time = random.real(0, 0.2);
    for (int i = random.whole(2, 6); i > 0; --i) {
      points.push_back({time, random.real(0, 1)});
      if (!random.chance(0.2)) time = std::min(1.0, time + random.real(0.05, 0.3));
    }
    points.push_back({std::min(1.0, time + 0.1), 1});
  }
  const double sum = TimeWeight(points).integral(0, 1);
  for (TimeWeight::Point& point : points) point.weight /= sum;
  return TimeWeight(points);
}

/// All of its rises and falls.
double variation(const TimeWeight& weight) {
  double sum = 0, before = 0;
  for (const TimeWeight::Point& point : weight.points()) {
    sum += std::abs(point.weight - before);
    before = point.weight;
  }
  return sum + std::abs(before);
}

/// Pixels, kept over time and under weights.
class TimePictures : public testing::Test {
 protected:
  TimePictures() { params_.shading = ShadingKind::flat, params_.aovs = {Aov::coverage}; }

  /// Of random records; pictures_: the same under each of weights_.
  TimePicture make(double tolerance, Random& random) {
    TimeFilm film(shot_, params_, tolerance);
    means_ = {};
    Picture box(shot_.projection, params_);
    std::vector<Picture> pictures;
    for (const TimeWeight& weight : weights_) pictures.emplace_back(shot_.projection, params_, weight);
    RecordBuilder builder(false);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const PixelRecord& record = random_record(random, builder, x, y);
        film.add(record);
        box.add(record);
        for (Picture& picture : pictures) picture.add(record);
      }
    means_ = box.take();
    pictures_.clear();
    for (Picture& picture : pictures) pictures_.push_back(picture.take());
    return film.take();
  }

  /// The largest difference from a picture, in units of max(1, mean over the shutter).
  double largest_error(const Image& exposed, const Image& wanted) const {
    double most = 0;
    for (size_t c = 0; c < wanted.channels.size(); ++c) {
      EXPECT_EQ(exposed.channels.at(c).name, wanted.channels[c].name);
      for (size_t i = 0; i < wanted.channels[c].values.size(); ++i) {
        const auto scale = std::max(1.0, static_cast<double>(std::abs(means_.channels[c].values[i])));
        const auto value = static_cast<double>(exposed.channels[c].values[i]);
        most = std::max(most, std::abs(value - static_cast<double>(wanted.channels[c].values[i])) / scale);
      }
    }
    return most;
  }

  Shot shot_ = shot_of_size(kWidth, kHeight);
  RenderParams params_;
  std::vector<TimeWeight> weights_;
  Image means_;  // under a box
  std::vector<Image> pictures_;
  ExposeOptions with_coverage_{true, 1, {}};
};

TEST_F(TimePictures, ExactOnesGiveEveryExposure) {
  Random random(test::seed());
  for (int i = 0; i < 20; ++i) weights_.push_back(random_weight(random));
  const TimePicture picture = make(0, random);
  for (size_t i = 0; i < weights_.size(); ++i)
    EXPECT_LT(largest_error(picture.expose(weights_[i], with_coverage_), pictures_[i]), 4e-6) << i;
  EXPECT_LT(largest_error(picture.expose(TimeWeight(), with_coverage_), means_), 2e-6);
  EXPECT_EQ(picture.quality().missing, 0u);
}

// docs/time.md, "The bound".
TEST_F(TimePictures, CodedOnesAreOffByNoMoreThanTheBound) {
  Random random(test::seed());
  for (int i = 0; i < 40; ++i) weights_.push_back(random_weight(random));
  for (const double tolerance : {0x1p-6, 0x1p-10, 0x1p-14}) {
    const TimePicture picture = make(tolerance, random);
    const TimeQuality quality = picture.quality();
    EXPECT_LE(quality.deviation, tolerance);
    EXPECT_GT(quality.deviation, tolerance / 2) << "pieces that long could be longer";
    for (size_t i = 0; i < weights_.size(); ++i)
      EXPECT_LE(largest_error(picture.expose(weights_[i], with_coverage_), pictures_[i]),
                quality.deviation * variation(weights_[i]) + quality.rounding + 4e-6)
          << "tolerance " << tolerance << ", weight " << i;
    // Each piece keeps its mean but for how the step is rounded, and so does the whole shutter's time.
    EXPECT_LT(largest_error(picture.expose(TimeWeight(), with_coverage_), means_), quality.rounding + 4e-6);
  }
}

TEST_F(TimePictures, CoarserOnesTakeFewerPieces) {
  const uint32_t seed = test::seed();
  uint64_t before = UINT64_MAX;
  for (const double tolerance : {0.0, 0x1p-16, 0x1p-12, 0x1p-8}) {
    Random random(seed);
    const uint64_t pieces = make(tolerance, random).quality().pieces;
    EXPECT_LT(pieces, before) << tolerance;
    before = pieces;
  }
  EXPECT_LT(before, uint64_t{8} * kWidth * kHeight);
}

TEST_F(TimePictures, ExposuresAdd) {
  Random random(test::seed());
  const TimePicture picture = make(0x1p-10, random);
  const Image first = picture.expose(TimeWeight({{0.25, 1}, {0.5, 1}})),
              second = picture.expose(TimeWeight({{0.5, 1}, {0.875, 1}})),
              both = picture.expose(TimeWeight({{0.25, 1}, {0.875, 1}}));
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < both.channels[c].values.size(); ++i) {
      const float sum = first.channels[c].values[i] + second.channels[c].values[i];
      ASSERT_NEAR(sum, both.channels[c].values[i], 1e-6f * std::max(1.0f, 8 * std::abs(sum)));
    }
}

TEST_F(TimePictures, EachPixelMayHaveItsOwnWeight) {
  Random random(test::seed());
  const TimePicture picture = make(0, random);
  const auto weight = [](int x, int y) {
    const double open = 0.01 * x + 0.001 * y;
    return TimeWeight({{open, 4}, {open + 0.25, 4}});
  };
  const Image each = picture.expose(PixelWeights{weight, true, true});
  for (const int x : {0, 31, 32, kWidth - 1}) {
    const Image column = picture.expose(PixelWeights{[&](int, int y) { return weight(x, y); }, false, true});
    for (int y = 0; y < kHeight; ++y)
      for (size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(y * kWidth + x);
        ASSERT_EQ(each.channels[c].values[i], column.channels[c].values[i]) << x << "," << y;
      }
  }
}

TEST_F(TimePictures, SayWhatIsSeenAtAnInstant) {
  Random random(test::seed());
  const TimePicture picture = make(0, random);
  for (const double time : {0.0, 0.3, 1.0}) {
    const Image image = picture.at(time);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const std::vector<TimePiece> pieces = picture.signal(x, y);
        ASSERT_FALSE(pieces.empty());
        EXPECT_EQ(pieces.front().begin, 0);
        EXPECT_EQ(pieces.back().end, 1);
        const auto now = std::find_if(pieces.begin(), pieces.end(),
                                      [&](const TimePiece& piece) { return time < piece.end || piece.end == 1; });
        const auto place = static_cast<float>((time - now->begin) / (now->end - now->begin));
        ASSERT_NEAR(image.channels[0].values[static_cast<size_t>(y * kWidth + x)],
                    now->left[0] + (now->right[0] - now->left[0]) * place, 1e-4f);
      }
  }
}

/// The record with one mesh white, or as it is, and all else black.
class MatteOf {
 public:
  const PixelRecord& make(const PixelRecord& record, uint32_t mesh, bool white) {
    record_ = record;
    record_.background = {};
    knots_.assign(record.knots.begin(), record.knots.end());
    for (const SeenPart& part : record.parts)
      for (uint32_t k = 0; k < part.knots; ++k)
        if (white || part.where.mesh != mesh)
          knots_[part.first_knot + k].colour = part.where.mesh == mesh ? Vec3f{1, 1, 1} : Vec3f{};
    record_.knots = knots_;
    return record_;
  }

 private:
  PixelRecord record_;
  std::vector<Knot> knots_;
};

// How much of a mesh is seen is what a picture of it in white on black shows, and meshes add to the picture.
TEST_F(TimePictures, SayWhatEachMeshContributes) {
  Random random(test::seed());
  params_.aovs = {Aov::coverage, Aov::depth};
  for (const double tolerance : {0.0, 0x1p-10}) {
    const TimeWeight weight = random_weight(random);
    TimeFilm film(shot_, params_, tolerance, {}, true);
    Picture box(shot_.projection, params_), weighted(shot_.projection, params_, weight);
    std::vector<Picture> mattes(kMeshes, Picture(shot_.projection, params_, weight)), colours = mattes;
    RecordBuilder builder(false);
    MatteOf matte;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const PixelRecord& record = random_record(random, builder, x, y);
        film.add(record);
        box.add(record);
        weighted.add(record);
        for (uint32_t mesh = 0; mesh < kMeshes; ++mesh) {
          mattes[mesh].add(matte.make(record, mesh, true));
          colours[mesh].add(matte.make(record, mesh, false));
        }
      }
    const TimePicture picture = film.take();
    const double bound = tolerance * variation(weight) + (tolerance > 0 ? 1e-3 : 4e-6);
    const ExposedObjects objects = picture.objects({[&](int, int) { return weight; }});
    std::vector<Image> coverages, contributions;
    for (Picture& of_mesh : mattes) coverages.push_back(of_mesh.take());
    for (Picture& of_mesh : colours) contributions.push_back(of_mesh.take());
    for (size_t pixel = 0; pixel < size_t{kWidth} * kHeight; ++pixel)
      for (const SeenObject& object : objects.of(pixel)) {
        ASSERT_NEAR(object.coverage, coverages[object.mesh].channels[0].values[pixel], bound) << pixel;
        const float green = contributions[object.mesh].channels[1].values[pixel];
        ASSERT_NEAR(object.colour.y, green, bound * std::max(10.0f, 3 * green)) << pixel;
      }

    const Image image = weighted.take();
    const DeepImage deep = deep_objects(image, objects, picture.frame());
    Image all = box.take();
    Image depths = all;
    depths.channels.clear();
    add_depth(depths, picture.objects({[](int, int) { return TimeWeight(); }}));
    const std::vector<float>&depth = all.find("depth.Z")->values, &alpha = deep.image.find("A")->values,
          &z = deep.image.find("Z")->values;
    for (size_t pixel = 0; pixel < depth.size(); ++pixel) {
      if (std::isfinite(depth[pixel]))
        ASSERT_NEAR(depths.channels[0].values[pixel], depth[pixel], tolerance > 0 ? 2e-3 * depth[pixel] : 1e-6);
      else
        ASSERT_EQ(depths.channels[0].values[pixel], depth[pixel]);
      for (size_t c = 0; c < 3; ++c) {
        double sum = 0, open = 1;
        for (size_t i = deep.first[pixel]; i < deep.first[pixel + 1]; ++i) {
          sum += open * static_cast<double>(deep.image.channels[c].values[i]);
          open *= 1 - static_cast<double>(alpha[i]);
          ASSERT_TRUE(i == deep.first[pixel] || z[i] > z[i - 1]) << "coincident samples are merged by other rules";
        }
        const double value = static_cast<double>(image.channels[c].values[pixel]);
        ASSERT_NEAR(sum, value, 3e-5 * std::max(1.0, std::abs(value))) << "pixel " << pixel;
        ASSERT_NEAR(open, 0, 2e-4) << "the background is behind everything";
      }
    }
  }
}

TEST_F(TimePictures, LeaveOutTilesThatAreNotComplete) {
  TimeFilm film(shot_, params_);
  RecordBuilder builder(false);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32 + 3; ++x) {
      builder.begin_pixel(x, y, {1, 2, 3});
      builder.add_ray({{}, 1, PixelRay::kAll, 0, 0, 0});
      film.add(builder.finish());
    }
  const TimePicture picture = film.take();
  EXPECT_EQ(picture.quality().missing, uint64_t{kWidth} * kHeight - 32 * 32);
  const Image image = picture.expose();
  EXPECT_EQ(image.channels[1].values[31], 2);
  EXPECT_EQ(image.channels[1].values[32], 0);
  EXPECT_TRUE(picture.signal(33, 0).empty());
  EXPECT_EQ(film.take().quality().pieces, 0u) << "what was taken is gone";
}

TEST_F(TimePictures, RefuseWhatHasNoTime) {
  const auto message = [&](const RenderParams& params, double tolerance) {
    try {
      const TimeFilm film(shot_, params, tolerance);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  RenderParams params;
  EXPECT_EQ(message(params, 0), "");
  EXPECT_THAT(message(params, -1), HasSubstr("2^-18 to 1"));
  EXPECT_THAT(message(params, 1e-9), HasSubstr("2^-18 to 1"));
  params.crop = Crop{0, kWidth + 1, 0, 1};
  EXPECT_THAT(message(params, 0), HasSubstr("crop"));
  params = {};
  params.integrator = IntegratorKind::qmc;
  EXPECT_THAT(message(params, 0), HasSubstr("use the integrator tc"));
}

}  // namespace
}  // namespace kairos
