// Consumers that need time: rays over time, colours at their own instants, and random numbers that go on from shot to
// shot.
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/picture.h>
#include <kairos/render.h>

#include "base/monitor.h"
#include "integrators/integrator.h"
#include "motion/motion_mask.h"
#include "motion/screen_motion.h"
#include "render/busy_shot.h"
#include "seed.h"
#include "whitted_scene.h"

namespace kairos::over_time_test {
namespace {

constexpr int kWidth = 24, kHeight = 16;

/// Keeps what `look` makes of each record.
template <class Kept>
class Keeper : public PixelConsumer {
 public:
  using Look = std::function<Kept(const PixelRecord&)>;
  Keeper(RecordNeeds needs, Look look) : needs_(needs), look_(std::move(look)) {}
  RecordNeeds needs() const override { return needs_; }
  void add(const PixelRecord& record) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    pixels[{record.y, record.x}] = look_(record);
  }
  std::map<std::pair<int, int>, Kept> pixels;

 private:
  RecordNeeds needs_;
  Look look_;
  std::mutex mutex_;
};

template <class Kept>
std::map<std::pair<int, int>, Kept> look_at(const Shot& shot, const RenderParams& params, RecordNeeds::Time need,
                                            typename Keeper<Kept>::Look look) {
  Keeper<Kept> keeper({need, false, false}, std::move(look));
  PixelConsumer* const consumer = &keeper;
  Renderer(shot).render(params, {&consumer, 1});
  return keeper.pixels;
}

Shot busy_shot(std::mt19937& random, bool blended) {
  return test::busy_shot(random,
                         {test::Motion::still, test::Motion::deform, test::Motion::translation, test::Motion::still},
                         blended, kWidth, kHeight);
}

/// A floor and a flying ball under a lamp.
Shot lit_shot() {
  Shot shot;
  shot.meshes = {parallelogram({-4, -1, -2}, {8, 0, 0}, {0, 0, -8}, 0), ball({-1, 0, -5}, 0.7f, 6, 0),
                 parallelogram({-1, 3, -4}, {2, 0, 0}, {0, 0, -2}, 1)};
  Mesh& flying = shot.meshes[1];
  flying.key_times = {0, 1};
  flying.positions.push_back(flying.positions[0]);
  for (Vec3f& p : flying.positions[1]) p.x += 2;
  shot.materials = {lambert({0.8f, 0.6f, 0.4f}), lamp({8, 8, 8})};
  shot.projection.width = kWidth;
  shot.projection.height = kHeight;
  return shot;
}

struct Counts {
  size_t over_time = 0, instants = 0, foreign = 0, curves = 0;
};

Counts count(const PixelRecord& record) {
  Counts counts;
  for (const PixelRay& ray : record.rays) {
    ++(ray.is_over_time() ? counts.over_time : counts.instants);
    for (const SeenPart& part : record.parts_of(ray)) {
      counts.curves += part.knots > 1;
      for (const Knot& knot : record.knots_of(part))
        counts.foreign += !(knot.time >= part.where.begin && knot.time <= part.where.end);
    }
  }
  return counts;
}

TEST(OverTime, MovingPixelsGetRaysOverTimeAndColoursAtTheirOwnInstants) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const Shot shot = busy_shot(random, true);
  const MotionMask mask(std::make_shared<const ScreenMotion>(shot, 0.5), Crop{0, kWidth, 0, kHeight});
  size_t curves = 0;  // in all pictures: what moves may be hard to see
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic})
    for (const ShadingKind shading : {ShadingKind::normal, ShadingKind::whitted}) {
      RenderParams params;
      SCOPED_TRACE(testing::Message() << "integrator " << static_cast<int>(kind) << ", shading "
                                      << static_cast<int>(shading));
      params.integrator = kind;
      params.shading = shading;
      params.seed = seed;
      params.tc_rays = 4;
      params.spp = 16;  // too few for auto to choose rays over time beside a still layer
      const auto counts_of = [&](RecordNeeds::Time need) { return look_at<Counts>(shot, params, need, count); };
      size_t foreign = 0, instants = 0, lacking = 0, resting = 0;
      for (const auto& [place, counts] : counts_of(RecordNeeds::Time::curves)) {
        foreign += counts.foreign;
        curves += counts.curves;
        instants += counts.instants;
        const bool moves = mask.moves(place.second, place.first);
        lacking += moves && counts.over_time == 0;
        resting += !moves;
      }
      EXPECT_EQ(foreign, 0u);
      EXPECT_EQ(lacking, 0u);
      EXPECT_EQ(instants > 0, kind != IntegratorKind::tc && resting > 0);
      for (const auto& [place, counts] : counts_of(RecordNeeds::Time::segments)) {
        EXPECT_EQ(counts.instants, 0u);
        EXPECT_GT(counts.over_time, 0u);
        EXPECT_EQ(counts.foreign, 0u);
      }
    }
  EXPECT_GT(curves, 0u);
}

