// kairos render --time; expose, convert, check and info of what it writes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <kairos/deep_image.h>
#include <kairos/image.h>

#include "cli.h"
#include "needed_tools.h"

namespace kairos {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliTime : public CliTest {
 protected:
  void ok(const std::string& arguments) const {
    const CliResult result = run(arguments);
    ASSERT_EQ(result.status, 0) << arguments << "\n" << result.err;
  }
  std::string refusal(const std::string& arguments, int status) const {
    const CliResult result = run(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    EXPECT_TRUE(result.one_line_error()) << result.err;
    return result.err;
  }
  /// Those of a .flo.
  std::vector<float> vectors_of(const std::string& name, const std::string& folder) const {
    const std::string flo = read(path(folder + name));
    std::vector<float> vectors((std::max<size_t>(12, flo.size()) - 12) / 4);
    std::memcpy(vectors.data(), flo.data() + 12, vectors.size() * 4);
    return vectors;
  }
  Image image(const std::string& name) const { return read_image(path(name)); }
  /// Largest difference of colours.
  double difference(const std::string& a, const std::string& b) const {
    const Image first = image(a), second = image(b);
    double most = 0;
    for (const char* channel : {"R", "G", "B"}) {
      const auto &x = first.find(channel)->values, &y = second.find(channel)->values;
      EXPECT_EQ(x.size(), y.size());
      for (size_t i = 0; i < x.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(x[i]) - static_cast<double>(y[i])));
    }
    return most;
  }
};

constexpr const char* kRender = "render scene.json --quiet --shading flat --tc-rays 8 --fps 10 ";

TEST_F(CliTime, AllOfTheTimeIsThePictureBesideIt) {
  for (const std::string integrator : {"tc", "mixed", "auto"}) {
    const std::string render = std::string(kRender) + "--shutter 0,10 --spp 16 --integrator " + integrator;
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
  ok(std::string(kRender) + "--shutter 0,10 --time all.ktime --time-tolerance exact");
  for (const std::string options : {"--shutter 2.5,5", "--shutter 0.1s@0.3s", "--shutter 100ms --rolling top:0.5s",
                                    "--shutter 1f --rolling bottom:500ms:reset --normalise energy"}) {
    ok(std::string(kRender) + "-o fresh.exr --time fresh.ktime " + options);
    ok("expose all.ktime --quiet -o exposed.exr " + options);
    EXPECT_LT(difference("fresh.exr", "exposed.exr"), 1e-5) << options;
  }
}

// Layers that are made of a file are those of a rendering, and deep samples are what other programs make the exposure
// of.
TEST_F(CliTime, LayersAndDeepSamplesOfObjects) {
  const std::string render = std::string(kRender) + "--shutter 0,10 --time-tolerance exact ";
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
  ok(std::string(kRender) + "--shutter 0,10 --time colours.ktime");
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
  ok(std::string(kRender) + "--shutter 0,10 --time all.ktime --time-tolerance exact");
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
  ok(std::string(kRender) + "-o still.exr --time still.ktime --shutter 5,5");
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
  const std::string render = std::string(kRender) + "--shutter 0,10 --size 100x70 ";
  ok(render + "--threads 1 --time one.ktime");
  ok(render + "--threads 3 --time three.ktime");
  EXPECT_EQ(read(path("one.ktime")), read(path("three.ktime")));
  EXPECT_FALSE(exists("one.ktime.part"));
}

TEST_F(CliTime, GoesOnWithAPart) {
  const std::string render = std::string(kRender) + "--shutter 0,10 --size 100x70 --time out.ktime ";
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
  const std::string render = std::string(kRender) + "--shutter 0,10 --size 320x200 --time-planes objects --time ";
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
  ok(std::string(kRender) + "--shutter 0,10 --size 100x70 --crop 10,97,5,66 --time all.ktime");
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
  ok(std::string(kRender) + "--shutter 0,10 --crop 3,32,0,20 --time all.ktime");
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
  ok(std::string(kRender) + "--shutter 0,10 --time '<b>.ktime'");
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

  ok(std::string(kRender) + "--shutter 3,3 --time still.ktime");
  EXPECT_THAT(refusal("expose still.ktime --quiet --page still.html", 1), HasSubstr("a single instant"));
  EXPECT_THAT(refusal("expose still.ktime --quiet --page no/still.html", 1), HasSubstr("no/still.html"));
  EXPECT_THAT(refusal("expose still.ktime -o a.png --page-width 20", 2), HasSubstr("--page"));
  EXPECT_FALSE(exists("still.html"));
}

// The bar of the scene flies to the right; what is said of the commands' files is tested with the library.
// Two keys are the same straight lines in a file.
TEST_F(CliTime, FlowOfAFileIsThatOfItsScene) {
  ok(std::string(kRender) + "--shutter 0,10 --time all.ktime --time-planes geometry");
  ok("flow all.ktime --quiet --from 2f --to 9f -o file.exr --occlusion file.png");
  ok("flow scene.json --fps 10 --quiet --from 2f --to 9f -o scene.exr --occlusion scene.png");
  const auto same = [&](const std::string& a, const char* x, const std::string& b, const char* y) {
    const Image first = image(a), second = image(b);
    double moved = 0;
    for (size_t i = 0; i < first.find(x)->values.size(); ++i) {
      const float value = first.find(x)->values[i];
      ASSERT_TRUE(value == second.find(y)->values[i] || std::abs(value - second.find(y)->values[i]) < 1e-4f) << x << i;
      moved = std::max(moved, std::isfinite(value) ? std::abs(static_cast<double>(value)) : 0);
    }
    EXPECT_GT(moved, 0.5) << x << " is not all still";
  };
  for (const char* name : {"flow.u", "flow.state", "depth.Z"}) same("file.exr", name, "scene.exr", name);
  EXPECT_EQ(read(path("file.png")), read(path("scene.png")));

  // From the middle of the exposure to its end, and back to its beginning.
  ok("expose all.ktime --quiet -o motion.exr --aov motion --shutter 2,10");
  ok("flow scene.json --fps 10 --quiet --from 6f --to 10f -o forward.exr");
  ok("flow scene.json --fps 10 --quiet --from 6f --to 2f -o backward.exr");
  same("motion.exr", "forward.u", "forward.exr", "flow.u");
  same("motion.exr", "backward.u", "backward.exr", "flow.u");
  // A rolling shutter's lines have a middle and an end each; line 9 from 0.28 s to 0.58 s.
  ok("expose all.ktime --quiet -o rolling.exr --aov motion --shutter 3@1 --rolling top:0.4s");
  ok("flow scene.json --fps 10 --quiet --from 0.43s --to 0.58s -o line.exr");
  const Image rolling = image("rolling.exr"), line = image("line.exr");
  double moved = 0;
  for (size_t x = 0; x < 32; ++x) {
    const float u = rolling.find("forward.u")->values[9 * 32 + x];
    EXPECT_NEAR(u, line.find("flow.u")->values[9 * 32 + x], 1e-4) << x;
    moved += static_cast<double>(u);
  }
  EXPECT_GT(moved, 0.5);

  EXPECT_THAT(refusal("flow all.ktime --quiet --to 11f -o no.flo", 1), HasSubstr("--shutter 0,11"));
  EXPECT_THAT(refusal("flow all.ktime --camera 0 -o no.flo", 2), HasSubstr("--camera"));
  EXPECT_THAT(refusal("expose all.ktime --at 1 --aov motion -o no.exr", 2), HasSubstr("kairos flow"));
  ok(std::string(kRender) + "--shutter 0,10 --time colours.ktime");
  EXPECT_THAT(refusal("flow colours.ktime -o no.flo", 1), HasSubstr("--time-planes geometry"));
  EXPECT_THAT(refusal("expose colours.ktime --aov motion -o no.exr", 1), HasSubstr("--time-planes geometry"));
}

TEST_F(CliTime, WritesFlow) {
  const std::string flow = "flow scene.json --quiet --fps 10 ";
  ok(flow + "--to 1s -o forward.exr --occlusion hidden.png");
  ok(flow + "--from 10 --to 0 -o backward.exr");
  const auto mean = [&](const std::string& name, const char* channel) {
    const Image flow_image = image(name);  // lives as long as the loop
    double sum = 0;
    for (const float value : flow_image.find(channel)->values) sum += static_cast<double>(value);
    return sum;
  };
  EXPECT_GT(mean("forward.exr", "flow.u"), 1);
  EXPECT_LT(mean("backward.exr", "flow.u"), -1);
  EXPECT_TRUE(exists("hidden.png"));
  ok(flow + "--frames 3-4 -o frame_%d.flo");
  EXPECT_EQ(read(path("frame_3.flo")).size(), 12u + 8 * 32 * 20);
  EXPECT_TRUE(exists("frame_4.flo"));

  EXPECT_THAT(refusal(flow + "-o f.txt", 2), HasSubstr(".flo, .png or .exr"));
  EXPECT_THAT(refusal(flow + "-o no/f.flo", 1), HasSubstr("no/f.flo"));
  EXPECT_THAT(refusal(flow + "--shutter 0,1 -o f.flo", 2), HasSubstr("--from"));
  EXPECT_THAT(refusal(flow + "--from 1 --to 1 -o f.flo", 2), HasSubstr("--to"));
  EXPECT_THAT(refusal(flow + "--frames 1-2 -o f.flo", 2), HasSubstr("--output"));
  EXPECT_FALSE(exists("f.flo"));
}

TEST_F(CliTime, MakesDataSets) {
  // A camera that looks along -x and moves along x, a metre a second, with what it sees.
  std::string scene = read(path("scene.json"));
  const std::string still = R"({"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]})";
  const std::string moving = R"({"time": 0, "eye": [0, 0, 0], "target": [-1, 0, 0], "up": [0, 1, 0]},)"
                             R"({"time": 1, "eye": [1, 0, 0], "target": [0, 0, 0], "up": [0, 1, 0]})";
  scene.replace(scene.find(still), still.size(), moving);
  write("moving.json", scene);
  const std::string sampled = " --fps 10 --shading flat --tc-rays 8 --quiet ";
  const std::string shutter = "--shutter 1 --rolling top:0.4s --sensor-lines 40,5 ";
  ok("dataset moving.json --layout fastec-rs -o set --frames 2-3 " + sampled + shutter);
  const auto poses = read(path("set/moving_poses.csv"));
  EXPECT_EQ(std::count(poses.begin(), poses.end(), '\n'), 1 + 2 * 20);
  int frame = 0, line = 0;
  double time = 0, q[4] = {}, place[3] = {};
  const char* const row = poses.c_str() + poses.find("\n3,7,") + 1;
  ASSERT_EQ(std::sscanf(row, "%d,%d,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &frame, &line, &time, &q[0], &q[1], &q[2], &q[3],
                        &place[0], &place[1], &place[2]),
            10);
  EXPECT_NEAR(time, 0.3 + (5 + 7) * 0.01 + 0.05, 1e-9);
  EXPECT_NEAR(place[0], time, 1e-6);
  EXPECT_NEAR(q[0], std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(q[2], std::sqrt(0.5), 1e-6) << "a quarter turn about y, counter-clockwise from above";
  const json meta = json::parse(read(path("set/moving/meta.log")), nullptr, false);
  EXPECT_EQ(meta.at("line_time_s"), 0.01);
  EXPECT_EQ(meta.at("frames").size(), 2u);
  EXPECT_NEAR(meta.at("frames").at(1).at("sharp_s").get<double>(), 0.3 + (5 + 9.5) * 0.01 + 0.05, 1e-9);
  EXPECT_NEAR(meta.at("intrinsics").at("fy").get<double>(), 10 / std::tan(M_PI / 6), 1e-6);
  EXPECT_TRUE(exists("set/" + meta.at("frames").at(1).at("files").at("sharp_first").get<std::string>()));

  // The pictures are those of files that hold time.
  ok("dataset scene.json --layout bs-rsc -o set --sequence bar --exr --frames 2 --shutter 1 --rolling left:0.4s " +
     sampled);
  ok("render scene.json --frame 2 --shutter 0,5 --time all.ktime --time-tolerance exact" + sampled);
  ok("expose all.ktime -o rolling.exr --quiet --shutter 1 --rolling left:0.4s");
  const double middle = 0.4 * 15.5 / 32 + 0.05;
  ok("expose all.ktime -o sharp.exr --quiet --at " + std::to_string(middle) + "s");
  EXPECT_LT(difference("rolling.exr", "set/bar/RS/0000.exr"), 1e-4);
  EXPECT_LT(difference("sharp.exr", "set/bar/GS/0000.exr"), 1e-2);
  EXPECT_GT(difference("rolling.exr", "set/bar/GS/0000.exr"), 0.1);

  ok("dataset scene.json --layout sintel -o set --frames 1-2 --shutter 1 " + sampled);
  EXPECT_TRUE(exists("set/final/scene/frame_0002.png") && exists("set/clean/scene/frame_0001.png"));
  EXPECT_TRUE(exists("set/flow/scene/frame_0001.flo") && exists("set/occlusions/scene/frame_0001.png"));
  EXPECT_FALSE(exists("set/flow/scene/frame_0002.flo"));
  ok("dataset scene.json --layout gopro -o set --frames 1 --shutter 1 " + sampled);
  EXPECT_TRUE(exists("set/scene/blur/000001.png") && exists("set/scene/sharp/000001.png"));
  ok("dataset scene.json --layout reds -o set --sequence 000 --frames 1 --shutter 1 " + sampled);
  EXPECT_TRUE(exists("set/train_blur/000/00000000.png") && exists("set/train_sharp/000/00000000.png"));

  EXPECT_THAT(refusal("dataset scene.json --layout bs-rsc -o no --frames 1", 2), HasSubstr("--rolling"));
  EXPECT_THAT(refusal("dataset scene.json --layout kitty -o no --frames 1", 2), HasSubstr("gopro|reds"));
  EXPECT_THAT(refusal("dataset scene.json --layout reds -o no --frames 1 --sequence a/b", 2), HasSubstr("--sequence"));
  EXPECT_FALSE(exists("no"));
  EXPECT_THAT(refusal("dataset scene.json --layout reds -o scene.json/no --frames 1 --quiet" + sampled, 1),
              HasSubstr("scene.json/no"));
}

