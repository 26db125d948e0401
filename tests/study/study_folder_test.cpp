// A study survives interruption, and knows whose results it goes on with.
#include "study/study_folder.h"

#include <filesystem>

#include <gtest/gtest.h>

#include <kairos/error.h>

#include "error_matchers.h"
#include "temp_folder.h"

namespace kairos::study {
namespace {

Run some_run(int seed) {
  Run run;
  run.entry = {"scene", ShadingKind::whitted};
  run.setting = {Method::mixed, 16, 4, 0};
  run.seed = seed;
  run.seconds = 0.0625;
  run.wall_seconds = 0.125;
  run.cpu_seconds = 0.25;
  run.build_seconds = 1.5;
  run.error = {0.001, 30, 0.02};
  run.rays = 1ull << 40;
  run.segments = 2;
  run.shaded = 3;
  run.nodes = 4;
  run.triangles = 5;
  run.root_solves = 6;
  return run;
}

class StudyFolderTest : public testing::Test {
 protected:
  StudyFolderTest() {
    options_.scenes = {files_.write("scene.obj", "v 0 0 0\n")};
    options_.folder = files_.path("study");
  }
  std::string log() const { return (std::filesystem::path(options_.folder) / "runs.csv").string(); }

  TempFolder files_;
  StudyOptions options_;
};

TEST_F(StudyFolderTest, WhatIsAddedIsFoundAgain) {
  {
    StudyFolder folder(options_);
    folder.add(some_run(1));
    folder.add(some_run(2));
    ReferenceRun reference{{"scene", ShadingKind::whitted}, 512, {1e-6, 60, 2e-5}, 2.5};
    folder.add(reference);
    folder.add(SceneFacts{"scene", 480, 270, 1ull << 33, 7, 5});
  }
  const StudyFolder folder(options_);
  const auto expected = some_run(2);
  EXPECT_EQ(folder.runs().size(), 2u);
  const auto* run = folder.find(expected.entry, expected.setting, 2);
  ASSERT_NE(run, nullptr);
  EXPECT_EQ(to_line(*run), to_line(expected));
  EXPECT_EQ(folder.find(expected.entry, expected.setting, 3), nullptr);
  EXPECT_EQ(folder.find({"scene", ShadingKind::normal}, expected.setting, 2), nullptr);
  EXPECT_EQ(folder.find(expected.entry, {Method::mixed, 16, 8, 0}, 2), nullptr);
  ASSERT_NE(folder.find_reference(expected.entry), nullptr);
  EXPECT_EQ(folder.find_reference(expected.entry)->spp, 512);
  ASSERT_NE(folder.find_scene("scene"), nullptr);
  EXPECT_EQ(folder.find_scene("scene")->triangles, 1ull << 33);
  EXPECT_EQ(folder.find_scene("scene")->keys, 5);
}

TEST_F(StudyFolderTest, AnUnfinishedLineIsCutOff) {
  StudyFolder(options_).add(some_run(1));
  const auto whole = std::filesystem::file_size(log());
  StudyFolder(options_).add(some_run(2));
  for (auto size = std::filesystem::file_size(log()) - 1; size > whole; size -= 7) {
    std::filesystem::resize_file(log(), size);
    EXPECT_EQ(StudyFolder(options_).runs().size(), 1u) << size << " bytes";
    EXPECT_EQ(std::filesystem::file_size(log()), whole);
    StudyFolder(options_).add(some_run(2));
    EXPECT_EQ(StudyFolder(options_).runs().size(), 2u);
  }
  std::filesystem::resize_file(log(), 10);  // in the header
  EXPECT_EQ(StudyFolder(options_).runs().size(), 0u);
}

TEST_F(StudyFolderTest, ALineThatIsNoneIsRefused) {
  const std::string line = to_line(some_run(1));
  for (const std::string& bad : {std::string("nonsense"), line + ",1", line.substr(0, line.rfind(',')), "," + line,
                                 line.substr(0, line.size() - 1) + "x"})
    EXPECT_THROW(parse_run(bad, "runs.csv"), Error) << bad;
  auto exact = some_run(1);
  exact.error = {0, std::numeric_limits<double>::infinity(), 0};
  EXPECT_EQ(to_line(parse_run(to_line(exact), "runs.csv")), to_line(exact)) << "equal pictures";
  files_.write("study/runs.csv", "another,header\n");
  EXPECT_THROW(StudyFolder{options_}, Error);
}

TEST_F(StudyFolderTest, OtherParametersAreRefusedAndForceStartsAnew) {
  StudyFolder(options_).add(some_run(1));
  const auto refused = [&](StudyOptions other) {
    try {
      const StudyFolder folder(other);
      return std::string();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::bad_usage);
      return std::string(e.what());
    }
  };
  EXPECT_EQ(refused(options_), "");
  StudyOptions other = options_;
  other.seeds = 7;
  EXPECT_NE(refused(other).find("seeds: 5 there, 7 here"), std::string::npos) << refused(other);
  for (const auto& change : std::initializer_list<std::function<void(StudyOptions&)>>{
           [](StudyOptions& o) { o.shot.frame = 3; }, [](StudyOptions& o) { o.shot.width = 100; },
           [](StudyOptions& o) { o.shadings = {ShadingKind::whitted}; }, [](StudyOptions& o) { o.budgets = {4}; },
           [](StudyOptions& o) { o.tc_rays = {4}; }, [](StudyOptions& o) { o.shading_samples = {4}; },
           [](StudyOptions& o) { o.methods.pop_back(); }, [](StudyOptions& o) { o.keys = {3}; },
           [](StudyOptions& o) { o.threads = 2; }, [](StudyOptions& o) { o.reference_spp = 99; },
           [](StudyOptions& o) { o.clock = Clock::wall; },
           [](StudyOptions& o) {
             o.shot.shutter = {0, 0.25};
           }}) {
    StudyOptions changed = options_;
    change(changed);
    EXPECT_NE(refused(changed), "");
  }
  files_.write("scene.obj", "v 0 0 1\n");
  EXPECT_NE(refused(options_).find("scenes"), std::string::npos) << "the scene is another";

  other.force = true;
  EXPECT_TRUE(StudyFolder(other).runs().empty());
  other.force = false;
  EXPECT_EQ(refused(other), "");
}

TEST(StudyScenes, NamesAreUniqueAndPlain) {
  EXPECT_EQ(scene_names({"a/fan.gltf", "b/fan.obj", "kitchen/scene.pbrt", "x,y\n.obj", "fan-2.obj"}),
            (std::vector<std::string>{"fan", "fan-2", "kitchen", "x-y-", "fan-2-2"}));
}

}  // namespace
}  // namespace kairos::study
