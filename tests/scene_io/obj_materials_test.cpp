// OBJ files with material libraries: which triangles have which material, and what it looks like.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_matchers.h"
#include "scene/scene.h"
#include "scene_io/obj/materials.h"
#include "scene_io/split_by_material.h"
#include "seed.h"
#include "temp_folder.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class ObjMaterials : public testing::Test {
 protected:
  /// The material "m" of a library.
  Material material(const std::string& statements, bool strict = true) {
    FileWarnings warnings(strict);
    std::map<std::string, Material> materials;
    parse_mtl("newmtl m\n" + statements, folder_.path("lib.mtl"), warnings, materials);
    warnings_ = warnings.lines();
    return materials.at("m");
  }
  std::shared_ptr<const Scene> load(const std::vector<std::string>& texts, bool strict = false) const {
    std::vector<std::string> paths;
    for (const std::string& text : texts)
      paths.push_back(folder_.write("key" + std::to_string(paths.size()) + ".obj", text));
    LoadOptions options;
    options.strict = strict;
    return load_scene(paths, options);
  }
  static std::vector<Vec3d> positions(const SceneMesh& mesh, double time = 0) {
    std::vector<Vec3d> out(mesh.motion->vertex_count());
    mesh.motion->positions(time, Side::after, out);
    return out;
  }

  TempFolder folder_;
  std::vector<std::string> warnings_;
};

TEST_F(ObjMaterials, ColoursAndModels) {
  const Material plain = material("Ka 1 1 1\nKd .25 .5 1\nKe 2 3 4\nKs 0 0 0\nNs 900\nd 1\nillum 2\n");
  EXPECT_EQ(plain.base_color, (Vec3f{0.25, 0.5, 1}));
  EXPECT_EQ(plain.emission, (Vec3f{2, 3, 4}));
  EXPECT_EQ(plain.roughness, 1) << "without Ks there is no highlight";
  EXPECT_EQ(plain.alpha_mode, Material::AlphaMode::opaque);
  EXPECT_EQ(material("Kd .5\n").base_color, (Vec3f{0.5, 0.5, 0.5})) << "one number stands for three";
  EXPECT_FLOAT_EQ(material("Kd 1 1 1\nKs .5 .5 .5\nNs 30\n").roughness, 0.5f);  // (2 / 32)^(1/4)
  EXPECT_EQ(material("Kd 1 1 1\nKs .5 .5 .5\nNs 30\nillum 1\n").roughness, 1);
  const Material mirror = material("Kd 0 0 0\nKs .9 .8 .7\nNs 1e9\nillum 5\n");
  EXPECT_EQ(mirror.metallic, 1);
  EXPECT_EQ(mirror.base_color, (Vec3f{0.9f, 0.8f, 0.7f}));
  EXPECT_LT(mirror.roughness, 0.01);
  const Material glass = material("Kd 0 0 0\nTf .5 1 1\nNi 1.25\nd .1\nillum 7\n");
  EXPECT_EQ(glass.transmission, 1);
  EXPECT_EQ(glass.ior, 1.25f);
  EXPECT_EQ(glass.base_color, (Vec3f{0.5, 1, 1}));
  EXPECT_EQ(glass.alpha, 1);
  const Material physical = material("Kd 1 0 0\nPr .25\nPm .75\n");
  EXPECT_EQ(physical.roughness, 0.25f);
  EXPECT_EQ(physical.metallic, 0.75f);
  for (const char* half : {"d .25\n", "Tr .75\n"}) {
    const Material seen_through = material(half);
    EXPECT_EQ(seen_through.alpha, 0.25f);
    EXPECT_EQ(seen_through.alpha_mode, Material::AlphaMode::blend);
  }
}

