// Lights: of areas, at points, far away; what the film makes of them.
#include <cmath>

#include "pbrt_fixture.h"

namespace kairos {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class PbrtLight : public PbrtSurface {};

TEST_F(PbrtLight, AreaLightsEmit) {
  const Scene scene = load_world("AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" 2\n" +
                                 std::string(kTextured) + "\nAttributeEnd\n" + kTextured);
  EXPECT_EQ(scene.materials[scene.meshes[0].material].emission, (Vec3f{2, 4, 6}));
  EXPECT_EQ(scene.materials[scene.meshes[1].material].emission, (Vec3f{}));
}

TEST_F(PbrtLight, AreaLightsShineFromTheirFronts) {
  const auto light = [&](const std::string& parameters, const std::string& shape = kTextured) {
    scene_ = load_world("AreaLightSource \"diffuse\" \"rgb L\" [1 2 4] " + parameters + "\n" + shape);
    return scene_.materials.at(scene_.meshes.at(0).material);
  };
  EXPECT_TRUE(light("").one_sided_emission);
  EXPECT_FALSE(light("\"bool twosided\" true").one_sided_emission);
  EXPECT_FALSE(material_of("").one_sided_emission);
  EXPECT_TRUE(light("\"bool twosided\" true").lamp);
  EXPECT_FALSE(material_of("").lamp);
  // The front is where the normals point.
  light("", "Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -1]");
  EXPECT_LT(geometric_normal(scene_.meshes[0]).z, 0);
  const Material unseen = light("", std::string(kTextured) + " \"float alpha\" 0");
  EXPECT_TRUE(unseen.emits_where_cut_out);
  EXPECT_EQ(unseen.alpha_mode, Material::AlphaMode::mask);
  EXPECT_LT(unseen.alpha, unseen.alpha_cutoff);
  EXPECT_EQ(unseen.emission, (Vec3f{1, 2, 4}));
  EXPECT_THAT(scene_.warnings, IsEmpty());
}

TEST_F(PbrtLight, PowersAndIlluminances) {
  const auto light = [&](const std::string& statement) {
    scene_ = load_world("LightSource " + statement);
    EXPECT_THAT(scene_.warnings, IsEmpty());
    return scene_.lights.at(0);
  };
  constexpr float kPi = 3.14159265f;
  expect_color(std::get<PointLight>(light("\"point\" \"float power\" 100")).intensity,
               Vec3d{1, 1, 1} * (25 / double{kPi}));
  expect_color(
      std::get<PointLight>(light("\"point\" \"rgb I\" [.5 1 2] \"float power\" 8 \"float scale\" 3")).intensity,
      Vec3d{0.5, 1, 2} * (6 / double{kPi}));
  expect_color(std::get<DirectionalLight>(light("\"distant\" \"float illuminance\" 7")).irradiance, {7, 7, 7});
  expect_color(std::get<ConstantLight>(light("\"infinite\" \"rgb L\" [1 .5 0] \"float illuminance\" 7")).radiance,
               Vec3d{1, 0.5, 0} * (7 / double{kPi}));
  // The whole cone with a sharp edge: 2 pi (1 - cos).
  expect_color(
      std::get<SpotLight>(light("\"spot\" \"float coneangle\" 60 \"float conedeltaangle\" 0 \"float power\" 9"))
          .intensity,
      Vec3d{1, 1, 1} * (9 / double{kPi}));
  const auto emission = [&](const std::string& statements, size_t mesh = 0) {
    scene_ = load_world(statements);
    return scene_.materials.at(scene_.meshes.at(mesh).material).emission.x;
  };
  const std::string area = "AreaLightSource \"diffuse\" \"float power\" 10 ";
  // Each triangle of a mesh is a light of its own; transforms count.
  EXPECT_NEAR(emission(area + kTextured), 10 / (kPi * 0.5f), 1e-4);
  EXPECT_NEAR(emission(area + "Scale 2 3 1 " + kTextured), 10 / (kPi * 3), 1e-4);
  EXPECT_NEAR(emission(area + "\"bool twosided\" true " + kTextured), 5 / (kPi * 0.5f), 1e-4);
  EXPECT_NEAR(emission(area + "Shape \"sphere\" \"float radius\" 2"), 10 / (kPi * 16 * kPi), 1e-3);
}

TEST_F(PbrtLight, TheFilmMakesLightsBrighter) {
  const auto film = [&](const std::string& camera, const std::string& statement, size_t warnings = 0) {
    scene_ = load("Scale -1 1 1\nCamera \"perspective\" " + camera + "\nFilm " + statement +
                  "\nWorldBegin LightSource \"infinite\" \"rgb L\" [1 1 1] LightSource \"point\"\n"
                  "AreaLightSource \"diffuse\" \"rgb L\" [2 2 2]\n" +
                  kTextured);
    EXPECT_THAT(scene_.warnings, SizeIs(warnings));
    const float factor = std::get<ConstantLight>(scene_.lights.at(0)).radiance.x;
    EXPECT_EQ(scene_.background.x, factor);
    EXPECT_EQ(std::get<PointLight>(scene_.lights.at(1)).intensity.x, factor);
    EXPECT_EQ(scene_.materials.at(scene_.meshes.at(0).material).emission.x, 2 * factor);
    return factor;
  };
  EXPECT_EQ(film("", "\"rgb\""), 1);
  EXPECT_EQ(film("", "\"rgb\" \"float iso\" 400"), 4);
  EXPECT_EQ(film("\"float shutteropen\" 1 \"float shutterclose\" 1.5", "\"rgb\" \"float iso\" 800"), 4);
  EXPECT_EQ(film("\"float shutterclose\" .5", "\"image\""), 1) << "v3 has no exposure time";
  EXPECT_EQ(film("\"float shutterclose\" .5", "\"image\" \"float scale\" 3"), 3);
  EXPECT_EQ(film("\"float shutterclose\" 0", "\"rgb\"", 1), 1);
  EXPECT_EQ(film("", "\"image\" \"float maxsampleluminance\" 5", 1), 1);
  EXPECT_THAT(scene_.warnings[0], HasSubstr("'maxsampleluminance' is left out"));
  film("", "\"rgb\" \"float maxcomponentvalue\" 5 \"float frobs\" 2 \"string sensor\" \"canon_eos_5d\"", 2);
  EXPECT_EQ(make_shot(scene_).brightest, 5);
  EXPECT_THAT(scene_.warnings, Contains(HasSubstr("parameter 'frobs' of film 'rgb' is left out")));
}

TEST_F(PbrtLight, LightsMove) {
  const std::string statements =
      "TransformTimes 1 3\nWorldBegin\nAttributeBegin\nActiveTransform EndTime Translate 0 8 0 Rotate 90 0 0 1 "
      "ActiveTransform "
      "All\n"
      "LightSource \"spot\" \"point from\" [1 0 0] \"point to\" [2 0 0]\n"
      "LightSource \"infinite\"\nAttributeEnd LightSource \"point\" \"point from\" [1 0 0]";
  const auto moving = [&](const std::string& before) {
    scene_ = load(before + "Camera \"perspective\" \"float shutterclose\" 3\n" + statements);
    EXPECT_THAT(scene_.warnings, ElementsAre(HasSubstr("a light that moves stays where it starts")));
    const Shot shot = make_shot(scene_);
    EXPECT_EQ(shot.moving_lights.size(), 3u);
    EXPECT_FALSE(shot.moving_lights.at(1));
    EXPECT_TRUE(std::holds_alternative<PointLight>(shot.lights.at(2)));
    return shot.moving_lights.at(0);
  };
  const auto at = [](const std::function<Light(double)>& light, double time) {
    return std::get<SpotLight>(light(time));
  };
  const double side = std::sqrt(0.5);
  for (const bool mirrored : {false, true}) {
    // A camera from a mirrored space leaves the world as it is written; from any other the world is mirrored in x.
    const double x = mirrored ? 1 : -1;
    const auto light = moving(mirrored ? "Scale -1 1 1\n" : "");
    expect_near(to_double(at(light, 1.0 / 3).position), {x, 0, 0}, 1e-6);
    expect_near(to_double(at(light, 1.0 / 3).direction), {x, 0, 0}, 1e-6);
    expect_near(to_double(at(light, 2.0 / 3).position), {x * side, 4 + side, 0}, 1e-5);
    expect_near(to_double(at(light, 2.0 / 3).direction), {x * side, side, 0}, 1e-6);
    expect_near(to_double(at(light, 1).position), {0, 9, 0}, 1e-5);
  }
}

TEST_F(PbrtLight, ALightsMatrixMayProject) {
  const std::string exchanged = "ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 8.87  0 0 0 1]\n";
  const Scene scene = load_world("AttributeBegin\n" + exchanged +
                                     "LightSource \"infinite\" \"rgb L\" [.7 .7 .7]\n"
                                     "LightSource \"point\" \"point3 from\" [0 0 2]\nAttributeEnd\n",
                                 true);
  EXPECT_EQ(std::get<ConstantLight>(scene.lights.at(0)).radiance.x, 0.7f);
  EXPECT_NEAR(std::get<PointLight>(scene.lights.at(1)).position.z, 2 / (1 + 2 * 8.87), 1e-6);
  // A shape's points are divided, as pbrt divides them.
  const Scene shape = load_world("Transform [1 0 0 0  0 1 0 0  0 0 1 1  0 0 0 1]\n" + std::string(kTriangle));
  expect_near(positions(shape.meshes[0])[0], Vec3d{1, 2, 3} / 4.0, 1e-6);
}

TEST_F(PbrtLight, Lights) {
  const Scene scene = load_world(
      "Translate 1 2 3\nLightSource \"point\" \"rgb I\" [1 2 3] \"point from\" [1 0 0] \"rgb scale\" [2 2 2]\n"
      "LightSource \"distant\" \"point from\" [0 4 0] \"point to\" [0 0 0] \"rgb L\" [5 5 5] \"float scale\" 2\n"
      "LightSource \"infinite\" \"rgb L\" [.5 .25 1]\nLightSource \"spot\" \"rgb I\" [1 1 1] \"point3 from\" [0 0 0]\n"
      "LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float scale\" 3\nLightSource \"strange\"");
  ASSERT_THAT(scene.lights, SizeIs(5));
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).position, (Vec3f{2, 2, 3}));
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).intensity, (Vec3f{2, 4, 6}));
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[1]).direction, (Vec3f{0, -1, 0}));
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[1]).irradiance, (Vec3f{10, 10, 10}));
  EXPECT_EQ(std::get<ConstantLight>(scene.lights[2]).radiance, (Vec3f{0.5, 0.25, 1}));
  EXPECT_EQ(scene.background, (Vec3f{0.5, 0.25, 1}));
  const auto& spot = std::get<SpotLight>(scene.lights[3]);
  EXPECT_EQ(spot.position, (Vec3f{1, 2, 3}));
  EXPECT_EQ(spot.direction, (Vec3f{0, 0, 1}));
  EXPECT_NEAR(spot.cos_inner, std::cos(25 * M_PI / 180), 1e-6);
  EXPECT_NEAR(spot.cos_outer, std::cos(30 * M_PI / 180), 1e-6);
  EXPECT_EQ(std::get<ConstantLight>(scene.lights[4]).radiance, (Vec3f{3, 3, 3}));
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("'sky.exr' is not there"), HasSubstr("'strange' are left out")));
}

