// kairos query and kairos info.
#include <nlohmann/json.hpp>

#include "cli.h"

namespace kairos {
namespace {

using nlohmann::json;

class CliQuery : public CliTest {
 protected:
  std::vector<json> query(const std::string& rays, const std::string& options = "") const {
    write("rays.txt", rays);
    const CliResult result = run("query scene.json --rays rays.txt " + options);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return lines(result.out);
  }
  static std::vector<json> lines(const std::string& text) {
    std::vector<json> answers;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) answers.push_back(json::parse(line));
    return answers;
  }
};

TEST_F(CliQuery, SaysWhatIsSeenAndWhen) {
  // The bar is 0.2 wide, 2 away, and moves by 1.8: it covers the middle from 0.8 / 1.8 on, for 0.2 / 1.8.
  const auto answers = query("0 0.5 0 0 0 -2\n");
  ASSERT_EQ(answers.size(), 1u);
  const json& segments = answers[0].at("segments");
  ASSERT_EQ(segments.size(), 4u) << segments << ": the ray passes from one of the bar's triangles to the other";
  const char* const meshes[] = {"square \"x\"", "bar", "bar", "square \"x\""};
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(segments[i].at("mesh"), meshes[i]);
  EXPECT_EQ(segments[0].at("begin"), 0);
  EXPECT_NEAR(segments[1].at("begin").get<double>(), 0.8 / 1.8, 1e-6);
  EXPECT_NEAR(segments[2].at("end").get<double>(), 1 / 1.8, 1e-6);
  EXPECT_EQ(segments[1].at("end"), segments[2].at("begin"));
  EXPECT_EQ(segments[3].at("end"), 1);
  EXPECT_NEAR(segments[1].at("dist_begin").get<double>(), 1, 1e-6);
  EXPECT_NEAR(segments[0].at("dist_end").get<double>(), 1.5, 1e-6);
  for (const json& segment : segments) {
    EXPECT_TRUE(segment.at("front").get<bool>());
    EXPECT_LT(segment.at("prim").get<int>(), 2);
    EXPECT_EQ(segment.size(), 7u);
  }
}

TEST_F(CliQuery, AllNamesHiddenTrianglesToo) {
  const auto answers = query("0 0.5 0 0 0 -2\n", "--all");
  ASSERT_EQ(answers.size(), 1u);
  bool whole = false;
  for (const json& segment : answers[0].at("segments"))
    whole = whole || (segment.at("mesh") == "square \"x\"" && segment.at("begin") == 0 && segment.at("end") == 1);
  EXPECT_TRUE(whole) << answers[0];
}

TEST_F(CliQuery, LimitsCutWhatIsSeen) {
  const auto answers = query("0 0.5 0 0 0 -2\n", "--window 0.5,0.75");
  const json& segments = answers[0].at("segments");
  ASSERT_EQ(segments.size(), 2u) << segments;
  EXPECT_EQ(segments[0].at("mesh"), "bar");
  EXPECT_EQ(segments[0].at("begin"), 0.5);
  EXPECT_EQ(segments[1].at("mesh"), "square \"x\"");
  EXPECT_EQ(segments[1].at("end"), 0.75);
  const auto near = query("0 0.5 0 0 0 -2\n", "--max-dist 1.25");
  ASSERT_FALSE(near[0].at("segments").empty());
  for (const json& segment : near[0].at("segments")) EXPECT_EQ(segment.at("mesh"), "bar") << "the square is 1.5 away";
}

TEST_F(CliQuery, OccludedSaysOnlyWhenAnythingIsMet) {
  const auto answers = query("0 0.5 0 0 0 -2\n0 0.5 0 0 0 2\n", "--occluded --max-dist 1.25");
  ASSERT_EQ(answers.size(), 2u);
  ASSERT_EQ(answers[0].at("occluded").size(), 1u) << answers[0];
  EXPECT_NEAR(answers[0].at("occluded")[0].at("begin").get<double>(), 0.8 / 1.8, 1e-6);
  EXPECT_NEAR(answers[0].at("occluded")[0].at("end").get<double>(), 1 / 1.8, 1e-6);
  EXPECT_TRUE(answers[1].at("occluded").empty());
  EXPECT_EQ(query("0 0.5 0 0 0 -2\n", "--occluded")[0].dump(), R"({"occluded":[{"begin":0,"end":1}]})");
}

TEST_F(CliQuery, LimitsThatMakeNoSenseAreRefused) {
  write("rays.txt", "0 0 0 0 0 -1\n");
  for (const char* options : {"--window 0.5,0.5", "--window 0.5", "--window -1,1", "--window 0,2", "--window 0,nan",
                              "--max-dist 0", "--max-dist -1", "--max-dist x", "--occluded --all"}) {
    const CliResult result = run("query scene.json --rays rays.txt " + std::string(options));
    EXPECT_EQ(result.status, 2) << options;
    EXPECT_EQ(result.out, "") << options;
  }
}

TEST_F(CliQuery, OneLineOutPerRay) {
  std::string rays = "# comment\n\n";
  for (int i = 0; i < 10000; ++i) rays += i % 3 == 0 ? "0 0 0 0 0 1\r\n" : " 0\t0 0  0 0 -1e0 \n";
  rays.pop_back();  // no newline at the end
  const auto answers = query(rays);
  ASSERT_EQ(answers.size(), 10000u);
  for (size_t i = 0; i < answers.size(); ++i) EXPECT_EQ(answers[i].at("segments").empty(), i % 3 == 0) << i;
}

TEST_F(CliQuery, ReadsStandardInput) {
  write("rays.txt", "0 0 0 0 0 -1\n");
  const CliResult from_file = run("query scene.json --rays rays.txt");
  const CliResult from_input = run("query scene.json --rays - < rays.txt");
  EXPECT_EQ(from_input.status, 0);
  EXPECT_EQ(from_input.out, from_file.out);
}

TEST_F(CliQuery, TheShutterChoosesTheStretchOfTime) {
  const auto half = query("0 0.5 0 0 0 -2\n", "--frame 0 --fps 1 --shutter 0.5,1");
  ASSERT_EQ(half[0].at("segments").size(), 2u) << half[0];
  EXPECT_EQ(half[0].at("segments")[0].at("mesh"), "bar");
  EXPECT_NEAR(half[0].at("segments")[0].at("end").get<double>(), (1 / 1.8 - 0.5) / 0.5, 1e-6);
}

TEST_F(CliQuery, BadRaysNameTheirLine) {
  for (const char* line : {"1 2 3 4 5", "1 2 3 4 5 6 7", "0 0 0 0 0 nan", "0 0 inf 0 0 1", "0 0 0 0 0 0", "a b c d e f",
                           "0 0 0 0 0 1e39", "0,0,0,0,0,1", "0 0 0 0 0 0x1", "0 0 0 0 0 1.0.0"}) {
    write("rays.txt", "# one\n0 0 0 0 0 -1\n" + std::string(line) + "\n0 0 0 0 0 -1\n");
    const CliResult result = run("query scene.json --rays rays.txt");
    EXPECT_EQ(result.status, 1) << line;
    EXPECT_EQ(result.err.rfind("kairos: rays.txt:3: ", 0), 0u) << result.err;
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1);
    EXPECT_EQ(lines(result.out).size(), 1u) << "what came before is answered";
  }
  write("rays.txt", std::string(1 << 20, '1'));
  EXPECT_EQ(run("query scene.json --rays rays.txt").status, 1);
  write("rays.txt", std::string("0 0 0 0 0 1\0 9\n", 15));
  EXPECT_EQ(run("query scene.json --rays rays.txt").status, 1) << "a NUL is not the end of a line";
}

