// Where a glTF file's pictures lie on its surfaces, and materials of other models than glTF's own.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A triangle with two sets of texture coordinates and a material that has a picture.
GltfBuilder textured(const nlohmann::json& info = {{"index", 0}}) {
  GltfBuilder gltf;
  gltf.triangle_node();
  auto& primitive = gltf.root["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = gltf.accessor(std::vector<float>{0, 0, 1, 0, 0.5f, 2}, "VEC2");
  primitive["attributes"]["TEXCOORD_1"] = gltf.accessor(std::vector<float>{5, 5, 6, 6, 7, 7}, "VEC2");
  primitive["material"] = 0;
  gltf.root["images"] = nlohmann::json::array({{{"uri", "wood.png"}}});
  gltf.root["textures"] = nlohmann::json::array({{{"source", 0}}});
  gltf.root["materials"] = nlohmann::json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", info}}}}});
  return gltf;
}

Scene parse(GltfBuilder& gltf) { return GltfBuilder::parse_text(gltf.text(), {}, "/nowhere"); }

/// Where the base colour's picture lies, or another one.
void expect_uvs(const Scene& scene, const std::vector<Vec2f>& expected,
                TextureRef Material::*picture = &Material::base_color_texture) {
  const TextureRef& texture = scene.materials.at(0).*picture;
  const SceneMesh& mesh = scene.meshes.at(0);
  const std::vector<Vec2f>& uvs = texture.uv_set == 0 ? mesh.uvs.get() : mesh.more_uvs.at(texture.uv_set - 1);
  ASSERT_EQ(uvs.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(texture.place(uvs[i]).x, expected[i].x, 1e-6) << i;
    EXPECT_NEAR(texture.place(uvs[i]).y, expected[i].y, 1e-6) << i;
  }
}

TEST(GltfTexture, ATransformMovesItsCoordinates) {
  const auto place = [](const nlohmann::json& transform) {
    GltfBuilder gltf = textured({{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}});
    gltf.root["extensionsUsed"] = {"KHR_texture_transform"};
    const Scene scene = parse(gltf);
    EXPECT_THAT(scene.warnings, IsEmpty());
    return scene;
  };
  expect_uvs(place(nlohmann::json::object()), {{0, 0}, {1, 0}, {0.5f, 2}});
  expect_uvs(place({{"offset", {0.5, 0.25}}, {"scale", {2, 3}}}), {{0.5f, 0.25f}, {2.5f, 0.25f}, {1.5f, 6.25f}});
  // Counter-clockwise where v points down: what lay to the right lies above. First the scale, then the turn.
  expect_uvs(place({{"rotation", M_PI / 2}, {"scale", {2, 3}}, {"offset", {0, 1}}}), {{0, 1}, {0, -1}, {6, 0}});
  expect_uvs(place({{"texCoord", 1}, {"scale", {2, 1}}}), {{10, 5}, {12, 6}, {14, 7}});
  const Scene huge = place({{"scale", {1e300, 1}}});
  for (const Vec3f& row : huge.materials[0].base_color_texture.placement) EXPECT_TRUE(is_finite(row));
  EXPECT_THROW(place({{"offset", {"a", 2}}}), Error);
}

TEST(GltfTexture, TakesTheCoordinatesThatItsMaterialNames) {
  GltfBuilder gltf = textured({{"index", 0}, {"texCoord", 1}});
  expect_uvs(parse(gltf), {{5, 5}, {6, 6}, {7, 7}});
  gltf.root["materials"][0]["emissiveTexture"] = {{"index", 0}};
  gltf.root["materials"][0]["normalTexture"] = {
      {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"texCoord", 1}, {"offset", {1, 0}}}}}}};
  const Scene scene = parse(gltf);
  EXPECT_THAT(scene.warnings, IsEmpty());
  expect_uvs(scene, {{5, 5}, {6, 6}, {7, 7}});
  expect_uvs(scene, {{0, 0}, {1, 0}, {0.5f, 2}}, &Material::emission_texture);
  expect_uvs(scene, {{6, 5}, {7, 6}, {8, 7}}, &Material::normal_texture);
  gltf.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 7;
  EXPECT_TRUE(parse(gltf).meshes.at(0).more_uvs.at(6).empty()) << "there are none";
  gltf.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 8;
  const Scene beyond = parse(gltf);
  EXPECT_TRUE(beyond.materials[0].base_color_texture.empty());
  EXPECT_THAT(beyond.warnings, ElementsAre(HasSubstr("sets 0 to 7")));
}

