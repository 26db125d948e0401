// kairos flow, of scenes and of files over time.
#include "cli_time.h"

namespace kairos {
namespace {

using testing::HasSubstr;

using CliFlow = CliTime;

// The bar of the scene flies to the right; what is said of the commands' files is tested with the library.
// Two keys are the same straight lines in a file.
TEST_F(CliFlow, OfAFileIsThatOfItsScene) {
  ok(std::string(kRenderTime) + "--shutter 0,10 --time all.ktime --time-planes geometry");
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
  ok(std::string(kRenderTime) + "--shutter 0,10 --time colours.ktime");
  EXPECT_THAT(refusal("flow colours.ktime -o no.flo", 1), HasSubstr("--time-planes geometry"));
  EXPECT_THAT(refusal("expose colours.ktime --aov motion -o no.exr", 1), HasSubstr("--time-planes geometry"));
}

TEST_F(CliFlow, OfAScene) {
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

}  // namespace
}  // namespace kairos