// What loaders of these read, as their programs wrote it: a camera that turns by an eighth to the left in a second and
// moves to the right meanwhile.
TEST_F(CliTime, DataSetsOfMovingCameras) {
  std::string scene = read(path("scene.json"));
  const std::string still = R"({"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]})";
  const std::string turning = R"({"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]},)"
                              R"({"time": 1, "eye": [0.5, 0, 0], "target": [-0.5, 0, -1], "up": [0, 1, 0]})";
  scene.replace(scene.find(still), still.size(), turning);
  write("turning.json", scene);
  const std::string sampled = " --shading flat --tc-rays 4 --quiet ";
  ok("dataset turning.json --layout 3dgs-deblur -o set --frames 0-1 --fps 1 --shutter 0,1" + sampled);
  const json transforms = json::parse(read(path("set/turning/transforms.json")), nullptr, false);
  EXPECT_EQ(transforms.at("exposure_time"), 1);
  EXPECT_NEAR(transforms.at("fl_x").get<double>(), 10 / std::tan(M_PI / 6), 1e-6);
  EXPECT_EQ(transforms.at("frames").at(0).at("camera_angular_velocity").at(1), 0) << "sharp ones are for evaluation";
  // The same second, exposed.
  ok("dataset turning.json --layout carla-rs -o set --frames 0-1 --fps 1 --shutter 0,0.5 --rolling top:0.5s" + sampled);
  std::array<double, 6> v{};
  const std::string log = read(path("set/turning/gt_vel.log"));
  ASSERT_EQ(std::sscanf(log.c_str() + log.rfind('\n', log.size() - 2) + 1, "%lf %lf %lf %lf %lf %lf", &v[0], &v[1],
                        &v[2], &v[3], &v[4], &v[5]),
            6);
  EXPECT_NEAR(v[1], -M_PI / 4, 0.03) << "about y, which points down: to the left";
  EXPECT_NEAR(v[0], 0, 1e-6);
  EXPECT_NEAR(std::hypot(v[3], v[5]), 0.5, 0.02);
  EXPECT_GT(v[3], 0.4);
  EXPECT_LT(v[5], -0.1) << "and backward, as it looks to the left in the middle of its time";

  ok("dataset scene.json --layout carla-rs -o set --frames 0-1 --fps 10 --shutter 3 --rolling top:0.4s" + sampled);
  std::istringstream depth(read(path("set/scene/0001_rs.pdepth")));
  size_t numbers = 0, near = 0;
  for (std::string number; depth >> number; ++numbers) {
    const double value = std::stod(number);
    EXPECT_TRUE(value == 2 || value == 3 || std::isinf(value)) << number;
    near += value == 2;
  }
  EXPECT_EQ(numbers, size_t{32} * 20);
  EXPECT_GT(near, 20u) << "a line a pixel or more of the bar";
  EXPECT_LT(near, 100u) << "at an instant, not over the exposure";

  // From a line's own instant to the global picture's: the bar flies on, and the middle line stays where it is.
  const std::vector<float> vectors = vectors_of("0000_gs_m.flo", "set/scene/");
  ASSERT_EQ(vectors.size(), size_t{2} * 32 * 20);
  const auto most = [&](size_t y) {
    float u = 0;
    for (size_t x = 0; x < 32; ++x)
      if (const float at = vectors[2 * (y * 32 + x)]; std::abs(at) > std::abs(u)) u = at;
    return u;
  };
  EXPECT_GT(most(7), 0.05f);
  EXPECT_LT(most(12), -0.05f);
  EXPECT_NEAR(most(7) / 2.5f, most(8) / 1.5f, 1e-3f);
  EXPECT_TRUE(exists("set/scene/0000_gs_f.flo") && exists("set/scene/0000_mask.png"));

  ok("dataset scene.json --layout kitti -o set --sequence kitti --frames 0-2 --fps 10 --shutter 1" + sampled);
  const std::string kitti = "set/kitti/training/";
  EXPECT_EQ(read(path(kitti + "image_2/000000_11.png")), read(path(kitti + "image_2/000001_10.png")));
  EXPECT_TRUE(exists(kitti + "image_2/000001_11.png"));
  EXPECT_FALSE(exists(kitti + "image_2/000002_10.png")) << "nothing comes after it";
  const auto valid = [&](const std::string& name) {
    const Image flow_image = image(kitti + name);
    const auto& values = flow_image.find("B")->values;
    return std::count_if(values.begin(), values.end(), [](float value) { return value > 0; });
  };
  EXPECT_LT(valid("flow_noc/000000_10.png"), valid("flow_occ/000000_10.png")) << "the bar covers what it comes to";
}

