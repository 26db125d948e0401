// What several machines render of one job: kairos render --part, kairos merge, kairos jobs.
#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include <nlohmann/json.hpp>

#include <kairos/image.h>

#include "cli.h"
#include "seed.h"

namespace kairos {
namespace {

using nlohmann::json;

class CliParts : public CliTest {
 protected:
  static constexpr const char* kShot = "render scene.json --quiet --fps 8 --tc-rays 2 --spp 4 ";

  /// The same pixels, and the same headers but for how long it took and the command line.
  void expect_same(const std::string& merged, const std::string& whole) const {
    const Image a = read_image(path(merged)), b = read_image(path(whole));
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (size_t c = 0; c < a.channels.size(); ++c) {
      EXPECT_EQ(a.channels[c].name, b.channels[c].name);
      EXPECT_EQ(a.channels[c].values, b.channels[c].values) << merged << " " << a.channels[c].name;
    }
    EXPECT_EQ(std::tie(a.left, a.top, a.width, a.height), std::tie(b.left, b.top, b.width, b.height));
    const auto names = [](const Image& image) {
      std::vector<std::string> result;
      for (const Attribute& attribute : image.attributes)
        if (attribute.name != "kairos:frame_mark") result.push_back(attribute.name);
      return result;
    };
    EXPECT_EQ(names(a), names(b)) << merged;
  }
  void expect_refused(const std::string& arguments, const std::vector<std::string>& words) const {
    const CliResult result = run(arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_TRUE(result.one_line_error()) << result.err;
    for (const std::string& word : words) EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  }
};

TEST_F(CliParts, MakeThePictureThatOneMachineMakes) {
  std::mt19937 random(test::seed());
  const auto one_of = [&](std::vector<std::string> choices) { return choices[random() % choices.size()]; };
  std::vector<int> counts = {1, 2, 7, 16};
  std::shuffle(counts.begin(), counts.end(), random);
  for (const std::string integrator : {"tc", "qmc", "mixed", "auto"}) {
    const bool exr = integrator == "tc" || integrator == "mixed";
    const std::string ending = exr ? ".exr" : ".png";
    std::string options = "--integrator " + integrator + " --filter " + one_of({"box", "gaussian", "blackman-harris"}) +
                          one_of({"", " --crop 3,30,2,19"});
    options += exr ? " --aov depth,mesh" + one_of({"", " --half"}) : " --view filmic --exposure 3";
    const int count = counts.back();
    counts.pop_back();
    SCOPED_TRACE(options + " " + std::to_string(count) + " parts" + ending);
    ASSERT_EQ(run(kShot + options + " -o whole" + ending).status, 0);
    for (int i = count; i > 0; --i)
      ASSERT_EQ(run(kShot + options + " -o a" + ending + " --part " + std::to_string(i) + "/" + std::to_string(count) +
                    " --threads " + one_of({"1", "3"}))
                    .status,
                0);
    const CliResult merged = run("merge a" + ending + " --clean");
    ASSERT_EQ(merged.status, 0) << merged.err;
    expect_same("a" + ending, "whole" + ending);
    EXPECT_FALSE(exists("a" + ending + ".parts"));
  }
}

TEST_F(CliParts, OfSequencesAreFramesOrPiecesOfThem) {
  ASSERT_EQ(run(std::string(kShot) + "-o whole%d.exr --frames 0-2").status, 0);
  for (const int count : {2, 3, 5}) {  // of 5, each frame is two pieces
    for (int i = 1; i <= count; ++i)
      ASSERT_EQ(
          run(std::string(kShot) + "-o p%d.exr --frames 0-2 --part " + std::to_string(i) + "/" + std::to_string(count))
              .status,
          0);
    EXPECT_EQ(exists("p0.exr.parts"), count == 5);
    for (int i = 0; i < 2; ++i) {  // the second time, and of frames that are whole, there is nothing to do
      const CliResult merged = run("merge p%d.exr --frames 0-2 --clean");
      ASSERT_EQ(merged.status, 0) << merged.err;
      EXPECT_EQ(merged.err.find("p1.exr is there already") != std::string::npos, count != 5 || i == 1) << merged.err;
    }
    for (const std::string frame : {"0", "1", "2"}) expect_same("p" + frame + ".exr", "whole" + frame + ".exr");
    // Whoever goes on with the sequence, in parts or not, finds them.
    const CliResult again = run("render scene.json --fps 8 --tc-rays 2 --spp 4 -o p%d.exr --frames 0-2");
    EXPECT_NE(again.err.find("3 of 3 frames are there already"), std::string::npos) << again.err;
    for (const std::string frame : {"0", "1", "2"}) std::filesystem::remove(path("p" + frame + ".exr"));
  }
}

TEST_F(CliParts, OfStandardInputAreRenderedWithOneScene) {
  ASSERT_EQ(run(std::string(kShot) + "-o whole%d.exr --frames 0-1").status, 0);
  write("parts", "2/6\n1/6\n6/6\n3/6\n5/6\n4/6\n");  // three pieces of each frame
  const CliResult result =
      run("render scene.json --fps 8 --tc-rays 2 --spp 4 -o p%d.exr --frames 0-1 --part - < parts");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, read(path("parts")));
  size_t loaded = 0;
  for (size_t at = 0; (at = result.err.find("loaded ", at)) != result.err.npos; ++at) ++loaded;
  EXPECT_EQ(loaded, 4u) << "as often as it is another frame\n" << result.err;
  ASSERT_EQ(run("merge p%d.exr --frames 0-1 --clean --quiet").status, 0);
  for (const std::string frame : {"0", "1"}) expect_same("p" + frame + ".exr", "whole" + frame + ".exr");
  write("parts", "1/6\n7/6\n");
  const CliResult wrong = run(std::string(kShot) + "-o q%d.exr --frames 0-1 --part - < parts");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_EQ(wrong.out, "1/6\n");
  EXPECT_EQ(wrong.err, "kairos: --part: '7' is not a whole number from 1 to 6\n");
}

TEST_F(CliParts, AreMergedWhenAllAreThereOnceAndOfOneJob) {
  const auto render = [&](const std::string& part, const std::string& more = "") {
    ASSERT_EQ(run(std::string(kShot) + "-o a.exr --part " + part + more).status, 0);
  };
  expect_refused("merge a.exr", {"a.exr.parts", "holds no parts"});
  render("2/3");
  expect_refused("merge a.exr", {"a.exr: 2 of 3 parts are not there: 1, 3"});
  render("1/3");
  const std::string first = path("a.exr.parts/00001-of-00003.exr"), third = path("a.exr.parts/00003-of-00003.exr");
  // Rendered again only where it is damaged.
  const auto written = std::filesystem::last_write_time(first);
  render("1/3");
  EXPECT_EQ(std::filesystem::last_write_time(first), written);
  std::filesystem::resize_file(first, std::filesystem::file_size(first) - 30);
  render("3/3");
  expect_refused("merge a.exr", {"00001-of-00003.exr", "no whole picture"});
  render("1/3");
  // Of another job; a part twice; what is no part at all.
  const std::string kept = read(third);
  std::filesystem::remove(third);
  render("3/3", " --seed 7");
  expect_refused("merge a.exr", {"00003-of-00003.exr", "of another job than", "00001-of-00003.exr"});
  expect_refused(std::string(kShot) + "-o a.exr --part 3/3", {"00003-of-00003.exr", "made otherwise"});
  std::filesystem::remove(third);
  render("3/3", " --instruction-set scalar");
  expect_refused("merge a.exr", {"00003-of-00003.exr", "of another job than", "instruction sets"});
  std::filesystem::remove(third);
  const std::string bar = read(path("bar_1.obj"));
  write("bar_1.obj", bar + "# which the scene's file names\n");
  render("3/3");
  expect_refused("merge a.exr", {"00003-of-00003.exr", "of another job than", "scene files"});
  write("bar_1.obj", bar);
  write("a.exr.parts/00003-of-00003.exr", kept);
  write("a.exr.parts/copy.exr", kept);
  expect_refused("merge a.exr", {"copy.exr", "the same part as"});
  ASSERT_EQ(run(std::string(kShot) + "-o a.exr.parts/copy.exr").status, 0);
  expect_refused("merge a.exr", {"copy.exr", "is no part of a picture"});
  std::filesystem::remove(path("a.exr.parts/copy.exr"));
  ASSERT_EQ(run("merge a.exr --quiet").status, 0);
  EXPECT_TRUE(exists("a.exr") && exists("a.exr.parts/00001-of-00003.exr"));

  for (const std::string part : {"0/3", "4/3", "1", "1/0", "x/3", "1/3/2", "1/100000", "slurm"}) {
    const CliResult result = run(std::string(kShot) + "-o b.exr --part " + part);
    EXPECT_EQ(result.status, 2) << part;
    EXPECT_TRUE(result.one_line_error()) << result.err;
  }
  EXPECT_EQ(run(std::string(kShot) + "-o b.exr --part 1/21").status, 2) << "of 20 rows";
}

TEST_F(CliParts, OfAPictureThatWasKilledAreNotRenderedAgain) {
  std::mt19937 random(test::seed());
  const std::string shot =
      "render scene.json --quiet --tc-rays 4 --shading normal --size 96x160 --seed " + std::to_string(random() % 100);
  ASSERT_EQ(run(shot + " -o whole.exr").status, 0);
  for (int i = 0; i < 20; ++i) {
    const std::string seconds = "0.0" + std::to_string(20 + random() % 80);
    run(shot + " -o a.exr --checkpoint 0", "timeout -s KILL " + seconds + " ");
  }
  const CliResult result = run(shot + " -o a.exr --checkpoint 0");
  ASSERT_EQ(result.status, 0) << result.err;
  expect_same("a.exr", "whole.exr");
  EXPECT_FALSE(exists("a.exr.parts"));

  // What is there is taken as it is.
  ASSERT_EQ(run(shot + " -o b.exr --part 3/10").status, 0);
  const std::string part = path("b.exr.parts/00003-of-00010.exr");
  Image image = read_image(part);
  for (float& value : image.channels[0].values) value = 7;
  write_image(image, part);
  ASSERT_EQ(run(shot + " -o b.exr --checkpoint 1000").status, 0);
  const Image whole = read_image(path("whole.exr")), merged = read_image(path("b.exr"));
  const auto row = [](const Image& of, int y) {
    return std::span(of.channels[0].values).subspan(static_cast<size_t>(y) * 96, 96);
  };
  for (int y = 0; y < 160; ++y)
    EXPECT_TRUE(std::ranges::equal(
        row(merged, y),
        y / 16 == 2 ? std::vector<float>(96, 7) : std::vector<float>(row(whole, y).begin(), row(whole, y).end())))
        << y;

  ASSERT_EQ(run(shot + " -o c.exr --part 1/2").status, 0);
  expect_refused(shot + " -o c.exr --checkpoint 1", {"00001-of-00002.exr", "is no part of this picture"});
  EXPECT_EQ(run(shot + " -o c.exr --checkpoint -1").status, 2);
}

TEST_F(CliParts, OfPicturesOverTimeMakeTheFileThatOneMachineMakes) {
  std::mt19937 random(test::seed());
  const std::string integrator = std::vector<std::string>{"tc", "mixed", "auto"}[random() % 3];
  const std::string shot =
      "render scene.json --quiet --tc-rays 2 --spp 4 --size 40x130 --time-planes objects,geometry --integrator " +
      integrator;
  ASSERT_EQ(run(shot + " --time whole.ktime -o whole.exr").status, 0);
  for (const std::string count : {"1", "3", "5"}) {
    SCOPED_TRACE(integrator + " " + count);
    for (int i = std::stoi(count); i > 0; --i)
      ASSERT_EQ(run(shot + " --time a.ktime -o a.exr --part " + std::to_string(i) + "/" + count).status, 0);
    const CliResult merged = run("merge a.ktime a.exr --clean");
    ASSERT_EQ(merged.status, 0) << merged.err;
    EXPECT_TRUE(read(path("a.ktime")) == read(path("whole.ktime")));
    expect_same("a.exr", "whole.exr");
    EXPECT_FALSE(exists("a.ktime.parts") || exists("a.exr.parts"));
  }
  EXPECT_EQ(run(shot + " --time a.ktime --part 1/6").status, 2) << "of 5 rows of tiles";

  const auto render = [&](const std::string& part, const std::string& more = "") {
    ASSERT_EQ(run(shot + " --time b.ktime --part " + part + more).status, 0);
  };
  const std::string first = path("b.ktime.parts/00001-of-00002.ktime"),
                    second = path("b.ktime.parts/00002-of-00002.ktime");
  render("1/2");
  expect_refused("merge b.ktime", {"1 of 2 parts are not there: 2"});
  render("2/2", " --seed 7");
  expect_refused("merge b.ktime", {"00002-of-00002.ktime", "of another rendering than"});
  expect_refused(shot + " --time b.ktime --part 2/2", {"00002-of-00002.ktime", "made otherwise"});
  std::filesystem::remove(second);
  render("2/2");
  std::filesystem::resize_file(second, std::filesystem::file_size(second) - 5);
  expect_refused("merge b.ktime", {"no part holds the pixels", "of rows"});
  render("2/2");  // which finds that it is cut off
  const std::string kept = read(second);
  std::filesystem::copy_file(first, second, std::filesystem::copy_options::overwrite_existing);
  expect_refused("merge b.ktime", {"00002-of-00002.ktime", "has pixels that", "00001-of-00002.ktime"});
  std::filesystem::copy_file(path("whole.ktime"), second, std::filesystem::copy_options::overwrite_existing);
  expect_refused("merge b.ktime", {"00002-of-00002.ktime", "whole picture over time"});
  write("b.ktime.parts/00002-of-00002.ktime", kept);
  ASSERT_EQ(run("merge b.ktime --quiet").status, 0);
  EXPECT_TRUE(read(path("b.ktime")) == read(path("whole.ktime")));
}

TEST_F(CliParts, OfRecordingsOfEventsMakeTheFileThatOneMachineMakes) {
  std::mt19937 random(test::seed());
  struct Case {
    std::string out, options;
  };
  const std::string noise = " --leak 2 --shot-noise 3 --mismatch 0.02";
  for (const Case& c : std::vector<Case>{{"a.npz", " --labels --time-unit ns" + noise},
                                         {"b.txt", " --text-header v2e --epoch 1.5" + noise},
                                         {"c.raw", " --evt 2"},
                                         {"d.hdf5", " --labels"}}) {
    const int count = 1 + static_cast<int>(random() % 5);
    SCOPED_TRACE(c.out + c.options + " " + std::to_string(count));
    const std::string record =
        "events scene.json --quiet --size 24x16 --to 0.4 --seed " + std::to_string(random() % 100) + c.options + " -o ";
    ASSERT_EQ(run(record + "whole_" + c.out).status, 0);
    for (int i = count; i > 0; --i)
      ASSERT_EQ(run(record + c.out + " --part " + std::to_string(i) + "/" + std::to_string(count)).status, 0);
    const CliResult merged = run("merge --clean " + c.out);
    ASSERT_EQ(merged.status, 0) << merged.err;
    EXPECT_GT(std::filesystem::file_size(path(c.out)), 500u);
    EXPECT_TRUE(read(path(c.out)) == read(path("whole_" + c.out)));
    EXPECT_FALSE(exists(c.out + ".parts"));
    json notes = json::parse(read(path(c.out + ".json"))), whole = json::parse(read(path("whole_" + c.out + ".json")));
    for (json* each : {&notes, &whole})
      for (const char* name : {"command_line", "cpu_s"}) each->erase(name);
    EXPECT_EQ(notes, whole);
  }

  const std::string record = "events scene.json --quiet --size 24x16 --to 0.4 -o e.npz ";
  ASSERT_EQ(run(record + "--part 1/2").status, 0);
  expect_refused("merge e.npz", {"1 of 2 parts are not there: 2"});
  ASSERT_EQ(run(record + "--part 2/2 --seed 7").status, 0);
  expect_refused("merge e.npz", {"00002-of-00002.npz", "of another recording than"});
  expect_refused(record + "--part 2/2", {"00002-of-00002.npz", "made otherwise"});
  std::filesystem::remove(path("e.npz.parts/00002-of-00002.npz"));
  ASSERT_EQ(run(record + "--part 2/2").status, 0) << "what is there is not all of a part";
  std::filesystem::resize_file(path("e.npz.parts/00002-of-00002.npz"), 400);
  expect_refused("merge e.npz", {"00002-of-00002.npz", "numpy archive"});
  EXPECT_FALSE(exists("e.npz"));
  EXPECT_EQ(run(record + "-o f.npz --part 1/2").status, 2) << "one file";
  EXPECT_EQ(run(record + "--part 1/17").status, 2) << "of 16 rows";
}

TEST_F(CliParts, OfARecordingOfEventsThatWasKilledAreNotRecordedAgain) {
  std::mt19937 random(test::seed());
  const std::string record =
      "events scene.json --quiet --size 24x16 --to 1 --chunk 0.02 --labels --time-unit ns --leak 2 --seed " +
      std::to_string(random() % 100) + " -o ";
  ASSERT_EQ(run(record + "whole.npz").status, 0);
  int left = 0;
  double seconds = 0.02;  // and more, until it is enough for a chunk
  for (int i = 0; i < 60 && left < 3; ++i) {
    const double wait = seconds * (1 + static_cast<double>(random() % 1000) / 1000);
    run(record + "a.npz --checkpoint 0", "timeout -s KILL " + std::to_string(wait) + " ");
    if (exists("a.npz.unfinished/state"))
      ++left;
    else
      seconds *= 1.2;
  }
  ASSERT_GT(left, 0) << "each was killed before its first chunk, or too late";
  if (exists("a.npz.unfinished/state"))
    expect_refused(record + "a.npz --checkpoint 0 --looks 8", {"a.npz.unfinished", "another recording"});
  const CliResult result = run(record + "a.npz --checkpoint 1000");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(read(path("a.npz")) == read(path("whole.npz")));
  EXPECT_FALSE(exists("a.npz.unfinished"));
}

// A scheduler stands in for Slurm: it runs each task of the array, and then what depends on it.
TEST_F(CliParts, AreWhatTheScriptForSlurmSubmits) {
  write("sbatch", R"(#!/bin/sh
cat > script
for argument; do case $argument in --array=1-*) count=${argument#--array=1-};; esac; done
case "$*" in *afterok:17*) sh script >&2; echo 18; exit;; esac
for task in $(seq "$count"); do
  SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_ID=$task SLURM_ARRAY_TASK_COUNT=$count sh script >&2 || exit 1
done
echo 17
)");
  std::filesystem::permissions(path("sbatch"), std::filesystem::perms::owner_all);
  const std::string options = "scene.json -o 'a b.exr' --quiet --tc-rays 2";
  ASSERT_EQ(run("render scene.json -o whole.exr --quiet --tc-rays 2").status, 0);
  const CliResult script = run("jobs slurm " + options + " --parts 3");
  ASSERT_EQ(script.status, 0) << script.err;
  write("submit.sh",
        "PATH=" + std::filesystem::path(KAIROS_CLI).parent_path().string() + ":.:$PATH\nexport PATH\n" + script.out);
  ASSERT_EQ(std::system(("cd '" + folder_.string() + "' && sh submit.sh > log 2>&1").c_str()), 0) << read(path("log"));
  expect_same("a b.exr", "whole.exr");
  EXPECT_NE(read(path("log")).find("wrote a b.exr from 3 parts"), std::string::npos);