TEST(OverTime, ForABoxAloneColoursStandForEachOther) {
  std::mt19937 random(1);
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  const Shot shot = busy_shot(random, false);
  size_t foreign = 0, own = 0;
  for (const auto& [place, counts] : look_at<Counts>(shot, params, RecordNeeds::Time::box, count))
    foreign += counts.foreign;
  for (const auto& [place, counts] : look_at<Counts>(shot, params, RecordNeeds::Time::curves, count))
    own += counts.foreign;
  EXPECT_GT(foreign, 0u);
  EXPECT_EQ(own, 0u);
}

// The mean over the shutter of what is seen is the same, whatever is known of it besides.
TEST(OverTime, CurvesReduceToThePicture) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Shot shot = busy_shot(random, true);
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.tc_rays = 1;  // of which both make the same
  params.shading_samples = 256;
  params.clusters = Clusters::off;
  params.seed = seed;
  const Image image = render(shot, params);
  const auto colours =
      look_at<Vec3f>(shot, params, RecordNeeds::Time::curves, [](const PixelRecord& r) { return reduce(r).colour; });
  double difference = 0;
  for (const auto& [place, colour] : colours)
    for (int i = 0; i < 3; ++i)
      difference += std::pow(
          static_cast<double>(
              colour[i] -
              image.channels[static_cast<size_t>(i)].values[static_cast<size_t>(place.first * kWidth + place.second)]),
          2);
  EXPECT_LT(std::sqrt(difference / (3 * kWidth * kHeight)), 2e-3) << "of unit colours";
}

// An exposure of the first half of the shutter is a picture of the shot that is open for that half.
TEST(OverTime, WeighsTimeAfterwards) {
  const Shot shot = lit_shot();
  Shot half = shot;
  half.shutter_close = 0.5;
  half.meshes[1].positions[1] = half.meshes[1].positions[0];
  for (Vec3f& p : half.meshes[1].positions[1]) p.x += 1;
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.shading = ShadingKind::flat;
  params.tc_rays = 8;
  Picture first_half(shot.projection, params, TimeWeight({{0, 2}, {0.5, 2}}));
  PixelConsumer* const consumer = &first_half;
  Renderer(shot).render(params, {&consumer, 1});
  Picture of_half(half.projection, params, TimeWeight({{0, 1}, {1, 1}}));
  PixelConsumer* const other = &of_half;
  Renderer(half).render(params, {&other, 1});
  const Image expected = of_half.take(), image = first_half.take();
  for (size_t i = 0; i < expected.channels[0].values.size(); ++i)
    EXPECT_NEAR(image.channels[0].values[i], expected.channels[0].values[i], 1e-4);
}

