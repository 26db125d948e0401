// Lights, backgrounds and views from the command line.
#include <cmath>

#include "cli.h"
#include "image/read_exr.h"

namespace kairos {
namespace {

class CliLight : public CliTest {
 protected:
  CliLight() {
    // Two squares that face the camera: one that `left` describes, and a white one.
    write("none.gltf", scene(R"({"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}})"));
    write("faint.gltf", scene(R"({"emissiveFactor": [0.01, 0, 0],
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}})"));
    write("unlit.gltf", scene(R"({"extensions": {"KHR_materials_unlit": {}},
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 1, 1]}})"));
  }

  static std::string scene(const std::string& left) {
    // Corners (-1, -1), (1, -1), (1, 1), (-1, 1) at z = 0, and the indices 0 1 2 0 2 3 as bytes.
    return R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_unlit"],
      "buffers": [{"byteLength": 54, "uri": "data:application/octet-stream;base64,)"
           "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAECAAID"
           R"("}],
      "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 6}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                     "min": [-1, -1, 0], "max": [1, 1, 0]},
                    {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]},
                 {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 1}]}],
      "materials": [)" +
           left + R"(, {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}}],
      "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}],
      "nodes": [{"mesh": 0, "translation": [-1.5, 0, 0]}, {"mesh": 1, "translation": [1.5, 0, 0]},
                {"camera": 0, "translation": [0, 0, 8]}],
      "scenes": [{"nodes": [0, 1, 2]}], "scene": 0})";
  }

  Image render(const std::string& arguments, const std::string& name = "out.exr") const {
    const CliResult result = run("render --quiet --size 33x11 --spp 256 -o " + name + " " + arguments);
    EXPECT_EQ(result.status, 0) << arguments << result.err;
    return read_image(path(name));
  }
  static float left(const Image& image, const char* channel) { return image.find(channel)->values[5 * 33 + 12]; }
  static float right(const Image& image, const char* channel) { return image.find(channel)->values[5 * 33 + 20]; }
};

TEST_F(CliLight, WhatOnlyGlowsLeavesTheStudioOn) {
  const float lit = right(render("none.gltf"), "R");
  EXPECT_NEAR(lit, 0.93, 0.03);
  for (const char* name : {"faint.gltf", "unlit.gltf"}) {
    const Image image = render(name);
    EXPECT_NEAR(right(image, "R"), lit, 0.02) << name;
    EXPECT_NEAR(left(image, "R"), std::string(name) == "faint.gltf" ? 0.01 : 0, 1e-6);
    EXPECT_NEAR(left(image, "B"), std::string(name) == "unlit.gltf" ? 1 : 0, 1e-6);
  }
  const Image dark = render("faint.gltf --lights none --background 0,0,0");
  EXPECT_LT(right(dark, "R"), 0.001f);
  EXPECT_NEAR(left(dark, "R"), 0.01, 1e-6) << "what emits, glows in any case";
  EXPECT_EQ(render("none.gltf --lights file").find("R")->values, render("none.gltf --lights none").find("R")->values);
  EXPECT_NE(run("render --size 9x9 --spp 4 -o a.png none.gltf").err.find("note: no lights in the scene"),
            std::string::npos);
}

TEST_F(CliLight, EnvironmentsLightAndAreSeen) {
  Image sky{2, 1, 0, 0, 2, 1, {}, {}};
  for (const char* channel : {"R", "G", "B"}) sky.channels.push_back({channel, Channel::Storage::colour, {0.5f, 0.5f}});
  write_image(sky, path("sky.exr"));
  const Image image = render("none.gltf --environment sky.exr --environment-strength 0.5");
  EXPECT_NEAR(right(image, "R"), 0.25, 0.005) << "white below an even sky";
  EXPECT_NEAR(image.find("R")->values[0], 0.25, 1e-6) << "the sky itself";
  const Image colour = render("none.gltf --environment sky.exr --background 0.125,0,2");
  EXPECT_NEAR(right(colour, "R"), 0.5, 0.01);
  EXPECT_EQ(colour.find("B")->values[0], 2);
}

TEST_F(CliLight, TransparentPicturesHaveAlpha) {
  const Image exr = render("none.gltf --background transparent");
  EXPECT_EQ(exr.find("A")->values[0], 0);
  EXPECT_EQ(exr.find("R")->values[0], 0);
  EXPECT_EQ(right(exr, "A"), 1);
  const Image png = render("none.gltf --background transparent", "out.png");
  ASSERT_NE(png.find("A"), nullptr);
  EXPECT_EQ(png.find("A")->values[0], 0);
  EXPECT_EQ(right(png, "A"), 1);
  EXPECT_EQ(render("none.gltf").find("A"), nullptr);
}

TEST_F(CliLight, ViewsAreForPngAndColoursThatSayWhatASurfaceIsStayExact) {
  write("bright.gltf", scene(R"({"emissiveFactor": [1, 1, 1]})"));
  EXPECT_NEAR(left(render("bright.gltf --lights none", "a.png"), "R"), 0.85, 0.005) << "filmic";
  EXPECT_EQ(left(render("bright.gltf --lights none --view standard", "a.png"), "R"), 1);
  EXPECT_EQ(left(render("bright.gltf --shading flat", "a.png"), "R"), 1);
  EXPECT_NEAR(left(render("bright.gltf --lights none --view standard --exposure -1", "a.png"), "R"), 0.5, 0.005);
  const std::string shot = "render none.gltf --quiet --size 9x9 ";
  for (const char* options :
       {"-o a.exr --view filmic", "-o a.exr --exposure 1", "-o a.png --view bright", "-o a.png --exposure 101",
        "-o a.png --background 1,2", "-o a.png --background 1,2,-3", "-o a.png --lights many",
        "-o a.png --environment-rotation 5", "-o a.png --environment-strength -1"}) {
    const CliResult result = run(shot + options);
    EXPECT_EQ(result.status, 2) << options;
    EXPECT_TRUE(result.one_line_error()) << result.err;
  }
  EXPECT_EQ(run(shot + "-o a.png --environment none.hdr").status, 1);
}

}  // namespace
}  // namespace kairos
