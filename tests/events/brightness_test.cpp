// The brightness that events claim, against independent rays.
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/image.h>
#include <kairos/render.h>

#include "recorded_events.h"
#include "seed.h"

namespace kairos {
namespace {

/// At any instant, of any scene, the brightness that events claim is within one threshold of what independent rays see:
/// discrete ones, at the same points of the pixel.
class EventClaims {
 public:
  explicit EventClaims(std::mt19937& random) : random_(random) {}

  void expect(const char* name, const Scene& scene, ShadingKind shading) {
    EventOptions options = flat_options(4);
    options.render.shading = shading;
    options.render.seed = random_();
    options.edges = EdgeModel::step;
    options.sensor.on = options.sensor.off = kContrast;
    options.shot.motion_tolerance = 1e-4;
    EventList list;
    record_events(scene, options, list);
    EXPECT_GT(list.events.size(), 60u) << name;
    const std::vector<double> first = brightness(scene, options, 0);
    constexpr int kInstants = 20;
    int broken = 0;
    for (int i = 0; i < kInstants; ++i) {
      const double time = std::uniform_real_distribution(0.0, 1.0)(random_);
      std::vector<double> claimed = first;
      for (const Event& event : list.events)
        if (static_cast<double>(event.time) * 1e-9 <= time)
          claimed[event.y * size_t{kWidth} + event.x] += kContrast * event.polarity;
      const std::vector<double> seen = brightness(scene, options, time);
      for (size_t pixel = 0; pixel < seen.size(); ++pixel)
        broken += std::abs(seen[pixel] - claimed[pixel]) > kContrast + kSlack;
    }
    // At an instant a ray may be nearer to an edge than rounding tells, or have been so at the first one.
    EXPECT_LE(broken, 0.01 * kInstants * kWidth * kHeight) << name;
  }

 private:
  static constexpr double kContrast = 0.1, kSlack = 2.5e-3;  // what straight lines between looks may be off by

  static std::vector<double> brightness(const Scene& scene, const EventOptions& options, double time) {
    ShotOptions shot = options.shot;
    shot.frame = 0;
    shot.fps = 1;
    shot.shutter = std::array<double, 2>{time, time};
    RenderParams params = options.render;
    params.integrator = IntegratorKind::qmc;
    params.sampler = SamplerKind::owen_sobol;
    params.filter = FilterKind::box;
    params.spp = options.rays;
    const Image image = render(make_shot(scene, shot), params);
    const auto &red = image.find("R")->values, &green = image.find("G")->values, &blue = image.find("B")->values;
    std::vector<double> result;
    for (size_t i = 0; i < red.size(); ++i)
      result.push_back(std::log(0.2126 * static_cast<double>(red[i]) + 0.7152 * static_cast<double>(green[i]) +
                                0.0722 * static_cast<double>(blue[i]) + kDark));
    return result;
  }

  std::mt19937& random_;
};

TEST(EventBrightness, IsThatOfDiscreteRaysInFiveScenes) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  EventClaims claims(random);
  const SceneDescription flat = flying_things(random, false);
  claims.expect("flat", *make_scene(flat), ShadingKind::flat);
  claims.expect("normals", *make_scene(flying_things(random, false)), ShadingKind::normal);
  SceneDescription travelling = flying_things(random, true);
  travelling.cameras[0].keys.clear();
  for (const double time : {-1.0, 2.0})
    travelling.cameras[0].keys.push_back(
        {time, {uniform(-0.5, 0.5), uniform(-0.5, 0.5), 0}, {uniform(-0.3, 0.3), uniform(-0.3, 0.3), -3}, {0, 1, 0}});
  claims.expect("a texture, from a camera that travels", *make_scene(travelling), ShadingKind::flat);
  // Shadows on a wall that rests and on what flies, of lights that bring no noise.
  SceneDescription lit = flying_things(random, true);
  lit.lights = {
      DirectionalLight{{static_cast<float>(uniform(-0.5, 0.5)), static_cast<float>(uniform(-0.5, 0.5)), -1}, {2, 2, 2}},
      PointLight{{static_cast<float>(uniform(-1, 1)), 1, 0}, {4, 4, 4}}};
  claims.expect("lights", *make_scene(lit), ShadingKind::whitted);
  SceneDescription mirror = lit;
  mirror.materials[0].metallic = 1;
  mirror.materials[0].roughness = 0;
  mirror.lights.pop_back();
  claims.expect("a mirror", *make_scene(mirror), ShadingKind::whitted);
}

}  // namespace
}  // namespace kairos
