// Hard days: logs that nobody takes, files that may not grow, names that a terminal would obey, two of us at once.
#include <thread>

#include <sys/stat.h>

#include "cli.h"

namespace kairos {
namespace {

using CliHostile = CliTest;

TEST_F(CliHostile, ALogThatCannotBeWrittenCostsNoPicture) {
  const std::string render = "render scene.json -o a.exr --size 8x8 --spp 4 ";
  for (const std::string log : {"2>/dev/full", "2>&-"}) {
    EXPECT_EQ(run(render + log).status, 0) << log;
    EXPECT_TRUE(exists("a.exr"));
    std::filesystem::remove(path("a.exr"));
    EXPECT_EQ(run("info nope.obj " + log).status, 1) << log;
    EXPECT_EQ(run("render --bad " + log).status, 2) << log;
    EXPECT_EQ(run("calibrate scene.json -o c.json --size 8x8 " + log).status, 0) << log;
  }
}

TEST_F(CliHostile, AFileThatMayNotGrowIsAnError) {
  const size_t before = files();
  const CliResult result = run("render scene.json -o a.exr --size 256x256 --spp 1 --quiet", "ulimit -f 8; ");
  EXPECT_EQ(result.status, 1);
  EXPECT_TRUE(result.one_line_error()) << result.err;
  EXPECT_EQ(files(), before) << "nothing is left behind";
}

TEST_F(CliHostile, WhatNamesHoldReachesNoTerminal) {
  const std::string escape = "\\u001b[31m\\u009b31m\\nname";
  write("evil.gltf", R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0, "name": ")" + escape + R"("}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
      "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
      "textures": [{"source": 0}], "images": [{"uri": "%1b%5b31m%0d%0aforged.png"}],
      "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}]})");
  for (const char* arguments : {"info evil.gltf", "render evil.gltf -o a.png --size 4x4 --spp 1"}) {
    const CliResult result = run(arguments);
    for (const std::string& text : {result.out, result.err}) {
      EXPECT_EQ(text.find('\x1b'), text.npos) << arguments;
      EXPECT_EQ(text.find("\xc2\x9b"), text.npos) << arguments;
      EXPECT_EQ(text.find("\nforged"), text.npos) << arguments;
    }
  }
  EXPECT_NE(run("info evil.gltf").out.find("name"), std::string::npos);
}

TEST_F(CliHostile, TheRootAndTheBudgetAreChosen) {
  std::filesystem::create_directory(path("inside"));
  write("inside/a.json", R"({"kairos": 1, "include": ["../square.obj"]})");
  const CliResult refused = run("info inside/a.json");
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("--root"), std::string::npos) << refused.err;
  EXPECT_EQ(run("info inside/a.json --root .").status, 0);
  EXPECT_EQ(run("info scene.json --root inside").status, 1);

  write("fat.gltf", R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "accessors": [{"componentType": 5126, "count": 300000, "type": "VEC3"}]})");
  const CliResult fat = run("info fat.gltf --memory-budget 1");
  EXPECT_EQ(fat.status, 1);
  EXPECT_NE(fat.err.find("--memory-budget"), std::string::npos) << fat.err;
  EXPECT_EQ(run("info fat.gltf --memory-budget 100").status, 0);
  EXPECT_EQ(run("info fat.gltf --memory-budget 0").status, 2);
}

TEST_F(CliHostile, TwoStudiesInOneFolderDoNotMix) {
  const std::string study =
      "study square.obj -o st --size 16x16 --seeds 2 --methods random --budgets 4,8 --reference-spp 16 --keys 0 "
      "--quiet";
  std::filesystem::create_directory(path("st"));
  std::string lock = "flock -n -x st sleep 3 & sleep 0.5; ";
  const CliResult second = run(study, lock);
  EXPECT_EQ(second.status, 1);
  EXPECT_NE(second.err.find("in use"), std::string::npos) << second.err;
  EXPECT_EQ(run(study, "flock -x st true; ").status, 0) << "when the other has ended";
}

TEST_F(CliHostile, RaysFromFarAwayAndDistancesBeyondFloats) {
  write("rays.txt", "0 0 1e15 0 0 -1\n0 0 10 0 0 -1e-38\n");
  for (const char* set : {"scalar", "sse4"}) {
    const CliResult result = run(std::string("query square.obj --rays rays.txt --instruction-set ") + set);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("\"dist_begin\": 1000000000000000,"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("\"dist_begin\": null, \"dist_end\": null,"), std::string::npos) << result.out;
  }
}

}  // namespace
}  // namespace kairos