TEST_F(ObjMaterials, Pictures) {
  folder_.write("a b#1.png", "");
  folder_.write("tex/c.png", "");
  const Material m = material("Kd .5 .5 .5\nmap_Kd -clamp on a b#1.png\nmap_d tex\\c.png\nmap_Ke tex/c.png\n");
  EXPECT_EQ(m.base_color_texture.picture, folder_.path("a b#1.png"));
  EXPECT_EQ(m.base_color, (Vec3f{0.5, 0.5, 0.5}));
  EXPECT_EQ(m.base_color_texture.wrap[1], TextureWrap::clamp);
  EXPECT_EQ(m.alpha_texture.picture, folder_.path("tex/c.png"));
  EXPECT_EQ(m.alpha_mode, Material::AlphaMode::mask);
  EXPECT_EQ(m.emission, (Vec3f{1, 1, 1}));
  EXPECT_EQ(material("Kd 0 0 0\nmap_Kd tex/c.png\n").base_color, (Vec3f{1, 1, 1})) << "black would hide the picture";
  const Material cut = material("map_Kd tex/c.png\nmap_d tex/c.png\n");
  EXPECT_EQ(cut.alpha_texture.picture, "") << "the colour's picture has an alpha of its own";
  EXPECT_EQ(cut.alpha_mode, Material::AlphaMode::mask);
  EXPECT_EQ(material("Pm 1\nmap_Pr tex/c.png\n").metallic_roughness_texture.picture, folder_.path("tex/c.png"));
  const Material placed = material("map_Kd -s 2 4 1 -o .5 -1 0 tex/c.png\nnorm tex/c.png\nPc .5\nPcr .25\n");
  // A vertex's texture coordinate counts from the lower edge in the file, from the upper here.
  EXPECT_EQ(placed.base_color_texture.place({0.25f, 1 - 0.75f}), (Vec2f{2 * 0.25f + 0.5f, 1 - (4 * 0.75f - 1)}));
  EXPECT_EQ(placed.normal_texture.picture, folder_.path("tex/c.png"));
  EXPECT_EQ(placed.clearcoat, 0.5f);
  EXPECT_EQ(placed.clearcoat_roughness, 0.25f);
  material("map_Kd gone.png\nmap_Kd ../x.png\nmap_Kd -bm 2 tex/c.png\nbump tex/c.png\nPs 1\n", false);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("lib.mtl:2: 'gone.png' is not there"), HasSubstr("'../x.png' leaves"),
                                     HasSubstr("lib.mtl:4: the option '-bm'"), HasSubstr("statements 'bump'"),
                                     HasSubstr("statements 'Ps'")));
  expect_error([&] { material("Kd 1 x 1\n"); }, {"lib.mtl:2", "'x' is not a finite number"});
  expect_error([&] { material("Kd 1 nan 1\n"); }, {"lib.mtl:2", "'nan'"});
}

TEST_F(ObjMaterials, OneMeshForEachMaterial) {
  folder_.write("two words.mtl", "newmtl red\nKd 1 0 0\nnewmtl a #2 b\nKd 0 0 1\n");
  const char* square = "mtllib two words.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nv 6 5 5\nv 5 6 5\n";
  const std::string faces = "f 1 2 3\nusemtl red\nf 1 2 3 4\nusemtl a #2 b\nf 5 6 7\nusemtl red\nf 4 3 1\n";
  const std::string moved = "v 0 0 8\nv 1 0 8\nv 1 1 8\nv 0 1 8\nv 5 5 9\nv 6 5 9\nv 5 6 9\n";
  const auto scene = load({square + faces, moved + faces}, true);  // the first key's library counts for both
  ASSERT_THAT(scene->meshes, SizeIs(3));
  const auto colour = [&](size_t mesh) { return scene->materials.at(scene->meshes[mesh].material).base_color; };
  EXPECT_EQ(colour(0), Material{}.base_color);
  EXPECT_EQ(colour(1), (Vec3f{1, 0, 0}));
  EXPECT_EQ(colour(2), (Vec3f{0, 0, 1}));
  EXPECT_EQ(scene->meshes[1].name, "key0.red");
  // Triangles keep their numbers in the file.
  EXPECT_THAT(scene->meshes[0].prim_ids, ElementsAre(0));
  EXPECT_THAT(scene->meshes[1].prim_ids, ElementsAre(1, 2, 4));
  EXPECT_THAT(scene->meshes[2].prim_ids, ElementsAre(3));
  EXPECT_THAT(positions(scene->meshes[2], 1), ElementsAre(Vec3d{5, 5, 9}, Vec3d{6, 5, 9}, Vec3d{5, 6, 9}));
  EXPECT_EQ(positions(scene->meshes[1], 0.5).at(scene->meshes[1].triangles.at(2)[0]), (Vec3d{0, 1, 4}));
}

