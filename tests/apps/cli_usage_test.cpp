// The command line's contract: exit status, errors of one line, every option.
#include <map>
#include <regex>
#include <set>

#include <kairos/image.h>

#include "cli.h"

namespace kairos {
namespace {

using CliUsage = CliTest;

/// Every pixel is exposed all the time.
void write_interval_map(const std::string& path, int width, int height) {
  Image map;
  map.width = map.frame_width = width;
  map.height = map.frame_height = height;
  const auto pixels = static_cast<size_t>(width * height);
  map.channels = {{"open", Channel::Storage::exact, std::vector<float>(pixels, 0)},
                  {"close", Channel::Storage::exact, std::vector<float>(pixels, 0.02f)}};
  write_image(map, path);
}

TEST_F(CliUsage, BadUsageIsStatusTwoAndOneLine) {
  const std::string render = "render scene.json -o a.exr ";
  for (const std::string& arguments : {std::string(),
                                       std::string("paint"),
                                       std::string("render"),
                                       std::string("render scene.json"),
                                       std::string("render -o a.exr"),
                                       std::string("query scene.json"),
                                       std::string("query --rays -"),
                                       std::string("info"),
                                       std::string("render scene.json -o a.jpg"),
                                       std::string("render scene.json -o a"),
                                       std::string("render missing.json -o a.tiff"),
                                       render + "--unknown",
                                       render + "--spp",
                                       render + "--spp 0",
                                       render + "--spp 010x",
                                       render + "--spp 0x10",
                                       render + "--spp -3",
                                       render + "--spp 1e3",
                                       render + "--spp 1.5",
                                       render + "--spp nan",
                                       render + "--spp 99999999",
                                       render + "--spp 99999999999999999999",
                                       render + "--spp ''",
                                       render + "--spp 4 --spp 5",
                                       render + "--tc-rays 0",
                                       render + "--shading-samples 0",
                                       render + "--seed -1",
                                       render + "--seed 18446744073709551616",
                                       render + "--threads -1",
                                       render + "--integrator bidirectional",
                                       render + "--sampler sobol",
                                       render + "--shading toon",
                                       render + "--max-depth 65",
                                       render + "--clamp -1",
                                       render + "--filter triangle",
                                       render + "--instruction-set avx",
                                       render + "--size 10",
                                       render + "--size 0x10",
                                       render + "--size 10x",
                                       render + "--size 10x20x30",
                                       render + "--size 70000x10",
                                       render + "--size -1x10",
                                       render + "--crop 0,1,0",
                                       render + "--crop 3,3,0,1",
                                       render + "--crop 0,33,0,20",
                                       render + "--crop -1,3,0,1",
                                       render + "--shutter 1x",
                                       render + "--shutter nan,1",
                                       render + "--shutter 1,0",
                                       render + "--shutter 0,inf",
                                       render + "--shutter 0;1x",
                                       render + "--frame x",
                                       render + "--frame nan",
                                       render + "--fps 0",
                                       render + "--fps -24",
                                       render + "--motion-tolerance 0",
                                       render + "--motion-tolerance nan",
                                       render + "--aov depth,color",
                                       render + "--aov depth,depth",
                                       render + "--aov ''",
                                       render + "--camera nobody"}) {
    const std::string shown = std::regex_replace(arguments, std::regex(";"), "\\;");
    const CliResult result = run(shown);
    EXPECT_EQ(result.status, 2) << arguments << "\n" << result.err;
    // What is only known once the scene is loaded comes after the log.
    const CliResult quiet = arguments.rfind(render, 0) == 0 ? run(shown + " --quiet") : result;
    EXPECT_TRUE(quiet.one_line_error()) << arguments << "\n" << quiet.err;
  }
  EXPECT_EQ(files(), 4u) << "nothing was written";
}

TEST_F(CliUsage, BadUsageNamesTheHelpThatHelps) {
  EXPECT_THAT(run("paint scene.json").err,
              testing::HasSubstr("'paint' is no subcommand; the subcommands are render, "));
  EXPECT_THAT(run("").err, testing::HasSubstr("a subcommand is required; the subcommands are render, "));
  EXPECT_THAT(run("expose").err, testing::HasSubstr("FILE is required (see kairos expose --help)"));
  EXPECT_THAT(run("--unknown").err, testing::HasSubstr("is required (see kairos --help)"));
}

TEST_F(CliUsage, WhatIsAskedForInVainIsTold) {
  const auto told = [&](const std::string& options) {
    return run("render scene.json -o a.exr --size 8x8 --spp 1 " + options).err;
  };
  EXPECT_THAT(told("--integrator qmc --shadows exact"), testing::HasSubstr("note: --shadows exact does nothing here"));
  EXPECT_THAT(told("--shading path --mirrors exact"), testing::HasSubstr("note: --mirrors exact does nothing here"));
  EXPECT_THAT(told("--shading flat --cells on"), testing::HasSubstr("note: --cells on does nothing here"));
  EXPECT_THAT(told("--shading whitted --shadows exact --mirrors exact --cells on --shutter 180deg"),
              testing::Not(testing::AnyOf(testing::HasSubstr("does nothing"), testing::HasSubstr("an angle"))));
  EXPECT_THAT(told("--shutter 180"), testing::HasSubstr("open for 180 frames; an angle is written 180deg"));
}

TEST_F(CliUsage, DecimalsAreDecimal) {
  const CliResult result = run("render scene.json -o a.exr --integrator qmc --spp 010 --stats-file s.json");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(read(path("s.json")).find("\"samples\": 10,"), std::string::npos) << read(path("s.json"));
}

TEST_F(CliUsage, HelpAndVersionSucceed) {
  for (const char* arguments : {"--help", "--version", "render --help", "query --help", "info --help"}) {
    const CliResult result = run(arguments);
    EXPECT_EQ(result.status, 0) << arguments;
    EXPECT_FALSE(result.out.empty()) << arguments;
    EXPECT_TRUE(result.err.empty()) << result.err;
  }
}

// A new option without an example here makes this fail.
TEST_F(CliUsage, EveryOptionThatHelpNamesWorks) {
  const std::map<std::string, std::string> examples = {{"--help", ""},
                                                       {"--output", "b.png"},
                                                       {"--half", ""},
                                                       {"--aov", "depth,normal,albedo,coverage,segments,mesh"},
                                                       {"--crop", "1,9,2,8"},
                                                       {"--view", "filmic"},
                                                       {"--exposure", "-1.5"},
                                                       {"--lights", "studio"},
                                                       {"--environment", "sky.exr"},
                                                       {"--environment-rotation", "90 --environment sky.exr"},
                                                       {"--environment-strength", "2 --environment sky.exr"},
                                                       {"--background", "transparent"},
                                                       {"--filter", "blackman-harris"},
                                                       {"--integrator", "qmc"},
                                                       {"--tc-rays", "3"},
                                                       {"--shading-samples", "2"},
                                                       {"--spp", "5"},
                                                       {"--sampler", "multi-jitter"},
                                                       {"--clusters", "on"},
                                                       {"--shadows", "exact"},
                                                       {"--mirrors", "exact"},
                                                       {"--cells", "on"},
                                                       {"--shading", "flat"},
                                                       {"--max-depth", "3"},
                                                       {"--clamp", "2"},
                                                       {"--seed", "7"},
                                                       {"--calibration", "default"},
                                                       {"--instruction-set", "scalar"},
                                                       {"--stats-file", "stats.json"},
                                                       {"--quiet", ""},
                                                       {"--animation", "0"},
                                                       {"--gltf-scene", "0"},
                                                       {"--strict", ""},
                                                       {"--root", "."},
                                                       {"--memory-budget", "500"},
                                                       {"--camera", "0"},
                                                       {"--instances", "always"},
                                                       {"--frame", "0"},
                                                       {"--frames", "0-1"},
                                                       {"--part", "1/2"},
                                                       {"--checkpoint", "60"},
                                                       {"--progress", "openjd"},
                                                       {"--fps", "24"},
                                                       {"--shutter", "-0.25,0.25"},
                                                       {"--rolling", "top:20ms"},
                                                       {"--curve", "triangle"},
                                                       {"--signed-curve", ""},
                                                       {"--anchor", "last"},
                                                       {"--sensor-lines", "20,1"},
                                                       {"--interval-map", "map.exr"},
                                                       {"--normalise", "energy"},
                                                       {"--size", "8x6"},
                                                       {"--motion-tolerance", "0.5"},
                                                       {"--threads", "1"},
                                                       {"--rays", "rays.txt"},
                                                       {"--all", ""},
                                                       {"--occluded", ""},
                                                       {"--window", "0.25,0.5"},
                                                       {"--max-dist", "3"},
                                                       {"--pixel", "3,4"},
                                                       {"--time", "t.ktime"},
                                                       {"--time-tolerance", "exact --time u.ktime"},
                                                       {"--time-planes", "objects --time v.ktime"},
                                                       {"--json", ""}};
  const std::set<std::string> of_rays = {"--rays", "--all", "--occluded", "--window", "--max-dist"};
  write("rays.txt", "0 0 0 0 0 -1\n");
  Image sky{2, 1, 0, 0, 2, 1, {}, {}};
  for (const char* name : {"R", "G", "B"}) sky.channels.push_back({name, Channel::Storage::colour, {1, 2}});
  write_image(sky, path("sky.exr"));
  const std::map<std::string, std::string> commands = {
      {"render", "scene.json -o a.exr --size 12x9 "}, {"query", "scene.json --rays - "}, {"info", "scene.json "}};
  for (const auto& [command, rest] : commands) {
    const std::string help = run(command + " --help").out;
    const std::regex option("--[a-z][a-z-]*");
    std::set<std::string> names;
    for (auto it = std::sregex_iterator(help.begin(), help.end(), option); it != std::sregex_iterator(); ++it)
      names.insert(it->str());
    EXPECT_GT(names.size(), 5u);
    for (const std::string& name : names) {
      ASSERT_TRUE(examples.contains(name)) << name;
      std::string arguments = rest;
      if (name == "--output") arguments = "scene.json --size 12x9 ";
      if (name == "--view" || name == "--exposure") arguments = "scene.json -o a.png --size 12x9 ";
      if (name == "--frames") arguments = "scene.json -o f%d.exr --size 12x9 ";
      if (name == "--rays" || name == "--pixel") arguments = "scene.json ";
      if (name == "--interval-map")
        write_interval_map(path("map.exr"), command == "query" ? 32 : 12, command == "query" ? 20 : 9);
      if (command == "query" && !of_rays.contains(name) && name != "--pixel") arguments = "scene.json --pixel 3,4 ";
      if (name == "--size")
        arguments = "scene.json " + std::string(command == "render"  ? "-o a.exr "
                                                : command == "query" ? "--rays - "
                                                                     : "");
      const CliResult result = run(command + " " + arguments + name + " " + examples.at(name) + " < rays.txt");
      EXPECT_EQ(result.status, 0) << command << " " << name << "\n" << result.err;
    }
  }
  EXPECT_TRUE(exists("b.png"));
  EXPECT_TRUE(exists("stats.json"));
}

TEST_F(CliUsage, BadInputIsStatusOneAndOneLine) {
  write("broken.json", "{\"kairos\": 1, \"meshes\": [}");
  write("broken.obj", "v 1 2 3\nf 1 2 nine\n");
  std::filesystem::create_directory(folder_ / "folder");
  std::filesystem::create_directory(folder_ / "folder.exr");
  for (const char* arguments :
       {"render missing.json -o a.exr", "render broken.json -o a.exr", "render broken.obj -o a.exr",
        "render folder -o a.exr", "render scene.json -o nowhere/a.exr", "render scene.json -o folder.exr",
        "render scene.json -o a.exr --stats-file nowhere/s.json", "render scene.json -o a.exr --stats-file /dev/null",
        "info missing.obj", "query scene.json --rays missing.txt", "render 'a\nb.json' -o a.exr"}) {
    const CliResult result = run(arguments);
    EXPECT_EQ(result.status, 1) << arguments << "\n" << result.err;
    EXPECT_TRUE(result.one_line_error()) << arguments << "\n" << result.err;
  }
  EXPECT_FALSE(exists("a.exr"));
}

}  // namespace
}  // namespace kairos