// Of the same integrator at the same place, again and again, with other pixels in between.
TEST(OverTime, APixelRenderedTwiceIsTheSame) {
  const Shot shot = lit_shot();
  for (const RecordNeeds::Time need : {RecordNeeds::Time::box, RecordNeeds::Time::curves})
    for (const Clusters clusters : {Clusters::off, Clusters::on, Clusters::pixel})
      for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::qmc}) {
        RenderParams params;
        params.integrator = kind;
        params.shading = ShadingKind::whitted;
        params.clusters = clusters;
        params.tc_rays = 20;
        params.spp = 32;
        ShotParts parts(shot);
        const PixelContext context{CameraRays(shot.projection),
                                   Sampler(params.sampler, 32, params.seed),
                                   PixelFilter(params.filter),
                                   parts.shader(params.shading, false, params.max_depth, 0, true),
                                   shot.background,
                                   {need, false, false}};
        RenderStats stats;
        const auto integrator = kind == IntegratorKind::tc    ? make_tc_integrator(parts, params, context, stats)
                                : kind == IntegratorKind::qmc ? make_qmc_integrator(parts, params, context)
                                                              : make_mixed_integrator(parts, params, context, stats);
        const auto worker = integrator->make_worker();
        Monitor monitor(1);
        const auto colours = [&](int x, int y) {
          std::vector<float> values;
          for (const Knot& knot : worker->render_pixel(x, y, monitor).knots)
            values.insert(values.end(), {knot.time, knot.colour.x, knot.colour.y, knot.colour.z});
          return values;
        };
        const auto first = colours(12, 9);
        EXPECT_EQ(colours(12, 9), first) << "at once";
        colours(3, 12);
        EXPECT_EQ(colours(12, 9), first);
        EXPECT_FALSE(first.empty());
      }
}

// One shot, or two that follow on each other: the same random numbers at the same instants.
TEST(OverTime, GoesOnFromShotToShot) {
  const Shot whole = lit_shot();
  const auto part = [&](double open, double close) {
    Shot shot = whole;
    shot.shutter_open = open;
    shot.shutter_close = close;
    shot.meshes[1].positions[1] = shot.meshes[1].positions[0];
    for (Vec3f& p : shot.meshes[1].positions[0]) p.x += static_cast<float>(2 * open);
    for (Vec3f& p : shot.meshes[1].positions[1]) p.x += static_cast<float>(2 * close);
    return shot;
  };
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.shading = ShadingKind::whitted;
  params.tc_rays = 4;
  params.shading_interval = 1;
  using Curve = std::map<long, Vec3f>;  // by ray and instant
  // Of what is seen of the floor, without what is added at the ends of segments.
  const auto curves = [&](const Shot& shot) {
    return look_at<Curve>(shot, params, RecordNeeds::Time::curves, [&](const PixelRecord& record) {
      Curve curve;
      for (size_t r = 0; r < record.rays.size(); ++r)
        for (const SeenPart& seen : record.parts_of(record.rays[r]))
          for (uint32_t k = 1; seen.where.mesh == 0 && k + 1 < seen.knots; ++k) {
            const Knot& knot = record.knots_of(seen)[k];
            const double time =
                shot.shutter_open + static_cast<double>(knot.time) * (shot.shutter_close - shot.shutter_open);
            curve[std::lround(time * 1e4) + 100000 * static_cast<long>(r)] = knot.colour;
          }
      return curve;
    });
  };
  const auto together = curves(whole), first = curves(part(0, 0.375)), second = curves(part(0.375, 1));
  size_t same = 0, other = 0, met = 0;
  for (const auto* half : {&first, &second})
    for (const auto& [place, curve] : *half)
      for (const auto& [instant, colour] : curve) {
        const auto& expected = together.at(place);
        const auto found = expected.find(instant);
        if (found == expected.end()) continue;  // rounded otherwise
        ++met;
        ++(std::abs(found->second.x - colour.x) < 1e-3f * (colour.x + 0.01f) ? same : other);
      }
  size_t knots = 0;
  for (const auto& [place, curve] : together) knots += curve.size();
  EXPECT_GT(met, knots / 2)
      << "of six in a row: next to ends, two of which are where one shot follows the other, are none";
  EXPECT_LT(other, met / 50) << "edges of shadows, at which rounding decides";
  EXPECT_GT(knots, 1000u);
}