// A file of several frames gives the pictures that its scene does, and the flow between them.
TEST_F(CliTime, DataSetsOfFiles) {
  ok("render scene.json --frame 2 --shutter 0,4 --time all.ktime --time-planes geometry --time-tolerance exact --fps "
     "10 "
     "--shading flat --tc-rays 8 --quiet");
  const std::string scene = "dataset scene.json --fps 10 --shading flat --tc-rays 8 -o scene ",
                    file = "dataset all.ktime --sequence scene -o file ";
  for (const std::string layout : {"carla-rs --rolling top:0.04s", "sintel", "3dgs-deblur"}) {
    const std::string of_both = "--quiet --exr --frames 2-3 --shutter 0.5 --layout " + layout;
    ok(scene + of_both);
    ok(file + of_both);
  }
  size_t pictures = 0, same = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("scene"))) {
    const std::string name = std::filesystem::relative(entry.path(), path("scene")).string();
    if (entry.is_directory()) continue;
    ASSERT_TRUE(exists("file/" + name)) << name;
    if (name.ends_with(".exr")) {
      EXPECT_LT(difference("scene/" + name, "file/" + name), 1e-3) << name;
      ++pictures;
    } else if (name.ends_with(".flo")) {
      const std::vector<float> first = vectors_of(name, "scene/"), second = vectors_of(name, "file/");
      ASSERT_EQ(first.size(), second.size());
      for (size_t i = 0; i < first.size(); ++i) ASSERT_NEAR(first[i], second[i], 1e-3) << name;
      ++same;
    } else if (name.ends_with("_poses.csv") || name.ends_with("_mask.png")) {
      EXPECT_TRUE(read(path("scene/" + name)) == read(path("file/" + name))) << name;
      ++same;
    }
  }
  EXPECT_EQ(pictures, 12u);
  EXPECT_EQ(same, 8u);

  EXPECT_THAT(refusal("dataset all.ktime --layout gopro --frames 2 -o no --tc-rays 3", 2), HasSubstr("--tc-rays"));
  EXPECT_THAT(refusal("dataset all.ktime --layout gopro --frames 2-6 -o no --quiet", 1), HasSubstr("--shutter 0,4.5"));
  ok(std::string(kRender) + "--shutter 0,10 --time colours.ktime");
  EXPECT_THAT(refusal("dataset colours.ktime --layout sintel --frames 2 -o no", 1),
              HasSubstr("--time-planes geometry"));
  ok("dataset colours.ktime --layout gopro --frames 2 -o colours --quiet");
  EXPECT_TRUE(exists("colours/colours/blur/000001.png"));
  EXPECT_FALSE(exists("colours/colours_poses.csv")) << "nobody knows where the camera was";
}

