// Materials, textures and spectra.
#include <cmath>

#include <kairos/image.h>

#include "pbrt_fixture.h"
#include "scene_io/pbrt/spectrum.h"
#include "shading/looks.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST_F(PbrtSurface, MaterialsOfBothVersions) {
  EXPECT_EQ(material_of("").base_color, (Vec3f{0.5, 0.5, 0.5}));
  for (const std::string matte : {"\"matte\" \"rgb Kd\" [.25 .5 1]", "\"diffuse\" \"rgb reflectance\" [.25 .5 1]"}) {
    const Material& m = material_of("Material " + matte);
    EXPECT_EQ(m.base_color, (Vec3f{0.25, 0.5, 1}));
    EXPECT_EQ(m.metallic, 0);
    EXPECT_EQ(m.roughness, 1);
  }
  for (const std::string glass : {"\"glass\" \"float index\" 1.25", "\"dielectric\" \"float eta\" 1.25"}) {
    const Material& m = material_of("Material " + glass);
    EXPECT_EQ(m.transmission, 1);
    EXPECT_EQ(m.ior, 1.25f);
    EXPECT_EQ(m.roughness, 0);
  }
  EXPECT_FLOAT_EQ(material_of("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"").ior, 1.5168f);
  EXPECT_EQ(material_of("Material \"glass\" \"rgb Kt\" [0 0 0]").transmission, 0);
  const Material& mirror = material_of("Material \"mirror\"");
  EXPECT_EQ(mirror.metallic, 1);
  EXPECT_EQ(mirror.roughness, 0);
  EXPECT_FLOAT_EQ(mirror.base_color.x, 0.9f);
  EXPECT_EQ(material_of("Material \"diffuse\" \"string normalmap\" \"a.png\"").normal_texture.picture,
            folder_.path("a.png"));
  EXPECT_THAT(scene_.warnings, IsEmpty());
}

TEST_F(PbrtSurface, MetalsHaveTheirReflectance) {
  for (const std::string kind : {"metal", "conductor"}) {
    const Material& m = material_of("Material \"" + kind +
                                    "\" \"rgb eta\" [1 2 .5] \"rgb k\" [1 3 0] "
                                    "\"float roughness\" .04 \"bool remaproughness\" \"false\"");
    expect_color(m.base_color, {1.0 / 5, 10.0 / 18, 1.0 / 9});
    EXPECT_EQ(m.metallic, 1);
    EXPECT_FLOAT_EQ(m.roughness, 0.2f);  // its square is alpha
  }
  expect_color(
      material_of("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"").base_color,
      {1, 0.782, 0.344});
  EXPECT_THAT(scene_.warnings, ElementsAre(HasSubstr("spectra are taken as three colours")));
  expect_color(material_of("Material \"conductor\" \"rgb reflectance\" [.1 .2 .3]").base_color, {0.1, 0.2, 0.3});
  EXPECT_NEAR(material_of("Material \"conductor\" \"float roughness\" .0625").roughness, 0.5, 1e-6) << "v4's remapping";
  EXPECT_NEAR(material_of("Material \"metal\" \"float roughness\" 1").roughness, 1, 1e-6) << "v3's, which leaves 1";
}

TEST_F(PbrtSurface, UberIsSeenThrough) {
  const Material& m = material_of("Material \"uber\" \"rgb opacity\" [.25 .25 .25]");
  EXPECT_EQ(m.alpha_mode, Material::AlphaMode::blend);
  EXPECT_FLOAT_EQ(m.alpha, 0.25f);
}

TEST_F(PbrtSurface, NamedMaterialsAndMixes) {
  const std::string named =
      "MakeNamedMaterial \"a\" \"string type\" \"matte\" \"rgb Kd\" [0 0 0]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"matte\" \"rgb Kd\" [1 1 1]\n";
  EXPECT_EQ(material_of(named + "NamedMaterial \"b\"").name, "b");
  // v3 gives the share of the first, v4 that of the second.
  expect_color(material_of(named + "Material \"mix\" \"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"b\" "
                                   "\"rgb amount\" [.75 .75 .75]")
                   .base_color,
               {0.25, 0.25, 0.25});
  expect_color(
      material_of(named + "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .75").base_color,
      {0.75, 0.75, 0.75});
  material_of("NamedMaterial \"c\"");
  EXPECT_THAT(scene_.warnings, ElementsAre(HasSubstr("scene.pbrt:4: no material 'c' is defined")));
  // One of ours for each that is used, however often.
  const Scene scene = load_world(named + "NamedMaterial \"a\"\n" + kTextured + "\nNamedMaterial \"b\"\n" + kTextured +
                                 "\nNamedMaterial \"a\"\n" + kTextured);
  EXPECT_THAT(scene.materials, SizeIs(2));
  EXPECT_EQ(scene.meshes[0].material, scene.meshes[2].material);
}

TEST_F(PbrtSurface, MaterialsMayBeDefinedLater) {
  const std::string red = "MakeNamedMaterial \"m\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n";
  const std::string blue = "MakeNamedMaterial \"m\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 0 1]\n";
  const std::string use = "NamedMaterial \"m\"\n" + std::string(kTextured) + "\n";
  const auto colours = [&](const std::string& text) {
    const Scene scene = load_world(text, true);
    std::vector<Vec3f> list;
    for (const SceneMesh& mesh : scene.meshes) list.push_back(scene.materials.at(mesh.material).base_color);
    return list;
  };
  EXPECT_THAT(colours(use + red), ElementsAre(Vec3f{1, 0, 0}));
  EXPECT_THAT(colours("ObjectBegin \"o\"\n" + use + "ObjectEnd\nObjectInstance \"o\"\n" + red),
              ElementsAre(Vec3f{1, 0, 0}));
  // A second definition counts for what follows it.
  EXPECT_THAT(colours(red + use + blue + use), ElementsAre(Vec3f{1, 0, 0}, Vec3f{0, 0, 1}));
  EXPECT_THAT(colours(use + red + use + blue + use), ElementsAre(Vec3f{1, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 0, 1}));
  // What is defined later to be invisible is.
  EXPECT_THAT(load_world(use + "MakeNamedMaterial \"m\" \"string type\" \"interface\"").meshes, IsEmpty());
}

TEST_F(PbrtSurface, TexturesAreEvaluatedAsFarAsPossible) {
  const std::string image = "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n";
  const auto kd = [&](const std::string& textures, const std::string& name) {
    return material_of(textures + "\nMaterial \"matte\" \"texture Kd\" \"" + name + "\"");
  };
  EXPECT_EQ(kd(image, "i").base_color_texture.picture, folder_.path("a.png"));
  EXPECT_EQ(kd(image, "i").base_color, (Vec3f{1, 1, 1}));
  const std::string v3 = image + "Texture \"s\" \"color\" \"scale\" \"texture tex1\" \"i\" \"rgb tex2\" [.25 .5 1]";
  EXPECT_EQ(kd(v3, "s").base_color_texture.picture, folder_.path("a.png"));
  EXPECT_EQ(kd(v3, "s").base_color, (Vec3f{0.25, 0.5, 1}));
  const std::string v4 = image + "Texture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"i\" \"float scale\" .5";
  EXPECT_EQ(kd(v4, "s").base_color, (Vec3f{0.5, 0.5, 0.5}));
  const std::string constants =
      "Texture \"k\" \"spectrum\" \"constant\" \"rgb value\" [0 .5 1]\nTexture \"w\" \"float\" "
      "\"constant\" \"float value\" .25\n";
  EXPECT_EQ(
      kd(constants +
             "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"k\" \"rgb tex2\" [1 1 1] \"texture amount\" \"w\"",
         "m")
          .base_color,
      (Vec3f{0.25, 0.625, 1}));
  EXPECT_THAT(scene_.warnings, IsEmpty());
  EXPECT_EQ(
      kd(image + "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"i\" \"rgb tex2\" [1 0 0] \"float amount\" .25",
         "m")
          .base_color_texture.picture,
      folder_.path("a.png"));
  EXPECT_THAT(scene_.warnings, ElementsAre(HasSubstr("only the stronger part")));
  kd("", "missing");
  EXPECT_THAT(scene_.warnings, ElementsAre(HasSubstr("no texture 'missing'")));
}

TEST_F(PbrtSurface, CheckerboardsAreDrawn) {
  const std::string square =
      "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point P\" [0 0 0 1 0 0 1 1 0 0 1 0] "
      "\"float uv\" [0 0 1 0 1 1 0 1]";
  const std::string board =
      "Texture \"c\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 3 \"float udelta\" .5 "
      "\"rgb tex1\" [1 .5 0] \"rgb tex2\" [0 0 2]\n"
      "Texture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"c\" \"float scale\" .5\n";
  const Shot shot =
      make_shot(load_world(board + "Material \"diffuse\" \"texture reflectance\" \"s\"\n" + square, true));
  const Looks looks(shot);
  const std::array<Vec3d, 3> corners{Vec3d{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  // Points of the first triangle; each square by the parity of pbrt's rule.
  for (const Vec2d at : {Vec2d{0.3, 0.1}, {0.05, 0.02}, {0.2, 0.15}, {0.6, 0.4}, {0.9, 0.2}, {0.95, 0.9}, {0.5, 0.3}}) {
    const auto weight = [](double w) { return static_cast<float>(w); };
    const Vec3f seen = looks.at(0, 0, corners, {weight(1 - at.x), weight(at.x - at.y), weight(at.y)}, 1e-4).base_colour;
    const double s = 4 * at.x + 0.5, t = 3 * at.y;
    const bool first = (static_cast<int>(std::floor(s)) + static_cast<int>(std::floor(t))) % 2 == 0;
    expect_near(to_double(seen), first ? Vec3d{0.5, 0.25, 0} : Vec3d{0, 0, 1}, 1e-6);
  }
  EXPECT_THAT(load_world(board + board).pictures, SizeIs(1)) << "equal ones are drawn once";
  const Scene in_space = load_world("Texture \"c\" \"spectrum\" \"checkerboard\" \"integer dimension\" 3");
  EXPECT_THAT(in_space.warnings, ElementsAre(HasSubstr("becomes one colour")));
}

TEST_F(PbrtSurface, TextureCoordinatesAreMapped) {
  material_of(
      "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"float uscale\" 2 \"float vscale\" 4 "
      "\"float udelta\" .5 \"float vdelta\" -1\nMaterial \"matte\" \"texture Kd\" \"i\"");
  const TextureRef& ref = scene_.materials.at(scene_.meshes[0].material).base_color_texture;
  const std::vector<Vec2f> expected{{0.5, 2}, {2.5, 2}, {0.5, -2}};
  for (size_t v = 0; v < 3; ++v) EXPECT_EQ(ref.place(scene_.meshes[0].uvs.at(v)), expected[v]);
}

TEST_F(PbrtSurface, MissingImagesAreReportedOnce) {
  const std::string text =
      "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.tga\"\n"
      "Texture \"j\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.tga\"\n"
      "Material \"matte\" \"texture Kd\" \"i\"";
  EXPECT_EQ(material_of(text).base_color, (Vec3f{0.5, 0.5, 0.5}));
  EXPECT_EQ(material_of(text).base_color_texture.picture, "");
  EXPECT_THAT(scene_.warnings, ElementsAre(HasSubstr("scene.pbrt:4: the file 'wood.tga' is not there")));
  expect_error([&] { load_world(text, true); }, {"scene.pbrt:4", "wood.tga"});
  const std::string outside = "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"/etc/passwd\"";
  EXPECT_THAT(load_world(outside).warnings, ElementsAre(HasSubstr("scene.pbrt:4: path '/etc/passwd'")));
  expect_error([&] { load_world(outside, true); }, {"scene.pbrt:4", "/etc/passwd"});
}

TEST_F(PbrtSurface, AlphaImagesMakeMasks) {
  const Scene scene =
      load_world("Texture \"l\" \"float\" \"imagemap\" \"string filename\" \"leaf.png\"\nMaterial \"matte\"\n" +
                 std::string(kTextured) + " \"texture alpha\" \"l\"\n" + kTextured + "\n" + kTextured +
                 " \"float alpha\" .25\n" + kTextured + " \"float alpha\" 0\n");
  ASSERT_THAT(scene.meshes, SizeIs(3));
  const auto& mask = scene.materials[scene.meshes[0].material];
  EXPECT_EQ(mask.alpha_mode, Material::AlphaMode::mask);
  EXPECT_EQ(mask.alpha_texture.picture, folder_.path("leaf.png"));
  EXPECT_EQ(scene.materials[scene.meshes[1].material].alpha_mode, Material::AlphaMode::opaque);
  EXPECT_EQ(scene.materials[scene.meshes[2].material].alpha_mode, Material::AlphaMode::blend);
  EXPECT_EQ(scene.materials[scene.meshes[2].material].alpha, 0.25f);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("cannot be seen")));
}

TEST_F(PbrtSurface, AnAlphaImageThatIsAbsentLeavesTheSurfaceWhole) {
  const std::string gone = "Texture \"g\" \"float\" \"imagemap\" \"string filename\" \"gone.png\"\n";
  const std::string half = "Texture \"h\" \"float\" \"scale\" \"texture tex\" \"g\" \"float scale\" .5\n";
  for (const std::string name : {"g", "h"}) {
    const Scene scene = load_world(gone + half + kTextured + " \"texture alpha\" \"" + name + "\"");
    EXPECT_EQ(scene.materials[scene.meshes.at(0).material].alpha_mode, Material::AlphaMode::opaque);
    EXPECT_EQ(scene.materials[scene.meshes[0].material].alpha, 1);
    EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("'gone.png' is not there")));
  }
}

