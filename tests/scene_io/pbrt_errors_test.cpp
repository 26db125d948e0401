// What a scene file may not say, and what is only reported.
#include "pbrt_fixture.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class PbrtErrors : public PbrtTest {};

TEST_F(PbrtErrors, NameFileAndLine) {
  refuse("# one\n\nTranslate 1 x 2", {"scene.pbrt:3: 'x' stands where a number should"});
  refuse("Translate 1 2", {"scene.pbrt:1", "ends where a number is missing"});
  refuse("\r\n\r\nScale 1 inf 1", {"scene.pbrt:3", "not a finite number"});
  refuse("\r\rScale nan 1 1", {"scene.pbrt:3", "not a finite number"});
  refuse("\n[", {"scene.pbrt:2", "where a statement should"});
  refuse("\nShape sphere", {"scene.pbrt:2", "a string in quotes"});
  refuse("\nShape \"sphere\n\"", {"scene.pbrt:2", "does not end in its line"});
  refuse("Shape \"sphere\" \"radius\" 1", {"scene.pbrt:1", "'radius' stands where a parameter's"});
  refuse("Shape \"sphere\"\n\"float radius\" [1 2", {"does not end", "begins in line 2"});
  refuse("Shape \"sphere\"\n\n\"float radius\" Shape", {"scene.pbrt:3", "a value of 'radius'"});
  refuse("Shape \"sphere\" \"float radius\" [1 2]", {"one finite number"});
  refuse("Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 2]", {"']' is missing"});
  refuse("Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 0]", {"are all 0"});
  const std::string projects = "Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]\n";
  refuse(projects + "Camera \"perspective\"", {"scene.pbrt:2", "projects"});
  refuse(projects + "ObjectBegin \"a\" ObjectEnd ObjectInstance \"a\"", {"scene.pbrt:2", "projects"});
  refuse("ActiveTransform EndTime\n" + projects + kTriangle, {"scene.pbrt:3", "projects"});
  refuse("Transform [1 0 0 -1 0 1 0 0 0 0 1 0 0 0 0 1]\n" + std::string(kTriangle), {"scene.pbrt:2", "infinity"});
  refuse("Scale 1e200 1 1 Scale 1e200 1 1", {"not finite after this"});
  refuse("Rotate 10 0 0 0", {"axis"});
  refuse("LookAt 0 0 0 0 0 0 0 1 0", {"no direction"});
  refuse("LookAt 0 0 0 0 1 0 0 2 0", {"no direction"});
  refuse("CoordSysTransform \"nowhere\"", {"no coordinate system 'nowhere'"});
  refuse("ActiveTransform Sometimes", {"StartTime, EndTime or All"});
  refuse("TransformTimes 1 0", {"TransformTimes"});
}

TEST_F(PbrtErrors, BlocksMustMatch) {
  refuse("\nAttributeEnd", {"scene.pbrt:2", "AttributeEnd without"});
  refuse("TransformBegin\nAttributeEnd", {"scene.pbrt:2", "AttributeEnd without"});
  refuse("ObjectEnd", {"ObjectEnd without"});
  refuse("ObjectBegin \"a\" ObjectBegin \"b\"", {"inside of ObjectBegin"});
  refuse("ObjectBegin \"a\" ObjectInstance \"a\"", {"instance of itself"});
  EXPECT_THAT(load("\nAttributeBegin").warnings,
              ElementsAre(HasSubstr("scene.pbrt:2: AttributeBegin without its end")));
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "AttributeBegin\n";
  refuse(deep, {"scene.pbrt:4097", "deep"});
}

/// pbrt-v3 keeps a stack of transforms and one of attributes; any end takes the top.
TEST_F(PbrtErrors, BlocksMayCrossAsInV3) {
  const std::string crossed = "AttributeBegin\nTranslate 1 0 0\nObjectBegin \"o\"\nTranslate 2 0 0\n" +
                              std::string(kTriangle) + "AttributeEnd\n" + kTriangle +
                              "ObjectEnd\nObjectInstance \"o\"\n" + kTriangle;
  const Scene scene = load_world(crossed);
  ASSERT_THAT(scene.meshes, SizeIs(3));
  // What stands before ObjectEnd is part of the object, without the translation that AttributeEnd took back.
  EXPECT_EQ(positions(scene.meshes[0])[0], (Vec3d{4, 2, 3}));
  EXPECT_EQ(positions(scene.meshes[1])[0], (Vec3d{2, 2, 3}));
  EXPECT_EQ(positions(scene.meshes[2])[0], (Vec3d{1, 2, 3}));
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("AttributeEnd closes the ObjectBegin of line 6, as in pbrt-v3"),
                                          HasSubstr("ObjectEnd closes the AttributeBegin of line 4, as in pbrt-v3")));
  expect_error([&] { load_world(crossed, true); }, {"AttributeEnd closes"});
  const Scene transforms = load_world(
      "AttributeBegin\nReverseOrientation\nTranslate 1 0 0\nTransformBegin\nTranslate "
      "2 0 0\nAttributeEnd\n" +
      std::string(kTriangle) + "TransformEnd\n" + kTriangle);
  EXPECT_EQ(positions(transforms.meshes[0])[0], (Vec3d{2, 2, 3}));
  EXPECT_GT(geometric_normal(transforms.meshes[0]).z, 0) << "attributes end with AttributeEnd";
  EXPECT_EQ(positions(transforms.meshes[1])[0], (Vec3d{1, 2, 3}));
}