TEST_F(PbrtLight, EnvironmentsHaveTheAxesOfTheirTransform) {
  folder_.write("sky.exr", "");
  using Mapping = EnvironmentLight::Mapping;
  const auto light = [&](const std::string& before, const std::string& parameters, bool mirrored = false) {
    const std::string world =
        "AttributeBegin " + before + "\nLightSource \"infinite\" " + parameters + "\nAttributeEnd\n";
    const Scene scene = mirrored ? load("Camera \"perspective\"\nWorldBegin\n" + world) : load_world(world);
    EXPECT_THAT(scene.warnings, SizeIs(0));
    EXPECT_EQ(scene.background, Vec3f{});
    return std::get<EnvironmentLight>(scene.lights.at(0));
  };
  const auto expect_axes = [](const EnvironmentLight& seen, Vec3d x, Vec3d y, Vec3d z) {
    expect_near(seen.axes[0], x, 1e-9);
    expect_near(seen.axes[1], y, 1e-9);
    expect_near(seen.axes[2], z, 1e-9);
  };
  // v3: the middle of the picture, our -z, lies at its -x; its right, our +x, at its -y; the upper edge at its +z.
  const std::string v3 = "\"string mapname\" \"sky.exr\" \"rgb L\" [1 2 3] \"rgb scale\" [2 2 2]";
  const EnvironmentLight plain = light("", v3);
  EXPECT_EQ(plain.mapping, Mapping::latitude_longitude);
  EXPECT_EQ(plain.texture, folder_.path("sky.exr"));
  EXPECT_EQ(plain.radiance, (Vec3f{2, 4, 6}));
  expect_axes(plain, {0, -1, 0}, {0, 0, 1}, {1, 0, 0});
  expect_axes(light("Rotate 90 0 0 1", v3), {1, 0, 0}, {0, 0, 1}, {0, 1, 0});
  expect_axes(light("Scale 2 2 -2", v3), {0, -1, 0}, {0, 0, -1}, {1, 0, 0});
  expect_axes(light("", v3, true), {0, -1, 0}, {0, 0, 1}, {-1, 0, 0});
  const std::string v4 = "\"string filename\" \"sky.exr\" \"float scale\" 0.5";
  const EnvironmentLight square = light("Rotate -90 1 0 0", v4);
  EXPECT_EQ(square.mapping, Mapping::equal_area);
  EXPECT_EQ(square.radiance, (Vec3f{0.5f, 0.5f, 0.5f}));
  expect_axes(square, {1, 0, 0}, {0, 0, -1}, {0, 1, 0});
}

}  // namespace
}  // namespace kairos