TEST(OverTime, DiscreteRaysHaveNoSegments) {
  RenderParams params;
  params.integrator = IntegratorKind::qmc;
  const auto seen = [&](RecordNeeds::Time need) { return look_at<Counts>(lit_shot(), params, need, count); };
  EXPECT_THROW(seen(RecordNeeds::Time::segments), Error);
  EXPECT_EQ(seen(RecordNeeds::Time::curves).size(), static_cast<size_t>(kWidth * kHeight));
}

// Over pictures of 30 seeds, against many time-continuous rays: whole pictures and single pixels.
TEST(Mixed, OfFewRaysIsNotBiased) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Shot shot = busy_shot(random, false);
  Renderer renderer(shot);
  constexpr int kSeeds = 30;
  std::vector<std::vector<float>> references;
  RenderParams params;
  params.shading = ShadingKind::flat;
  params.spp = 32;
  params.integrator = IntegratorKind::tc;
  params.tc_rays = 128;
  for (int i = 0; i < kSeeds; ++i) {
    params.seed = seed + static_cast<uint64_t>(2 * i + 1);
    references.push_back(renderer.render(params).channels[0].values);
  }
  params.integrator = IntegratorKind::mixed;
  for (const SamplerKind sampler : {SamplerKind::owen_sobol, SamplerKind::random})
    for (const int rays : {1, 2}) {
      params.sampler = sampler;
      params.tc_rays = rays;
      std::vector<double> sum(kWidth * kHeight), squares(kWidth * kHeight);
      double total = 0, total_squares = 0;
      for (int i = 0; i < kSeeds; ++i) {
        params.seed = seed + static_cast<uint64_t>(2 * i);
        const std::vector<float> values = renderer.render(params).channels[0].values;
        double whole = 0;
        for (size_t p = 0; p < sum.size(); ++p) {
          const double d = static_cast<double>(values[p]) - static_cast<double>(references[static_cast<size_t>(i)][p]);
          sum[p] += d;
          squares[p] += d * d;
          whole += d;
        }
        total += whole;
        total_squares += whole * whole;
      }
      const double mean = total / kSeeds;
      const double noise = std::sqrt((total_squares / kSeeds - mean * mean) / (kSeeds - 1));
      EXPECT_LT(std::abs(mean), 4.5 * noise) << rays << " rays, sampler " << static_cast<int>(sampler);
      double bias_squares = 0, square_noise = 0, fourth_powers = 0;
      for (size_t p = 0; p < sum.size(); ++p) {
        const double pixel_mean = sum[p] / kSeeds;
        bias_squares += pixel_mean * pixel_mean;
        const double variance = (squares[p] / kSeeds - pixel_mean * pixel_mean) / (kSeeds - 1);
        square_noise += variance;
        fourth_powers += 2 * variance * variance;
      }
      EXPECT_LT(bias_squares, square_noise + 6 * std::sqrt(fourth_powers))
          << rays << " rays, sampler " << static_cast<int>(sampler) << ", noise " << square_noise;
    }
}

TEST(Render, RefusesNumbersOfRaysThatMakeNoSense) {
  const Shot shot = lit_shot();
  const auto refused = [&](IntegratorKind kind, int tc_rays, int spp) {
    RenderParams params;
    params.integrator = kind;
    params.tc_rays = tc_rays;
    params.spp = spp;
    try {
      render(shot, params);
    } catch (const Error& error) {
      return error.code() == ErrorCode::bad_usage;
    }
    return false;
  };
  for (const int wrong : {-5, 0, (1 << 20) + 1}) {
    EXPECT_TRUE(refused(IntegratorKind::mixed, 4, wrong));
    EXPECT_TRUE(refused(IntegratorKind::mixed, wrong, 4));
    EXPECT_TRUE(refused(IntegratorKind::tc, wrong, 4));
    EXPECT_TRUE(refused(IntegratorKind::qmc, 4, wrong));
    EXPECT_TRUE(refused(IntegratorKind::automatic, 4, wrong));
  }
  RenderParams params;
  params.shading_interval = -1;
  EXPECT_THROW(render(shot, params), Error);
  params.shading_interval = 1e-9;
  EXPECT_THROW(render(shot, params), Error);
}

}  // namespace
}  // namespace kairos::over_time_test
