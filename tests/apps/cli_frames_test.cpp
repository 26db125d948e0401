// Sequences: kairos render --frames, kairos compare --frames.
#include <cmath>

#include <nlohmann/json.hpp>

#include "cli.h"
#include "image/read_exr.h"

namespace kairos {
namespace {

class CliFrames : public CliTest {
 protected:
  static constexpr const char* kShot = "render scene.json --quiet --fps 8 --tc-rays 2 ";

  std::vector<float> red(const std::string& name) const { return read_image(path(name)).find("R")->values; }
};

TEST_F(CliFrames, EachFrameIsWhatFrameAloneGives) {
  const CliResult result = run(std::string(kShot) + "-o a_%04d.exr --frames 0-3 --stats-file s%d.json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const int frame : {0, 1, 2, 3}) {
    const std::string number = std::to_string(frame);
    ASSERT_EQ(run(std::string(kShot) + "-o alone" + number + ".exr --frame " + number).status, 0);
    EXPECT_EQ(red("a_000" + number + ".exr"), red("alone" + number + ".exr"));
    EXPECT_EQ(nlohmann::json::parse(read(path("s" + number + ".json"))).at("triangles"), 4);
  }
  EXPECT_NE(red("a_0000.exr"), red("a_0001.exr"));
  EXPECT_FALSE(exists("a_0004.exr"));
}

TEST_F(CliFrames, WhatIsThereIsNotMadeAgain) {
  ASSERT_EQ(run("render scene.json -o a%d.png --fps 8 --tc-rays 1 --frames 5").status, 0);
  const auto written = std::filesystem::last_write_time(path("a5.png"));
  const CliResult result = run("render scene.json -o a%d.png --fps 8 --tc-rays 1 --frames 4-6");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(std::filesystem::last_write_time(path("a5.png")), written);
  EXPECT_TRUE(exists("a4.png") && exists("a6.png"));
  EXPECT_NE(result.err.find("1 of 3 frames are there already"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("wrote a4.png; 1 of 2, "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("wrote a6.png\n"), std::string::npos) << result.err;
  // All of them; neither threads nor what is logged decide what they are.
  EXPECT_EQ(run("render ./scene.json -o a%d.png --fps 8 --tc-rays 1 --quiet --threads 1 --frames 4-6").status, 0);
  EXPECT_EQ(std::filesystem::last_write_time(path("a5.png")), written);
}

TEST_F(CliFrames, PicturesOfAnotherSequenceAreNeitherKeptNorWrittenOver) {
  for (const std::string name : {"a%d.png", "a%d.exr"}) {
    const std::string first = "a0" + name.substr(3), second = "a1" + name.substr(3);
    const std::string command = "render scene.json --fps 8 --quiet --frames 0-1 -o " + name;
    ASSERT_EQ(run(command + " --tc-rays 1").status, 0);
    ASSERT_EQ(run(command + " --tc-rays 1").status, 0);
    const std::string kept = read(path(first));
    const auto refused = [&](const std::string& how) {
      const CliResult result = run(command + how);
      EXPECT_EQ(result.status, 1) << how;
      EXPECT_TRUE(result.one_line_error()) << result.err;
      EXPECT_NE(result.err.find(first + ": is there, but made otherwise"), std::string::npos) << result.err;
    };
    refused(" --tc-rays 2");
    refused(" --tc-rays 1 --shading flat");
    const std::string scene = read(path("scene.json"));
    write("scene.json", scene + " ");
    refused(" --tc-rays 1");
    write("scene.json", scene);
    EXPECT_EQ(read(path(first)), kept);
    write(first, "somebody's picture");
    refused(" --tc-rays 1");
    EXPECT_EQ(read(path(first)), "somebody's picture");
    std::filesystem::remove(path(first));
    ASSERT_EQ(run(command + " --tc-rays 1").status, 0);
  }
}

TEST_F(CliFrames, DamagedPicturesAreMadeAgain) {
  for (const std::string name : {"d%d.png", "d%d.exr"}) {
    const std::string command = "render scene.json --fps 8 --tc-rays 1 --frames 0-3 -o " + name;
    ASSERT_EQ(run(command).status, 0);
    const auto file = [&](int frame) { return "d" + std::to_string(frame) + name.substr(3); };
    const std::string second = read(path(file(1))), third = read(path(file(2)));
    const std::vector<float> pixels[] = {red(file(0)), red(file(1)), red(file(2))};
    write(file(0), "");
    write(file(1), second.substr(0, 6));
    write(file(2), third.substr(0, third.size() - 20));  // which has the mark
    const CliResult result = run(command);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find("1 of 4 frames are there already"), std::string::npos) << result.err;
    for (int frame = 0; frame < 3; ++frame) {
      EXPECT_EQ(red(file(frame)), pixels[frame]) << file(frame);
      EXPECT_NE(result.err.find(file(frame) + " is no whole picture: it is made again"), std::string::npos)
          << result.err;
    }
  }
}

TEST_F(CliFrames, LostStatsFilesAreMadeAgain) {
  const std::string command = std::string(kShot) + "-o a%d.exr --frames 0-1 --stats-file s%d.json";
  ASSERT_EQ(run(command).status, 0);
  const std::vector<float> before = red("a1.exr");
  std::filesystem::remove(path("s1.json"));
  ASSERT_EQ(run(command).status, 0);
  EXPECT_TRUE(exists("s1.json"));
  EXPECT_EQ(red("a1.exr"), before);
}

TEST_F(CliFrames, NamesOfFramesAreChecked) {
  const size_t before = files();
  const auto refused = [&](const std::string& arguments, const std::string& word) {
    const CliResult result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_TRUE(result.one_line_error()) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  };
  for (const std::string name : {"a.png", "a%d%d.png", "a%s.png", "a%04.png", "a%4d.png", "a%0d.png", "a%00d.png",
                                 "a%012d.png", "a%%d.png", "a%d.png%", "a%d%", "%n%d.png", "a%-3d.png"})
    refused("render scene.json --frames 0-1 -o '" + name + "'", "--output: '" + name + "'");
  refused("render scene.json --frames 0-1 -o a%d.png --stats-file s.json", "--stats-file: 's.json'");
  for (const std::string frames :
       {"3-2", "-1-2", "1-", "-", "a-b", "1-2-3", "1.5-2", "0-100000", "5000000000-5000000001"})
    refused("render scene.json -o a%d.png --frames=" + frames, "--frames");
  refused("render scene.json -o a%d.png --frames 0-1 --frame 2", "--frame");
  refused("compare --frames 0-1 a.exr b%d.exr", "REFERENCE: 'a.exr'");
  refused("compare --frames 0-1 a%d.exr b.exr", "IMAGE: 'b.exr'");
  refused("compare --frames 1-1 a%d.exr b%d.exr", "two frames");
  refused("compare --frames 0-1 a%d.exr b%d.exr --side-by-side s.png", "--side-by-side");
  EXPECT_EQ(files(), before);
}

TEST_F(CliFrames, PercentSignsMeanThemselvesOtherwise) {
  ASSERT_EQ(run(std::string(kShot) + "-o 50%%_%02d_.png --frames 7").status, 0);
  EXPECT_TRUE(exists("50%_07_.png"));
  ASSERT_EQ(run(std::string(kShot) + "-o 50%d.png").status, 0);  // not a sequence
  EXPECT_TRUE(exists("50%d.png"));
}

TEST_F(CliFrames, FlickerIsTheMeanChangeOfTheError) {
  ASSERT_EQ(run(std::string(kShot) + "-o r%d.exr --frames 0-2 --integrator qmc --spp 2").status, 0);
  ASSERT_EQ(run(std::string(kShot) + "-o i%d.exr --frames 0-2 --integrator qmc --spp 2 --seed 1").status, 0);
  const CliResult result = run("compare --frames 0-2 r%d.exr i%d.exr r%d.exr");
  ASSERT_EQ(result.status, 0) << result.err;
  double sum = 0, squares = 0;
  size_t pixels = 0;
  std::vector<double> before;
  for (const std::string frame : {"0", "1", "2"}) {
    const Image reference = read_exr(path("r" + frame + ".exr")), image = read_exr(path("i" + frame + ".exr"));
    std::vector<double> error;
    for (const char* name : {"R", "G", "B"})
      for (size_t i = 0; i < image.find(name)->values.size(); ++i)
        error.push_back(double{image.find(name)->values[i]} - double{reference.find(name)->values[i]});
    pixels = error.size();
    for (size_t i = 0; i < error.size(); ++i) {
      if (!before.empty()) sum += std::abs(error[i] - before[i]);
      squares += error[i] * error[i];
    }
    before = error;
  }
  double mse = 0, psnr = 0, flicker = 0;
  ASSERT_EQ(std::sscanf(result.out.c_str(), "i%%d.exr: MSE %lf, PSNR %lf dB, flicker %lf", &mse, &psnr, &flicker), 3)
      << result.out;
  EXPECT_GT(flicker, 0);
  EXPECT_NEAR(flicker, sum / static_cast<double>(2 * pixels), 1e-3 * flicker);
  EXPECT_NEAR(mse, squares / static_cast<double>(3 * pixels), 1e-3 * mse);
  EXPECT_NEAR(psnr, -10 * std::log10(mse), 0.01);
  EXPECT_NE(result.out.find("r%d.exr: MSE 0, PSNR inf dB, flicker 0\n"), std::string::npos) << result.out;

  const CliResult missing = run("compare --frames 0-3 r%d.exr i%d.exr");
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.err.find("r3.exr"), std::string::npos) << missing.err;
}

TEST_F(CliFrames, ASequenceHasOneSize) {
  for (const std::string name : {"r", "i"}) {
    ASSERT_EQ(run(std::string(kShot) + "-o " + name + "0.exr").status, 0);
    ASSERT_EQ(run(std::string(kShot) + "-o " + name + "1.exr --size 20x20").status, 0);
  }
  const CliResult result = run("compare --frames 0-1 r%d.exr i%d.exr");
  EXPECT_EQ(result.status, 1);
  EXPECT_TRUE(result.one_line_error());
  EXPECT_NE(result.err.find("i1.exr: is of another size than the frame before"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace kairos
