// What integrators hand over, and that pictures are made of nothing else.
#include <algorithm>
#include <map>
#include <mutex>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/picture.h>
#include <kairos/render.h>

#include "render/busy_shot.h"
#include "seed.h"

namespace kairos::records_test {
namespace {

constexpr int kWidth = 24, kHeight = 16;

/// Still and moving triangles that hide each other, in front of a background; the third mesh is blended.
Shot busy_shot(std::mt19937& random) {
  return test::busy_shot(random,
                         {test::Motion::still, test::Motion::deform, test::Motion::translation, test::Motion::still,
                          test::Motion::violent},
                         true, kWidth, kHeight);
}

RenderParams params_of(IntegratorKind kind, uint64_t seed) {
  RenderParams params;
  params.integrator = kind;
  params.tc_rays = 4;
  params.spp = 64;
  params.seed = seed;
  params.aovs = {Aov::depth, Aov::normal, Aov::albedo, Aov::coverage, Aov::segments, Aov::mesh};
  return params;
}

/// A record with what its spans show.
struct Kept {
  PixelRecord record;
  std::vector<PixelRay> rays, still_rays;
  std::vector<SeenPart> parts;
  std::vector<Knot> knots;
  std::vector<KnotSurface> surfaces;
};

class Keeper : public PixelConsumer {
 public:
  explicit Keeper(RecordNeeds needs) : needs_(needs) {}
  RecordNeeds needs() const override { return needs_; }
  void add(const PixelRecord& record) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    Kept& kept = pixels[{record.y, record.x}];
    ++calls;
    const auto copy = [](auto span) { return std::vector(span.begin(), span.end()); };
    kept = {record,
            copy(record.rays),
            copy(record.still.rays),
            copy(record.parts),
            copy(record.knots),
            copy(record.surfaces)};
    kept.record.rays = kept.rays;
    kept.record.still.rays = kept.still_rays;
    kept.record.parts = kept.parts;
    kept.record.knots = kept.knots;
    kept.record.surfaces = kept.surfaces;
  }

  std::map<std::pair<int, int>, Kept> pixels;
  size_t calls = 0;

 private:
  RecordNeeds needs_;
  std::mutex mutex_;
};

bool same(const PixelRecord& a, const PixelRecord& b) {
  const auto equal = [](auto one, auto other) {
    return one.size() == other.size() &&
           std::equal(reinterpret_cast<const char*>(one.data()), reinterpret_cast<const char*>(one.data() + one.size()),
                      reinterpret_cast<const char*>(other.data()));
  };
  const auto equal_parts = std::equal(
      a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), [](const SeenPart& one, const SeenPart& other) {
        const Segment &s = one.where, &t = other.where;
        return s.begin == t.begin && s.end == t.end && s.dist_begin == t.dist_begin && s.dist_end == t.dist_end &&
               s.mesh == t.mesh && s.triangle == t.triangle && s.front == t.front &&
               one.first_knot == other.first_knot && one.knots == other.knots && one.layer == other.layer &&
               one.opacity == other.opacity;
      });
  return equal_parts && equal(a.rays, b.rays) && equal(a.knots, b.knots) && equal(a.surfaces, b.surfaces) &&
         equal(a.still.rays, b.still.rays) && a.still.own == b.still.own;
}

/// The sum over segments of duration times colour as it was before there were records: layers composed in float, sums
/// in double, background where nothing is.
Vec3f summed(const PixelRecord& record) {
  Vec3d sum;
  for (const PixelRay& ray : record.rays) {
    double filled = 0;
    const auto parts = record.parts_of(ray);
    for (size_t i = 0; i < parts.size();) {
      const double weight = std::isnan(ray.time)
                                ? static_cast<double>(parts[i].where.end) - static_cast<double>(parts[i].where.begin)
                                : 1;
      Vec3f colour;
      float open = 1;
      do {
        colour += record.knots[parts[i].first_knot].colour * (open * parts[i].opacity);
        open *= 1 - parts[i].opacity;
      } while (++i < parts.size() && parts[i].layer > 0);
      if (open > 0) colour += record.background * open;
      filled += weight;
      sum += to_double(colour) * weight;
    }
    sum += to_double(record.background) * std::max(0.0, 1 - filled);
  }
  return to_float(sum / static_cast<double>(record.rays.size()));
}

