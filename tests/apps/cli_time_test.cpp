// kairos render --time; expose, convert, check and info of what it writes.
#include "cli_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <nlohmann/json.hpp>

#include <kairos/deep_image.h>

#include "needed_tools.h"

namespace kairos {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST_F(CliTime, AllOfTheTimeIsThePictureBesideIt) {
  for (const std::string integrator : {"tc", "mixed", "auto"}) {
    const std::string render = std::string(kRenderTime) + "--shutter 0,10 --spp 16 --integrator " + integrator;
    ok(render + " -o beside.exr --aov coverage --time exact.ktime --time-tolerance exact");
    ok("expose exact.ktime -o exposed.exr --quiet --aov coverage");
    EXPECT_LT(difference("beside.exr", "exposed.exr"), 1e-6) << integrator;
    EXPECT_NEAR(image("exposed.exr").find("coverage.A")->values[100],
                image("beside.exr").find("coverage.A")->values[100], 1e-6);
    ok(render + " --time coded.ktime --time-tolerance 1/256@1/8");
    ok("expose coded.ktime -o coded.exr --quiet");
    EXPECT_LT(difference("beside.exr", "coded.exr"), 1e-3) << integrator;
  }
}

TEST_F(CliTime, KeepsAlphaAndHowScreensShowIt) {
  ok("render scene.json --quiet --tc-rays 2 --fps 10 --shutter 0,10 --background transparent --lights studio "
     "-o beside.exr --time file.ktime --time-tolerance exact");
  ok("expose file.ktime --quiet -o exposed.exr");
  const Image beside = image("beside.exr"), exposed = image("exposed.exr");
  ASSERT_NE(exposed.find("A"), nullptr);
  double most = 0, least = 1;
  for (size_t i = 0; i < beside.find("A")->values.size(); ++i) {
    const float alpha = beside.find("A")->values[i];
    EXPECT_NEAR(exposed.find("A")->values[i], alpha, 1e-6);
    most = std::max(most, static_cast<double>(alpha));
    least = std::min(least, static_cast<double>(alpha));
  }
  EXPECT_GT(most, least) << "else any constant would do";

  // Lit pictures are shown with a shoulder by themselves; two stops brighter there is something above it.
  ok("expose file.ktime --quiet -o own.png --exposure 2");
  ok("expose file.ktime --quiet -o filmic.png --exposure 2 --view filmic");
  ok("expose file.ktime --quiet -o standard.png --exposure 2 --view standard");
  ok("expose file.ktime --quiet -o darker.png --view filmic");
  const auto green = [&](const std::string& name) { return image(name).find("G")->values; };
  EXPECT_TRUE(green("own.png") == green("filmic.png"));
  EXPECT_TRUE(green("standard.png") != green("filmic.png"));
  EXPECT_TRUE(green("darker.png") != green("filmic.png"));
}

// Rays do not depend on the shutter, and straight motion between two keys stays what it is. (Beside a file of their
// own, fresh pictures have the same rays: those of a picture alone are put where they serve its own shutter best.)
TEST_F(CliTime, APartOfTheTimeIsARenderingOfIt) {
  ok(std::string(kRenderTime) + "--shutter 0,10 --time all.ktime --time-tolerance exact");
  for (const std::string options : {"--shutter 2.5,5", "--shutter 0.1s@0.3s", "--shutter 100ms --rolling top:0.5s",
                                    "--shutter 1f --rolling bottom:500ms:reset --normalise energy"}) {
    ok(std::string(kRenderTime) + "-o fresh.exr --time fresh.ktime " + options);
    ok("expose all.ktime --quiet -o exposed.exr " + options);
    EXPECT_LT(difference("fresh.exr", "exposed.exr"), 1e-5) << options;
  }
}

// Layers that are made of a file are those of a rendering, and deep samples are what other programs make the exposure
// of.
TEST_F(CliTime, LayersAndDeepSamplesOfObjects) {
  const std::string render = std::string(kRenderTime) + "--shutter 0,10 --time-tolerance exact ";
  ok(render + "-o beside.exr --aov depth,mesh,coverage --time all.ktime --time-planes objects,rays");
  ok("expose all.ktime --quiet -o all.exr --aov depth,mesh,coverage --cryptomatte object,material");
  const Image beside = image("beside.exr"), exposed = image("all.exr");
  for (const char* name : {"depth.Z", "mesh.id", "coverage.A"}) {
    const std::vector<float>&x = beside.find(name)->values, &y = exposed.find(name)->values;
    for (size_t i = 0; i < x.size(); ++i)
      ASSERT_TRUE(x[i] == y[i] || std::abs(x[i] - y[i]) < 1e-5f) << name << " " << i;
  }
  // Names cover what anything covers.
  for (const std::string matte : {"CryptoObject00", "CryptoMaterial00"})
    for (size_t i = 0; i < exposed.find("coverage.A")->values.size(); ++i)
      ASSERT_NEAR(exposed.find(matte + ".g")->values[i] + exposed.find(matte + ".a")->values[i],
                  exposed.find("coverage.A")->values[i], 1e-6);

  EXPECT_THAT(refusal("expose all.ktime --quiet -o deep.png --deep object", 2), HasSubstr("EXR"));
  ok(std::string(kRenderTime) + "--shutter 0,10 --time colours.ktime");
  EXPECT_THAT(refusal("expose colours.ktime --quiet -o a.exr --aov depth", 1), HasSubstr("--time-planes objects"));
  EXPECT_THAT(refusal("expose colours.ktime --quiet -o a.exr --deep segments", 1), HasSubstr("--time-planes rays"));

  KAIROS_NEEDS(std::system("oiiotool --help > /dev/null 2>&1") == 0, "oiiotool");
  ok("expose all.ktime --quiet -o flat.exr --shutter 3f@2f");
  const auto oiiotool = [&](const std::string& arguments) {
    return std::system(("cd '" + path("") + "' && oiiotool " + arguments + " > /dev/null 2>&1").c_str());
  };
  // What is merged with something far behind is tidied first, which merges samples at one distance by other rules.
  DeepImage far;
  far.image = image("flat.exr");
  const size_t pixels = far.image.channels[0].values.size();
  far.image.channels.clear();
  for (const char* name : {"R", "G", "B", "A", "Z", "id"})
    far.image.channels.push_back({name, name == std::string("id") ? Channel::Storage::integer : Channel::Storage::exact,
                                  std::vector<float>(pixels, name == std::string("Z") ? 1e11f : 1)});
  for (size_t i = 0; i <= pixels; ++i) far.first.push_back(i);
  write_deep_image(far, path("far.exr"));
  std::vector<size_t> bytes;
  for (const std::string of : {"object", "segments"}) {
    ok("expose all.ktime --quiet -o deep.exr --shutter 3f@2f --deep " + of);
    bytes.push_back(read(path("deep.exr")).size());
    ASSERT_EQ(oiiotool("deep.exr --flatten --ch R,G,B -o flattened.exr"), 0);
    EXPECT_LT(difference("flat.exr", "flattened.exr"), 1e-5) << of;
    ASSERT_EQ(oiiotool("deep.exr --ch R,G,B,A,Z,id far.exr --deepmerge --flatten --ch R,G,B -o merged.exr"), 0);
    EXPECT_LT(difference("flat.exr", "merged.exr"), 1e-5) << of;
  }
  EXPECT_GT(bytes[1], bytes[0] + 1000) << "a sample for each segment";
}

TEST_F(CliTime, FramesStacksAndInstants) {
  ok(std::string(kRenderTime) + "--shutter 0,10 --time all.ktime --time-tolerance exact");
  ok("expose all.ktime --quiet -o frame_%02d.exr --frames 3-5 --fps 20 --shutter 1");
  ok("render scene.json --quiet --shading flat --tc-rays 8 --fps 20 -o fresh.exr --time fresh.ktime --frame 4 "
     "--shutter 1");
  EXPECT_LT(difference("fresh.exr", "frame_04.exr"), 1e-5);
  EXPECT_TRUE(exists("frame_03.exr") && exists("frame_05.exr"));

  ok("expose all.ktime --quiet -o stack_%d.exr --stack 4");
  ok("expose all.ktime --quiet -o quarter.exr --shutter 2.5@7.5");
  EXPECT_LT(difference("quarter.exr", "stack_3.exr"), 1e-6);
  EXPECT_TRUE(exists("stack_0.exr"));
  EXPECT_FALSE(exists("stack_4.exr"));

  ok("expose all.ktime --quiet -o instant.exr --at 500ms");
  ok(std::string(kRenderTime) + "-o still.exr --time still.ktime --shutter 5,5");
  EXPECT_LT(difference("still.exr", "instant.exr"), 1e-5);
}

// A file of several frames, each a slab of its time: exposures within a frame and across their borders are those of one
// long recording, and the file goes on where it was left.
TEST_F(CliTime, ManyFramesAreOneFile) {
  const std::string sampled =
      " --quiet --shading flat --tc-rays 8 --fps 10 --time-tolerance exact --time-planes geometry,objects ";
  ok("render scene.json --frames 2-4 --time slabs.ktime" + sampled);
  ok("render scene.json --frame 2 --shutter 0,3 --time whole.ktime" + sampled);
  const auto same = [&](const std::string& options) {
    for (const std::string name : {"slabs", "whole"})
      ok("expose " + name + ".ktime -o " + name + ".exr --quiet " + options);
    EXPECT_LT(difference("slabs.exr", "whole.exr"), 1e-4) << options;
  };
  same("");
  same("--shutter 0.5,2.5 --curve triangle");
  same("--shutter 0.3f@1.2f --aov depth,mesh,motion");
  const Image slabs = image("slabs.exr"), whole = image("whole.exr");
  for (const char* channel : {"mesh.id", "forward.u"})
    for (size_t i = 0; i < 32 * 20; ++i)
      ASSERT_NEAR(slabs.find(channel)->values[i], whole.find(channel)->values[i], 1e-3) << channel;
  same("--shutter 1 --rolling top:0.2s");
  ok("expose slabs.ktime --frames 2-4 -o f_%d.exr --quiet");
  ok("expose whole.ktime --shutter 2,2.5 -o f.exr --quiet");
  EXPECT_LT(difference("f_4.exr", "f.exr"), 1e-4);
  const json info = json::parse(run("info slabs.ktime --json").out, nullptr, false);
  EXPECT_EQ(info.at("slabs"), 3);

  EXPECT_THAT(refusal("render scene.json --frames 2-4 --time no.ktime --shutter 0,2", 2), HasSubstr("--shutter"));
  EXPECT_THAT(refusal("render scene.json --frames 2-4 --time no.ktime -o a.exr", 2), HasSubstr("kairos expose"));
}

TEST_F(CliTime, HasTheSameBytesForAnyNumberOfThreads) {
  const std::string render = std::string(kRenderTime) + "--shutter 0,10 --size 100x70 ";
  ok(render + "--threads 1 --time one.ktime");
  ok(render + "--threads 3 --time three.ktime");
  EXPECT_EQ(read(path("one.ktime")), read(path("three.ktime")));
  EXPECT_FALSE(exists("one.ktime.part"));
}

TEST_F(CliTime, GoesOnWithAPart) {
  const std::string render = std::string(kRenderTime) + "--shutter 0,10 --size 100x70 --time out.ktime ";
  ok(render);
  const std::string whole = read(path("out.ktime"));
  // What ended after the head and the first tiles: as a finished file, but for what its head says of its end.
  write("out.ktime.part", "x");
  EXPECT_EQ(run(render).status, 0) << "hardly begun";
  EXPECT_EQ(read(path("out.ktime")), whole);
  write("out.ktime.part", whole);
  EXPECT_THAT(refusal(render, 1), HasSubstr("of another rendering"));
  EXPECT_EQ(read(path("out.ktime")), whole) << "what was there stays";
}

// Killed at twenty moments, and gone on with each time.
TEST_F(CliTime, LosesNothingWhenItIsKilled) {
  if (std::getenv("KAIROS_LONG") == nullptr) GTEST_SKIP() << "takes a while; every prefix of a part is tried elsewhere";
  const std::string render = std::string(kRenderTime) + "--shutter 0,10 --size 320x200 --time-planes objects --time ";
  ok(render + "whole.ktime");
  const std::string part = path("out.ktime.part");
  size_t left = 0;  // parts of which some tiles are there
  for (int i = 1; i <= 20; ++i) {
    const std::string seconds = std::to_string(0.02 + 0.01 * i);
    const std::string killed = "timeout -s KILL " + seconds + " '" KAIROS_CLI "' " + render + "out.ktime";
    ASSERT_EQ(std::system(("cd '" + path("") + "' && " + killed + " 2> /dev/null; true").c_str()), 0);
    if (!exists("out.ktime.part")) continue;
    const CliResult info = run("info out.ktime.part --json");
    left += info.status == 0 && json::parse(info.out, nullptr, false).at("tiles_there") > 0;
  }
  ASSERT_GT(left, 0u) << "no moment was one at which some tiles were there: the moments have to be others here";
  ok(render + "out.ktime");
  EXPECT_TRUE(read(path("out.ktime")) == read(path("whole.ktime")));
  EXPECT_FALSE(exists("out.ktime.part"));
}

/// The numbers of an array of an archive (docs/time.md, "For numpy"), which holds nothing compressed.
template <class Number>
std::vector<Number> numbers(const std::string& archive, const std::string& name, const std::string& shape) {
  const size_t begin = archive.find("NUMPY", archive.find(name + ".npy"));
  const size_t data = archive.find('\n', begin) + 1, next = archive.find("PK\3\4", data);
  EXPECT_THAT(archive.substr(begin, data - begin), HasSubstr("'shape': " + shape)) << name;
  std::vector<Number> out((std::min(next, archive.find("PK\1\2", data)) - data) / sizeof(Number));
  std::memcpy(out.data(), &archive[data], out.size() * sizeof(Number));
  return out;
}

TEST_F(CliTime, ArraysOfNumpyExposeAsTheFileDoes) {
  // Coded, whose pieces slope.
  ok(std::string(kRenderTime) + "--shutter 0,10 --size 100x70 --crop 10,97,5,66 --time all.ktime");
  ok("expose all.ktime --quiet -o exposed.exr --aov coverage --shutter 2.5,5");
  ok("convert all.ktime -o all.npz --quiet");
  const std::string archive = read(path("all.npz"));
  EXPECT_EQ(numbers<int32_t>(archive, "size", "(2,)"), (std::vector<int32_t>{87, 61}));
  EXPECT_EQ(numbers<int32_t>(archive, "frame", "(4,)"), (std::vector<int32_t>{100, 70, 10, 5}));
  EXPECT_EQ(numbers<double>(archive, "shutter", "(2,)"), (std::vector<double>{0, 1}));
  const auto offsets = numbers<int64_t>(archive, "offsets", "(5308,)");
  ASSERT_EQ(offsets.size(), 5308u);
  const std::string count = std::to_string(offsets.back());
  const auto begin = numbers<double>(archive, "begin", "(" + count + ",)");
  const auto end = numbers<double>(archive, "end", "(" + count + ",)");
  const auto left = numbers<float>(archive, "left", "(" + count + ", 4)");
  const auto right = numbers<float>(archive, "right", "(" + count + ", 4)");
  const Image exposed = image("exposed.exr");
  double most = 0;
  for (size_t c = 0; c < 4; ++c) {
    const auto& values = exposed.find(std::array{"R", "G", "B", "coverage.A"}[c])->values;
    for (size_t pixel = 0; pixel + 1 < offsets.size(); ++pixel) {
      double mean = 0;
      for (auto i = static_cast<size_t>(offsets[pixel]); i < static_cast<size_t>(offsets[pixel + 1]); ++i) {
        const double from = std::clamp(begin[i], 0.25, 0.5), to = std::clamp(end[i], 0.25, 0.5);
        const double place = ((from + to) / 2 - begin[i]) / (end[i] - begin[i]);
        const double first = left[4 * i + c], last = right[4 * i + c];
        mean += (to - from) / 0.25 * (first + (last - first) * place);
      }
      most = std::max(most, std::abs(mean - static_cast<double>(values[pixel])));
    }
  }
  EXPECT_LT(most, 1e-5);
  EXPECT_THAT(refusal("convert all.ktime -o all.png", 2), HasSubstr(".npz"));
  EXPECT_THAT(refusal("convert scene.json -o bad.npz", 1), HasSubstr("scene.json"));
  EXPECT_FALSE(exists("bad.npz"));
}

TEST_F(CliTime, SaysWhatIsInAFile) {
  ok(std::string(kRenderTime) + "--shutter 0,10 --crop 3,32,0,20 --time all.ktime");
  const CliResult check = run("check all.ktime");
  EXPECT_EQ(check.status, 0);
  EXPECT_THAT(check.out, HasSubstr("1 of 1 tiles"));
  const json info = json::parse(run("info all.ktime --json").out, nullptr, false);
  EXPECT_EQ(info.at("crop"), json({3, 32, 0, 20}));
  EXPECT_EQ(info.at("shutter"), json({0.0, 1.0}));
  EXPECT_LE(info.at("deviation"), info.at("tolerance"));
  EXPECT_THAT(run("info all.ktime").out, HasSubstr("29x20 pixels of a frame of 32x20"));
  std::string bytes = read(path("all.ktime"));
  bytes[bytes.size() / 2] ^= 1;
  write("bad.ktime", bytes);
  EXPECT_THAT(refusal("check bad.ktime", 1), HasSubstr("bad.ktime"));
}

TEST_F(CliTime, WritesAPage) {
  ok(std::string(kRenderTime) + "--shutter 0,10 --time '<b>.ktime'");
  ok("expose '<b>.ktime' --quiet --page page.html --page-width 20");
  const std::string page = read(path("page.html"));
  const size_t data = page.find("id=\"data\">") + std::string("id=\"data\">").size();
  const json held = json::parse(page.substr(data, page.find("</script>", data) - data), nullptr, false);
  EXPECT_EQ(held.at("width"), 16) << "of 32";
  EXPECT_EQ(held.at("height"), 10);
  EXPECT_EQ(held.at("file"), "<b>.ktime");
  EXPECT_GE(held.at("pieces"), 160);
  ok("expose '<b>.ktime' --quiet --page page.html -o both.exr");
  EXPECT_TRUE(exists("both.exr"));

  ok(std::string(kRenderTime) + "--shutter 3,3 --time still.ktime");
  EXPECT_THAT(refusal("expose still.ktime --quiet --page still.html", 1), HasSubstr("a single instant"));
  EXPECT_THAT(refusal("expose still.ktime --quiet --page no/still.html", 1), HasSubstr("no/still.html"));
  EXPECT_THAT(refusal("expose still.ktime -o a.png --page-width 20", 2), HasSubstr("--page"));
  EXPECT_FALSE(exists("still.html"));
}

TEST_F(CliTime, RefusesInOneLine) {
  ok(std::string(kRenderTime) + "--shutter 0,10 --time all.ktime");
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --quiet --shutter 0.9s,1.2s", 1), HasSubstr("--shutter 0,12"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --quiet --at -1f", 1), HasSubstr("--shutter -1,10"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --quiet --rolling top:10ms", 1), HasSubstr("ends"));
  EXPECT_THAT(refusal("expose scene.json -o a.exr --quiet", 1), HasSubstr("is no picture over time"));
  EXPECT_THAT(refusal("expose none.ktime -o a.exr --quiet", 1), HasSubstr("none.ktime"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --at 1 --stack 3", 2), HasSubstr("--stack"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --stack 3", 2), HasSubstr("--output"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --view filmic", 2), HasSubstr("is for PNG"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --aov normal", 2), HasSubstr("--aov"));
  EXPECT_THAT(refusal(std::string(kRenderTime), 2), HasSubstr("--output"));
  EXPECT_THAT(refusal(std::string(kRenderTime) + "--time a.ktime --view filmic", 2), HasSubstr("is for a picture"));
  EXPECT_THAT(refusal(std::string(kRenderTime) + "--integrator qmc --time a.ktime", 2),
              HasSubstr("use the integrator tc"));
  EXPECT_THAT(refusal(std::string(kRenderTime) + "--time a.ktime --time-tolerance 2@0", 2),
              HasSubstr("--time-tolerance"));
  EXPECT_THAT(refusal(std::string(kRenderTime) + "-o a.exr --time-tolerance exact", 2), HasSubstr("--time"));
  EXPECT_FALSE(exists("a.exr"));
  EXPECT_FALSE(exists("a.ktime"));
}

}  // namespace
}  // namespace kairos
