// kairos render --time, expose, check and info of what it writes.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <kairos/image.h>

#include "cli.h"

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
TEST_F(CliTime, WritesFlow) {
  const std::string flow = "flow scene.json --quiet --fps 10 ";
  ok(flow + "--to 1s -o forward.exr --occlusion hidden.png");
  ok(flow + "--from 10 --to 0 -o backward.exr");
  const auto mean = [&](const std::string& name, const char* channel) {
    double sum = 0;
    for (const float value : image(name).find(channel)->values) sum += static_cast<double>(value);
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
  EXPECT_THAT(refusal("expose all.ktime -o a.exr --aov depth", 2), HasSubstr("--aov"));
  EXPECT_THAT(refusal(std::string(kRender), 2), HasSubstr("--output"));
  EXPECT_THAT(refusal(std::string(kRender) + "--integrator qmc --time a.ktime", 2), HasSubstr("use the integrator tc"));
  EXPECT_THAT(refusal(std::string(kRender) + "--time a.ktime --time-tolerance 2@0", 2), HasSubstr("--time-tolerance"));
  EXPECT_THAT(refusal(std::string(kRender) + "-o a.exr --time-tolerance exact", 2), HasSubstr("--time"));
  EXPECT_FALSE(exists("a.exr"));
  EXPECT_FALSE(exists("a.ktime"));
}

}  // namespace
}  // namespace kairos