TEST_F(CliTime, RefusesInOneLine) {
  ok(std::string(kRender) + "--shutter 0,10 --time all.ktime");
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --quiet --shutter 0.9s,1.2s", 1), HasSubstr("--shutter 0,12"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --quiet --at -1f", 1), HasSubstr("--shutter -1,10"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --quiet --rolling top:10ms", 1), HasSubstr("ends"));
  EXPECT_THAT(refusal("expose scene.json -o a.exr --quiet", 1), HasSubstr("is no picture over time"));
  EXPECT_THAT(refusal("expose none.ktime -o a.exr --quiet", 1), HasSubstr("none.ktime"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --at 1 --stack 3", 2), HasSubstr("--stack"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --stack 3", 2), HasSubstr("--output"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --view filmic", 2), HasSubstr("is for PNG"));
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --aov normal", 2), HasSubstr("--aov"));
  EXPECT_THAT(refusal(std::string(kRender), 2), HasSubstr("--output"));
  EXPECT_THAT(refusal(std::string(kRender) + "--time a.ktime --view filmic", 2), HasSubstr("is for a picture"));
  EXPECT_THAT(refusal(std::string(kRender) + "--integrator qmc --time a.ktime", 2), HasSubstr("use the integrator tc"));
  EXPECT_THAT(refusal(std::string(kRender) + "--time a.ktime --time-tolerance 2@0", 2), HasSubstr("--time-tolerance"));
  EXPECT_THAT(refusal(std::string(kRender) + "-o a.exr --time-tolerance exact", 2), HasSubstr("--time"));
  EXPECT_FALSE(exists("a.exr"));
  EXPECT_FALSE(exists("a.ktime"));
}

}  // namespace
}  // namespace kairos