TEST_F(CliQuery, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  write("rays.txt", "0 0 0 0 0 -1\n");
  EXPECT_EQ(std::system(("cd '" + folder_.string() +
                         "' && '" KAIROS_CLI "' query scene.json --rays rays.txt > /dev/full 2> err.txt")
                            .c_str()) >>
                8,
            1);
  EXPECT_EQ(read(path("err.txt")).rfind("kairos: standard output", 0), 0u);
}

TEST_F(CliQuery, InfoSaysWhatWasLoaded) {
  const CliResult text = run("info scene.json");
  EXPECT_EQ(text.status, 0) << text.err;
  for (const char* word :
       {"2 meshes", "4 triangles", "mesh 'bar': 2 triangles, 2 keys at 0 1", "still", "60 degrees", "32x20"})
    EXPECT_NE(text.out.find(word), std::string::npos) << word << " in\n" << text.out;
  const json info = json::parse(run("info scene.json --json").out);
  EXPECT_EQ(info.at("triangles"), 4);
  EXPECT_EQ(info.at("meshes")[0].at("keys"), 2);
  EXPECT_EQ(info.at("meshes")[0].at("key_times"), json({0, 1}));
  EXPECT_EQ(info.at("meshes")[1].at("keys"), 1);
  EXPECT_EQ(info.at("cameras").size(), 1u);
  EXPECT_TRUE(info.at("warnings").is_array());
  EXPECT_GT(info.at("geometry_memory_bytes").get<int>(), 0);
}

TEST_F(CliQuery, InfoPassesWarningsOn) {
  write("nan.obj", "v 0 0 -1\nv 1 0 -1\nv 0 1 -1\nv nan 0 0\nf 1 2 3\nf 1 2 4\n");
  const json info = json::parse(run("info nan.obj --json").out);
  EXPECT_EQ(info.at("triangles"), 1);
  EXPECT_FALSE(info.at("warnings").empty() && info.at("notes").empty());
  EXPECT_EQ(run("info nan.obj --strict").status, 1);
}

TEST_F(CliQuery, InfoTellsWhenAnimationsRunAndWhatIsAbsent) {
  write("a.gltf",
        R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 7}]}},
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}],
    "images": [{"uri": "gone.png"}], "accessors": [
      {"componentType": 5126, "count": 3, "type": "VEC3"},
      {"componentType": 5126, "count": 1, "type": "SCALAR", "min": [2], "max": [3.5]},
      {"componentType": 5126, "count": 1, "type": "VEC3"}],
    "animations": [{"name": "walk", "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                    "samplers": [{"input": 1, "output": 2}]}, {"name": "run", "channels": [], "samplers": []}]})");
  const json info = json::parse(run("info a.gltf --json").out);
  const json& walk = info.at("animations").at(0);
  EXPECT_EQ(walk.at("name"), "walk");
  EXPECT_TRUE(walk.at("plays").get<bool>());
  EXPECT_EQ(walk.at("range"), json({2, 3.5}));
  EXPECT_EQ(walk.at("frames"), json({48, 84}));
  EXPECT_FALSE(info.at("animations").at(1).at("plays").get<bool>());
  EXPECT_EQ(info.at("fps"), 24);
  EXPECT_NE(info.at("absent_pictures").at(0).get<std::string>().find("gone.png"), std::string::npos);
  const std::string text = run("info a.gltf").out;
  for (const char* line : {"animation 0: 'walk', 2 to 3.5 s, frames 48 to 84\n", "animation 1: 'run', does not play\n",
                           "light 0: point, intensity 7 7 7\n", "absent picture: ", "not 'run' (--animation"})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
}

}  // namespace
}  // namespace kairos