TEST_F(ObjMaterials, ColoursOfVerticesAreSeenAsTheyAre) {
  const std::string vertices = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1 ", face = "\nf 1 2 3\n";
  const auto scene = load({vertices + face});
  EXPECT_EQ(scene->materials.at(0).base_color, (Vec3f{1, 1, 1}));
  EXPECT_EQ(scene->materials[0].alpha_mode, Material::AlphaMode::opaque);
  EXPECT_EQ(scene->meshes.at(0).colors.at(1), (Vec4f{0, 1, 0, 1}));
  EXPECT_EQ(load({vertices + ".5" + face})->materials.at(0).alpha_mode, Material::AlphaMode::blend);
  // Each material's mesh has its vertices' colours.
  const auto split = load({vertices + face + "usemtl b\nf 3 2 1\n"});
  ASSERT_THAT(split->meshes, SizeIs(2));
  EXPECT_THAT(split->meshes[1].colors, ElementsAre(Vec4f{0, 0, 1, 1}, Vec4f{0, 1, 0, 1}, Vec4f{1, 0, 0, 1}));
}

TEST_F(ObjMaterials, WhatLibrariesLackIsAWarning) {
  const char* text = "mtllib gone.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  EXPECT_THAT(load({text})->warnings, ElementsAre(HasSubstr("key0.obj: 'gone.mtl' is not there"),
                                                  HasSubstr("no material 'x' is defined: it is grey")));
  expect_error([&] { load({text}, true); }, {"key0.obj", "gone.mtl"});
}

TEST_F(ObjMaterials, TheNativeFilesMaterialCountsForAll) {
  folder_.write("lib.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  folder_.write("two.obj", "mtllib lib.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 3 2 1\n");
  const std::string path = folder_.write("scene.json", R"({"kairos": 1, "materials": {"green": {"base_color": [0,1,0]}},
      "meshes": [{"keys": ["two.obj"], "material": "green"}, {"keys": ["two.obj"], "name": "own"}]})");
  const auto scene = load_scene({path});
  ASSERT_THAT(scene->meshes, SizeIs(3));
  EXPECT_EQ(scene->materials.at(scene->meshes[0].material).name, "green");
  EXPECT_THAT(scene->meshes[0].triangles, SizeIs(2));
  EXPECT_EQ(scene->meshes[2].name, "own.blue");
  EXPECT_EQ(scene->materials.at(scene->meshes[2].material).base_color, (Vec3f{0, 0, 1}));
}

/// Splitting takes nothing away: the triangles of all parts together, put in order of their numbers, are the whole's.
TEST_F(ObjMaterials, PartsAreTheWhole) {
  std::mt19937 random(test::seed());
  for (int round = 0; round < 50; ++round) {
    MeshData whole;
    const uint32_t vertices = 3 + random() % 20, triangles = 1 + random() % 40;
    whole.positions.resize(2);
    for (uint32_t v = 0; v < vertices; ++v) {
      whole.positions[0].push_back({static_cast<float>(v), 0, 0});
      whole.positions[1].push_back({static_cast<float>(v), 1, 0});
      whole.uvs.push_back({0, static_cast<float>(v)});
    }
    for (uint32_t t = 0; t < triangles; ++t) {
      whole.triangles.push_back({static_cast<uint32_t>(random() % vertices), static_cast<uint32_t>(random() % vertices),
                                 static_cast<uint32_t>(random() % vertices)});
      whole.triangle_materials.push_back(random() % 5);
    }
    std::vector<Triangle> joined(triangles);
    std::vector<uint32_t> materials(triangles, 99);
    for (const MaterialPart& part : split_by_material(whole))
      for (size_t t = 0; t < part.data.triangles.size(); ++t) {
        const uint32_t number = part.data.prim_ids.empty() ? static_cast<uint32_t>(t) : part.data.prim_ids[t];
        materials.at(number) = part.material;
        for (size_t i = 0; i < 3; ++i) {
          const uint32_t v = part.data.triangles[t][i];
          ASSERT_EQ(part.data.positions[0].at(v).x, part.data.positions[1].at(v).x);
          ASSERT_EQ(part.data.positions[0].at(v).x, part.data.uvs.at(v).y);
          joined[number][i] = static_cast<uint32_t>(part.data.positions[0][v].x);
        }
      }
    EXPECT_EQ(joined, whole.triangles);
    EXPECT_EQ(materials, whole.triangle_materials);
  }
}

}  // namespace
}  // namespace kairos