  const CliResult other = run("jobs slurm --parts 2 events scene.json -o e.npz");
  EXPECT_NE(other.out.find("exec kairos events scene.json -o e.npz --part slurm"), std::string::npos) << other.out;
  const CliResult both = run("jobs slurm --parts 2 scene.json -o e.exr --time e.ktime --frame 2");
  EXPECT_NE(both.out.find("exec kairos merge e.exr e.ktime --clean"), std::string::npos) << both.out;
  const CliResult job = run("jobs openjd " + options + " --parts 3");
  for (const std::string text : {"range: \"1-3\"", "- \"a b.exr\"", "{{Task.Param.Part}}/3", "dependsOn: Render"})
    EXPECT_NE(job.out.find(text), std::string::npos) << job.out;
  const CliResult frames = run("jobs slurm --parts 2 scene.json --time e.ktime --frames 2-4");
  EXPECT_NE(frames.out.find("kairos merge e.ktime --clean\n"), std::string::npos) << "of many frames, one file";
  EXPECT_EQ(run("jobs slurm scene.json --parts 3").status, 2) << "writes nothing";
  EXPECT_EQ(run("jobs slurm " + options + " --parts 3 --part 1/2").status, 2);
  EXPECT_EQ(run("jobs make " + options + " --parts 3").status, 2);
}

}  // namespace
}  // namespace kairos