TEST(Records, OfTimeContinuousRaysSumUpToThePictureBitForBit) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Shot shot = busy_shot(random);
  Renderer renderer(shot);
  size_t layers = 0;
  for (const ShadingKind shading : {ShadingKind::flat, ShadingKind::normal}) {
    RenderParams params = params_of(IntegratorKind::tc, seed);
    params.shading = shading;
    params.clusters = Clusters::off;
    const Image image = renderer.render(params);
    Keeper keeper({RecordNeeds::Time::box, true, true});
    PixelConsumer* const consumer = &keeper;
    renderer.render(params, {&consumer, 1});
    for (const auto& [place, kept] : keeper.pixels) {
      const Vec3f colour = summed(kept.record);
      const auto index = static_cast<size_t>(place.first * kWidth + place.second);
      for (int i = 0; i < 3; ++i)
        ASSERT_EQ(colour[i], image.channels[static_cast<size_t>(i)].values[index])
            << place.second << ' ' << place.first;
      layers += static_cast<size_t>(
          std::count_if(kept.parts.begin(), kept.parts.end(), [](const SeenPart& part) { return part.layer > 0; }));
    }
  }
  EXPECT_GT(layers, 0u);
}

// Once for every pixel of the crop; several consumers are handed the same as each alone.
TEST(Records, SeveralConsumersGetWhatEachGetsAlone) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Shot shot = busy_shot(random);
  Renderer renderer(shot);
  for (const IntegratorKind kind :
       {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed, IntegratorKind::automatic}) {
    RenderParams params = params_of(kind, seed);
    params.crop = Crop{3, 21, 2, 13};
    const RecordNeeds needs = Picture(shot.projection, params).needs();
    Picture picture(shot.projection, params);
    Keeper one(needs), other(needs), alone(needs);
    PixelConsumer* const together[] = {&one, &picture, &other};
    renderer.render(params, together);
    PixelConsumer* const single = &alone;
    params.threads = 1;
    renderer.render(params, {&single, 1});
    EXPECT_EQ(one.calls, 18u * 11u);
    EXPECT_EQ(one.pixels.size(), 18u * 11u);
    ASSERT_EQ(alone.pixels.size(), one.pixels.size());
    for (const auto& [place, kept] : alone.pixels) {
      EXPECT_TRUE(same(kept.record, one.pixels[place].record)) << static_cast<int>(kind);
      EXPECT_TRUE(same(kept.record, other.pixels[place].record));
    }
    const Image image = picture.take(), expected = renderer.render(params);
    for (size_t c = 0; c < image.channels.size(); ++c) EXPECT_EQ(image.channels[c].values, expected.channels[c].values);
  }
}

TEST(Records, SurfacesAreThereForThoseWhoNeedThem) {
  std::mt19937 random(1);
  const Shot shot = busy_shot(random);
  for (const bool wanted : {false, true}) {
    Keeper keeper({RecordNeeds::Time::box, wanted, false});
    PixelConsumer* const consumer = &keeper;
    Renderer(shot).render(params_of(IntegratorKind::mixed, 1), {&consumer, 1});
    for (const auto& [place, kept] : keeper.pixels) ASSERT_EQ(kept.surfaces.size(), wanted ? kept.knots.size() : 0u);
  }
}

TEST(Records, RaysLieWhereTheyAreSaidTo) {
  std::mt19937 random(1);
  const Shot shot = busy_shot(random);
  Keeper keeper({});
  PixelConsumer* const consumer = &keeper;
  Renderer(shot).render(params_of(IntegratorKind::mixed, 1), {&consumer, 1});
  size_t still = 0;
  for (const auto& [place, kept] : keeper.pixels) {
    double x = 0;
    for (const PixelRay& ray : kept.rays) {
      EXPECT_GE(ray.film.x, 0);
      EXPECT_LE(ray.film.y, 1);
      x += static_cast<double>(ray.film.x) / static_cast<double>(kept.rays.size());
    }
    EXPECT_NEAR(x, 0.5, 0.25);
    // The first of the still layer's rays lie where the pixel's own do.
    for (size_t i = 0; i < kept.record.still.own && !kept.still_rays.empty(); ++i) {
      ++still;
      EXPECT_EQ(kept.still_rays[i].film, kept.rays[i].film);
    }
  }
  EXPECT_GT(still, 100u);
}

TEST(Records, WhatAConsumerThrowsEndsTheRendering) {
  class Thrower : public PixelConsumer {
   public:
    RecordNeeds needs() const override { return {}; }
    void add(const PixelRecord&) override { throw Error(ErrorCode::io, "", "no space left"); }
  };
  std::mt19937 random(1);
  const Shot shot = busy_shot(random);
  Thrower thrower;
  PixelConsumer* const consumer = &thrower;
  EXPECT_THROW(Renderer(shot).render(params_of(IntegratorKind::tc, 1), {&consumer, 1}), Error);
}

}  // namespace
}  // namespace kairos::records_test
