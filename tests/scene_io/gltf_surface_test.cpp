// Materials, cameras and lights of glTF.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

using testing::HasSubstr;

TEST(GltfSurface, MaterialsKeepTheirFactors) {
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root["materials"] = {
      {{"name", "glass"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.25, 0.5, 0.75, 0.5}}, {"metallicFactor", 0}, {"roughnessFactor", 0.25}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.75},
       {"doubleSided", true},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
         {"KHR_materials_ior", {{"ior", 1.25}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}}};
  gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene scene = gltf.parse();
  const Material& m = scene.materials.at(scene.meshes[0].material);
  EXPECT_EQ(m.name, "glass");
  EXPECT_EQ(m.base_color, (Vec3f{0.25, 0.5, 0.75}));
  EXPECT_EQ(m.alpha, 0.5f);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emission, (Vec3f{8, 4, 0}));
  EXPECT_EQ(m.alpha_mode, Material::AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.75f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.ior, 1.25f);
  EXPECT_EQ(m.transmission, 1);
}

TEST(GltfSurface, CoatsAndSpecularAreReadAndWhatIsLostIsNamed) {
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root["materials"] = {
      {{"occlusionTexture", {{"index", 0}}},
       {"extensions",
        {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.25}}},
         {"KHR_materials_specular", {{"specularFactor", 0.75}, {"specularColorFactor", {1, 0.5, 2}}}},
         {"KHR_materials_sheen", {{"sheenColorFactor", {0, 0, 0.5}}}},
         {"KHR_materials_iridescence", {{"iridescenceFactor", 0}}},
         {"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}, {"anisotropyTexture", {{"index", 0}}}}}}}}};
  const Scene scene = gltf.parse();
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.clearcoat, 0.5f);
  EXPECT_EQ(m.clearcoat_roughness, 0.25f);
  EXPECT_EQ(m.specular, 0.75f);
  EXPECT_EQ(m.specular_color, (Vec3f{1, 0.5f, 2}));
  EXPECT_THAT(scene.warnings,
              testing::ElementsAre(HasSubstr("materials[0]: pictures of occlusion"), HasSubstr("sheen is left out"),
                                   HasSubstr("anisotropy is left out: highlights are round")));
}

TEST(GltfSurface, WithoutAMaterialTheSpecificationsDefaultHolds) {
  GltfBuilder gltf;
  gltf.triangle_node();
  const Scene scene = gltf.parse();
  const Material& m = scene.materials.at(scene.meshes[0].material);
  EXPECT_EQ(m.base_color, (Vec3f{1, 1, 1}));
  EXPECT_EQ(m.metallic, 1);
  EXPECT_FALSE(m.double_sided);
}

TEST(GltfSurface, TexturesArePathsBesideTheFile) {
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root["images"] = {{{"uri", "old%20wood.png"}}};
  gltf.root["textures"] = {{{"source", 0}}};
  gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  const Scene scene = GltfBuilder::parse_text(gltf.text(), {}, "/nowhere/scenes");
  EXPECT_EQ(scene.materials[0].base_color_texture.picture, "/nowhere/scenes/old wood.png");
  gltf.root["images"][0]["uri"] = "textures\\wood.png";
  EXPECT_EQ(GltfBuilder::parse_text(gltf.text(), {}, "/nowhere/scenes").materials[0].base_color_texture.picture,
            "/nowhere/scenes/textures/wood.png");
  gltf.root["images"][0]["uri"] = "../../etc/passwd";
  const Scene without = GltfBuilder::parse_text(gltf.text(), {}, "/nowhere/scenes");
  EXPECT_TRUE(without.materials[0].base_color_texture.empty());
  EXPECT_THAT(without.warnings, testing::ElementsAre(HasSubstr("a picture is left out: images[0]")));
  gltf.root["images"][0]["uri"] = "DATA:image/png;base64,AAAA";
  const Scene inside = GltfBuilder::parse_text(gltf.text(), {}, "/nowhere/scenes");
  EXPECT_EQ(inside.embedded_pictures.begin()->second.size(), 3u);
  gltf.root["images"][0]["uri"] = "dta:image/png;base64," + std::string(100'000, 'A');
  EXPECT_LT(GltfBuilder::parse_text(gltf.text(), {}, "/nowhere/scenes").warnings.at(0).size(), 300u);
}

TEST(GltfSurface, CamerasMoveWithTheirNodesAndHaveNoScale) {
  GltfBuilder gltf;
  gltf.root["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 3}, {"znear", 0.1}, {"zfar", 10}}}}};
  const int node = gltf.push("nodes", {{"camera", 0}, {"name", "eye"}, {"scale", {2, -2, 2}}});
  gltf.push("nodes", {{"camera", 1}});
  const float half = std::sqrt(0.5f);
  gltf.animate(node, "translation", {0, 1}, {0, 0, 0, 4, 0, 0}, "VEC3");
  gltf.animate(node, "rotation", {0, 1}, {0, 0, 0, 1, 0, half, 0, half}, "VEC4");  // 90 degrees about y
  const Scene scene = gltf.parse();
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "eye");
  EXPECT_EQ(scene.cameras[0].vfov, 0.5);
  EXPECT_TRUE(scene.cameras[1].orthographic);
  EXPECT_EQ(scene.cameras[1].view_height, 6);
  EXPECT_TRUE(scene.cameras[1].motion->is_static(0, 1));
  const TransformMotion& motion = *scene.cameras[0].motion;
  EXPECT_FALSE(motion.is_static(0, 1));
  const Vec3d ahead = transform_point(motion.at(1, Side::after), {0, 0, -1});
  EXPECT_NEAR(ahead.x, 3, 1e-6) << "looks along -x after a quarter turn about y";
  EXPECT_NEAR(ahead.z, 0, 1e-6);
  EXPECT_NEAR(determinant3(motion.at(0.3, Side::after)), 1, 1e-9) << "neither scale nor mirroring is left";
  gltf.root["cameras"][0]["perspective"]["yfov"] = 0;
  EXPECT_THROW(gltf.parse(), Error);
  gltf.root["cameras"][0]["perspective"].erase("yfov");
  try {
    gltf.parse();
    FAIL() << "sees nothing";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("cameras[0].perspective: yfov is missing"));
  }
}

TEST(GltfSurface, LightsAreKept) {
  GltfBuilder gltf;
  const float half = std::sqrt(0.5f);
  gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 10}, {"color", {1, 0.5, 0}}},
      {{"type", "directional"}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
      {{"type", "area"}}};
  const auto lit = [](int light) { return nlohmann::json{{"KHR_lights_punctual", {{"light", light}}}}; };
  gltf.push("nodes", {{"translation", {1, 2, 3}}, {"extensions", lit(0)}});
  gltf.push("nodes", {{"rotation", {0, half, 0, half}}, {"extensions", lit(1)}});
  gltf.push("nodes", {{"translation", {4, 5, 6}}, {"extensions", lit(2)}});
  gltf.push("nodes", {{"extensions", lit(3)}});
  const Scene scene = gltf.parse();
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).position, (Vec3f{1, 2, 3}));
  EXPECT_EQ(std::get<PointLight>(scene.lights[0]).intensity, (Vec3f{10, 5, 0}));
  EXPECT_NEAR(std::get<DirectionalLight>(scene.lights[1]).direction.x, -1, 1e-6);
  EXPECT_THAT(scene.warnings, testing::ElementsAre(HasSubstr("'area'")));
  gltf.animate(0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
  const Scene moves = gltf.parse();
  EXPECT_THAT(moves.warnings, testing::ElementsAre(HasSubstr("'area'"))) << "which says nothing of the one that moves";
  ASSERT_EQ(moves.moving_lights.size(), 1u);
  ShotOptions options;
  options.fps = 1;
  options.shutter = {0, 1};
  const Shot shot = make_shot(moves, options);
  ASSERT_EQ(shot.moving_lights.size(), 3u);
  EXPECT_EQ(std::get<PointLight>(shot.moving_lights[0](0.25)).position, (Vec3f{0.25f, 0, 0}));
  EXPECT_FALSE(shot.moving_lights[1]);
  options.shutter = {2, 3};
  const Shot after = make_shot(moves, options);
  EXPECT_TRUE(after.moving_lights.empty()) << "it rests while the shutter is open";
  EXPECT_EQ(std::get<PointLight>(after.lights[0]).position, (Vec3f{1, 0, 0})) << "where it has come to";
  const SpotLight spot = std::get<SpotLight>(scene.lights[2]);
  EXPECT_EQ(spot.position, (Vec3f{4, 5, 6}));
  EXPECT_EQ(spot.direction, (Vec3f{0, 0, -1}));
  EXPECT_EQ(spot.intensity, (Vec3f{1, 1, 1}));
  EXPECT_FLOAT_EQ(spot.cos_inner, std::cos(0.25f));
  EXPECT_FLOAT_EQ(spot.cos_outer, std::cos(0.5f));
  gltf.root["extensions"]["KHR_lights_punctual"]["lights"][2]["spot"]["innerConeAngle"] = 0.6;
  EXPECT_THROW(gltf.parse(), Error);
  gltf.root["nodes"].erase(2);
  gltf.root["nodes"][0]["extensions"] = lit(4);
  EXPECT_THROW(gltf.parse(), Error);
}

}  // namespace
}  // namespace kairos