TEST_F(PbrtSurface, AlphaImagesAreLookedUp) {
  Image image{1, 1, 0, 0, 1, 1, {}, {}};
  for (const char* channel : {"R", "G", "B"}) image.channels.push_back({channel, Channel::Storage::colour, {0}});
  write_image(image, folder_.path("leaf.png"));
  const std::string leaf = "Texture \"l\" \"float\" \"imagemap\" \"string filename\" \"leaf.png\"\n";
  const Shot shot = make_shot(load_world(leaf + kTextured + " \"texture alpha\" \"l\"\n" + kTextured));
  const Looks looks(shot);
  const std::array<Vec3d, 3> corners{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(looks.at(0, 0, corners, {0.25f, 0.25f, 0.5f}, 0.01).alpha, 0);
  EXPECT_EQ(looks.at(0, 0, corners, {0.25f, 0.25f, 0.5f}, 0.01).base_colour, (Vec3f{0.5, 0.5, 0.5}));
  EXPECT_EQ(looks.at(1, 0, corners, {0.25f, 0.25f, 0.5f}, 0.01).alpha, 1);
}

TEST_F(PbrtSurface, InterfacesAreInvisible) {
  EXPECT_THAT(load_world("Material \"interface\"\n" + std::string(kTextured)).meshes, IsEmpty());
  EXPECT_THAT(load_world("Material \"\" AreaLightSource \"diffuse\"\n" + std::string(kTextured)).meshes, SizeIs(1));
}

TEST_F(PbrtSurface, AttributeGivesDefaults) {
  const Scene scene = load_world(
      "AttributeBegin Attribute \"shape\" \"float radius\" 3 Attribute \"material\" \"rgb reflectance\" [1 0 0]\n"
      "Material \"diffuse\" Shape \"sphere\" Shape \"sphere\" \"float radius\" 2 AttributeEnd Shape \"sphere\"");
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_NEAR(length(positions(scene.meshes[0])[0]), 3, 1e-6);
  EXPECT_NEAR(length(positions(scene.meshes[1])[0]), 2, 1e-6);
  EXPECT_NEAR(length(positions(scene.meshes[2])[0]), 1, 1e-6);
  EXPECT_EQ(scene.materials[scene.meshes[0].material].base_color, (Vec3f{1, 0, 0}));
}

TEST_F(PbrtSurface, BlackBodiesHaveTheColourOfTheirTemperature) {
  const Vec3d warm = pbrt::blackbody_color(2700), sun = pbrt::blackbody_color(6504), sky = pbrt::blackbody_color(12000);
  EXPECT_EQ(warm.x, 1);
  EXPECT_GT(warm.y, 2 * warm.z);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sun[axis], 1, 0.06) << "nearly the white of D65";
  EXPECT_EQ(sky.z, 1);
  EXPECT_LT(sky.x, sky.y);
  EXPECT_EQ(pbrt::blackbody_color(-1), (Vec3d{}));
  for (const double kelvin : {1e-300, 1.0, 1e300}) EXPECT_TRUE(is_finite(pbrt::blackbody_color(kelvin)));
  // v4 gives the temperature alone, and makes the luminance 1; v3 makes the spectrum's peak 1, wherever it lies.
  const Scene scene = load_world(
      "LightSource \"point\" \"blackbody I\" 2700\nLightSource \"point\" \"blackbody I\" [2700 4]\n"
      "LightSource \"point\" \"blackbody I\" [5400 1]");
  const auto seen = [&](size_t light) { return to_double(std::get<PointLight>(scene.lights[light]).intensity); };
  const auto luminance = [](Vec3d c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; };
  EXPECT_NEAR(luminance(seen(0)), 1, 1e-6);
  expect_near(seen(0) / seen(0).x, warm, 1e-6);
  expect_near(seen(1) / seen(1).x, warm, 1e-6);
  // At 555 nm, where the eye sees best, Planck's law gives 2700 K this part of its peak, which lies at 1073 nm.
  const double planck = std::pow(1073.25 / 555, 5) * std::expm1(4.965114) / std::expm1(1.438776877e7 / (555 * 2700));
  EXPECT_NEAR(luminance(seen(1)), 4 * planck, 0.1 * 4 * planck);
  EXPECT_NEAR(luminance(seen(2)), 1, 0.05) << "the peak is where the eye sees best";
}

TEST_F(PbrtSurface, SampledSpectraBecomeThreeBands) {
  expect_near(pbrt::band_color({400, 0.5, 700, 0.5}), {0.5, 0.5, 0.5});
  expect_near(pbrt::band_color({400, 0, 700, 3}), {2.3, 1.35, 0.55});  // the bands' middles: 630, 535 and 455 nm
  folder_.write("s.spd", "# samples\n400 0\n700 3\n");
  expect_color(material_of("Material \"matte\" \"spectrum Kd\" \"s.spd\"").base_color, {1, 1, 0.55});
}

}  // namespace
}  // namespace kairos