TEST_F(PbrtErrors, UnknownStatementsAreReportedAndPassedOver) {
  const std::string text =
      "Frobnicate \"a\" [1 2 \"b\"] \"bool c\" true 7\nAttributeBegin AttributeEnd\nMediumInterface \"\" \"fog\"";
  EXPECT_THAT(load(text).warnings,
              ElementsAre(HasSubstr("scene.pbrt:1: the statement 'Frobnicate' is not known: left out"),
                          HasSubstr("media are left out")));
  refuse(text, {"scene.pbrt:1", "Frobnicate"}, true);
  EXPECT_THAT(
      load("Integrator \"path\" \"integer maxdepth\" 5 Sampler \"halton\" Option \"bool a\" true ColorSpace \"srgb\"\n"
           "PixelFilter \"box\" Accelerator \"bvh\" WorldBegin")
          .warnings,
      IsEmpty());
}

TEST_F(PbrtErrors, FilesThatAreNotThere) {
  const std::string text =
      "Include \"no.pbrt\"\nShape \"plymesh\" \"string filename\" \"no.ply\"\nObjectInstance \"no\"";
  EXPECT_THAT(load(text).warnings, ElementsAre(HasSubstr("scene.pbrt:1: the file 'no.pbrt' is not there"),
                                               HasSubstr("scene.pbrt:2: the file 'no.ply' is not there"),
                                               HasSubstr("scene.pbrt:3: no object 'no'")));
  refuse(text, {"scene.pbrt:1", "no.pbrt"}, true);
  refuse("Include \"../scene.pbrt\"", {"scene.pbrt:1", "../scene.pbrt"});
  refuse("\nInclude \"/etc/passwd\"", {"scene.pbrt:2", "/etc/passwd"});
  expect_error([&] { load_scene({folder_.path("none.pbrt")}); }, {"none.pbrt"}, ErrorCode::io);
}

TEST_F(PbrtErrors, IncludesShareAttributesAndImportsDoNot) {
  folder_.write("sub/move.pbrt", "Translate 5 0 0\nInclude \"sub/more.pbrt\"");
  folder_.write("sub/more.pbrt", "Translate 0 5 0\n");
  EXPECT_EQ(positions(load_world("Include \"sub/move.pbrt\"\n" + std::string(kTriangle)).meshes[0])[0],
            (Vec3d{6, 7, 3}));
  EXPECT_EQ(positions(load_world("Import \"sub/move.pbrt\"\n" + std::string(kTriangle)).meshes[0])[0],
            (Vec3d{1, 2, 3}));
  folder_.write("bad.pbrt", "\n\nTranslate");
  refuse("Include \"bad.pbrt\"", {"bad.pbrt:3", "number is missing"});
  folder_.write("round.pbrt", "Include \"round.pbrt\"");
  refuse("Include \"round.pbrt\"", {"round.pbrt:1", "does one include itself"});
}

TEST_F(PbrtErrors, ExpansionIsLimited) {
  std::string text = "ObjectBegin \"0\" " + std::string(kTriangle) + "ObjectEnd\n";
  for (int i = 1; i < 40; ++i)  // each holds the one before twice
    text += "ObjectBegin \"" + std::to_string(i) + "\" ObjectInstance \"" + std::to_string(i - 1) +
            "\" ObjectInstance \"" + std::to_string(i - 1) + "\" ObjectEnd\n";
  LoadContext context;
  expect_error([&] { parse_pbrt(text, folder_.path("s.pbrt"), context, 1 << 16); }, {"s.pbrt:", "too many triangles"});
}

TEST_F(PbrtErrors, WhatFollowsTheWorldIsLeftOut) {
  const Scene scene = load("WorldBegin " + std::string(kTriangle) + "WorldEnd\nShape \"sphere\"");
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("scene.pbrt:3: what follows the first WorldEnd")));
}

TEST_F(PbrtErrors, EmptyFilesAreEmptyScenes) {
  const Scene scene = load("\xef\xbb\xbf# nothing");
  EXPECT_THAT(scene.meshes, IsEmpty());
  EXPECT_FALSE(scene.materials.empty());
}

}  // namespace
}  // namespace kairos