TEST(GltfTexture, NormalPicturesComeWithTheirScaleAndTangents) {
  GltfBuilder gltf = textured();
  gltf.root["materials"][0]["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  auto& attributes = gltf.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = gltf.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  attributes["TANGENT"] = gltf.accessor(std::vector<float>{2, 0, 0, 1, 0, 1, 0, -1, -1, 0, 0, 1}, "VEC4");
  gltf.root["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};  // a quarter turn: x to y
  const auto tangents = [&] {
    const Scene scene = parse(gltf);
    EXPECT_THAT(scene.warnings, IsEmpty());
    EXPECT_EQ(scene.materials[0].normal_texture.picture, "/nowhere/wood.png");
    EXPECT_EQ(scene.materials[0].normal_scale, 0.5f);
    EXPECT_TRUE(scene.meshes[0].motion->has_tangents());
    std::vector<Vec4f> out(3);
    scene.meshes[0].motion->tangents(0, Side::after, out);
    return out;
  };
  const auto expect_near = [](const Vec4f& actual, const Vec4f& expected) {
    EXPECT_NEAR(actual.x, expected.x, 1e-6);
    EXPECT_NEAR(actual.y, expected.y, 1e-6);
    EXPECT_NEAR(actual.z, expected.z, 1e-6);
    EXPECT_EQ(actual.w, expected.w);
  };
  expect_near(tangents()[0], {0, 1, 0, 1});
  expect_near(tangents()[1], {-1, 0, 0, -1});
  gltf.root["nodes"][0]["scale"] = {-1, 1, 1};  // mirrored: what was to the left of a tangent is to its right
  expect_near(tangents()[0], {0, -1, 0, -1});
  expect_near(tangents()[1], {-1, 0, 0, 1});
}

TEST(GltfTexture, SamplersSayWhatLiesBeyondTheEdges) {
  GltfBuilder gltf = textured();
  using Wraps = std::array<TextureWrap, 2>;
  const auto nearest = [&] { return parse(gltf).materials[0].base_color_texture.nearest; };
  EXPECT_EQ(nearest(), std::nullopt);
  const auto wraps = [&] { return parse(gltf).materials[0].base_color_texture.wrap; };
  EXPECT_EQ(wraps(), (Wraps{TextureWrap::repeat, TextureWrap::repeat}));
  gltf.root["textures"][0]["sampler"] = 0;
  gltf.root["samplers"] = nlohmann::json::array({{{"wrapS", 33071}, {"wrapT", 33648}}});
  EXPECT_EQ(wraps(), (Wraps{TextureWrap::clamp, TextureWrap::mirror}));
  EXPECT_EQ(nearest(), std::nullopt);
  gltf.root["samplers"][0]["magFilter"] = 9728;
  EXPECT_EQ(nearest(), true);
  EXPECT_THAT(parse(gltf).warnings, testing::IsEmpty());
  gltf.root["samplers"][0]["magFilter"] = 9729;
  EXPECT_EQ(nearest(), false);
  gltf.root["samplers"][0] = nlohmann::json::object();
  EXPECT_EQ(wraps(), (Wraps{TextureWrap::repeat, TextureWrap::repeat}));
}

TEST(GltfTexture, SpecularGlossinessKeepsItsDiffusePart) {
  GltfBuilder gltf = textured();
  gltf.root["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
  nlohmann::json& material = gltf.root["materials"][0];
  material = {
      {"alphaMode", "BLEND"},
      {"extensions",
       {{"KHR_materials_pbrSpecularGlossiness",
         {{"diffuseFactor", {0.5, 0.25, 1, 0.75}},
          {"glossinessFactor", 0.25},
          {"diffuseTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {1, 2}}}}}}}}}}}}};
  Scene scene = parse(gltf);
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.base_color, (Vec3f{0.5f, 0.25f, 1}));
  EXPECT_EQ(m.alpha, 0.75f);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, 0.75f);
  EXPECT_EQ(m.base_color_texture.picture, "/nowhere/wood.png");
  EXPECT_THAT(scene.warnings, IsEmpty());
  expect_uvs(scene, {{1, 2}, {2, 2}, {1.5f, 4}});

  nlohmann::json& glossy = material["extensions"]["KHR_materials_pbrSpecularGlossiness"];
  glossy["specularGlossinessTexture"] = {{"index", 0}};
  scene = parse(gltf);
  EXPECT_EQ(scene.materials[0].roughness, 1);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("specularGlossinessTexture")));
  glossy["diffuseTexture"] = {{"index", 5}};
  EXPECT_THROW(parse(gltf), Error);
  glossy = {{"diffuseFactor", "red"}};
  EXPECT_THROW(parse(gltf), Error);
}

TEST(GltfTexture, UnlitSurfacesKeepTheirColour) {
  GltfBuilder gltf = textured();
  gltf.root["extensionsUsed"] = {"KHR_materials_unlit"};
  gltf.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 1, 1};
  gltf.root["materials"][0]["extensions"]["KHR_materials_unlit"] = nlohmann::json::object();
  const Scene scene = parse(gltf);
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_TRUE(scene.materials[0].unlit);
  EXPECT_EQ(scene.materials[0].base_color, (Vec3f{0.5f, 0.25f, 1}));
  EXPECT_EQ(scene.materials[0].emission, Vec3f{});
  EXPECT_EQ(scene.materials[0].base_color_texture.picture, "/nowhere/wood.png");
  EXPECT_EQ(scene.materials[0].metallic, 0);
}

}  // namespace
}  // namespace kairos
