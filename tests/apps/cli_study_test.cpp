// kairos study, from the scene to the page.
#include <algorithm>
#include <csignal>
#include <regex>

#include <nlohmann/json.hpp>

#include <kairos/compare.h>

#include "cli.h"
#include "image/read_exr.h"
#include "study/run_log.h"

namespace kairos {
namespace {

const std::string kSmall =
    "study scene.json -o out --size 32x20 --budgets 4,16 --tc-rays 1,2 --shading-samples 2,8 --seeds 2 --reference-spp "
    "64 "
    "--keys 0,3 ";

class CliStudy : public CliTest {
 protected:
  std::vector<study::Run> runs() const {
    std::istringstream text(read(path("out/runs.csv")));
    std::vector<study::Run> all;
    std::string line;
    std::getline(text, line);
    while (std::getline(text, line)) all.push_back(study::parse_run(line, "runs.csv"));
    return all;
  }
  /// What the page shows.
  nlohmann::json data() const {
    const std::string page = read(path("out/index.html")), begin = "id=\"data\">";
    const size_t from = page.find(begin) + begin.size();
    return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  }
};

TEST_F(CliStudy, MeasuresEverythingAndWritesThePage) {
  const CliResult result = run(kSmall + "--shading normal,flat");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "");
  // 3 samplers and auto x 2 budgets, tc x 2 x 2, mixed x 2; two shadings, two seeds
  EXPECT_EQ(runs().size(), (4u * 2 + 4 + 2) * 2 * 2);
  for (const study::Run& r : runs()) {
    EXPECT_GT(r.seconds, 0);
    EXPECT_GT(r.build_seconds, 0);
    EXPECT_GT(r.rays, 0u);
    EXPECT_GT(r.error.psnr, 5) << to_line(r);
  }
  const nlohmann::json page = data();
  ASSERT_EQ(page["entries"].size(), 2u);
  const nlohmann::json& entry = page["entries"][0];
  EXPECT_EQ(entry["name"], "scene-normal");
  EXPECT_EQ(entry["width"], 32);
  EXPECT_EQ(entry["moving_triangles"], 2);
  EXPECT_EQ(entry["series"].size(), 8u);
  EXPECT_GE(entry["pictures"]["list"].size(), 2u);
  EXPECT_NE(page["command"].get<std::string>().find("kairos study scene.json"), std::string::npos);
  for (const char* name : {"processor", "cores", "instruction set", "compiler", "version", "commit"})
    EXPECT_FALSE(page["machine"][name].is_null()) << name;
  for (const char* name : {"curves.csv", "comparisons.csv", "study.json", "pictures/scene-normal-reference.png",
                           "pictures/scene-flat-auto-16.png", "pictures/scene-flat-auto-16-error.png"})
    EXPECT_TRUE(exists(std::string("out/") + name)) << name;
  // Nothing is fetched from elsewhere.
  const std::string text = read(path("out/index.html"));
  EXPECT_FALSE(std::regex_search(text, std::regex(R"((src|href)\s*=\s*"?(https?:)?//|@import|fetch\()")));
}

TEST_F(CliStudy, ItsNumbersAreThoseOfRenderAndCompare) {
  ASSERT_EQ(run(kSmall + "--methods owen-sobol,tc").status, 0);
  ASSERT_EQ(run("render scene.json -o tc.exr --size 32x20 --integrator tc --tc-rays 2 --shading-samples 8 --seed 2 "
                "--shading normal --quiet")
                .status,
            0);
  const Image reference = read_exr(path("out/pictures/scene-normal-reference.exr"));
  const Difference expected = difference(reference, read_exr(path("tc.exr")), "tc.exr");
  const std::vector<study::Run> all = runs();
  const auto found = std::find_if(all.begin(), all.end(), [](const study::Run& r) {
    return r.setting == study::Setting{study::Method::tc, 0, 2, 8} && r.seed == 2;
  });
  ASSERT_NE(found, all.end());
  EXPECT_NEAR(found->error.psnr, expected.psnr, 1e-6);
  EXPECT_EQ(found->rays, 2u * 32 * 20);
  // The reference against a much better one.
  ASSERT_EQ(
      run("render scene.json -o fine.exr --size 32x20 --integrator qmc --spp 8192 --seed 9 --shading normal --quiet")
          .status,
      0);
  const double true_error = difference(read_exr(path("fine.exr")), reference, "reference").psnr;
  EXPECT_NEAR(data()["entries"][0]["reference_psnr"].get<double>(), true_error, 2) << "estimated by its halves";
}

TEST_F(CliStudy, RowsAreThoseOfTheWholeFrame) {
  ASSERT_EQ(run(kSmall + "--methods tc --rows 5").status, 0);
  EXPECT_EQ(data()["entries"][0]["width"], 32);
  EXPECT_EQ(data()["entries"][0]["height"], 5);
  for (const study::Run& r : runs())
    EXPECT_EQ(r.rays, static_cast<uint64_t>(r.setting.tc_rays) * 32 * 5) << "of these rows alone";
  const Image reference = read_exr(path("out/pictures/scene-normal-reference.exr"));
  // With the seed of the reference's first half; the same rows.
  ASSERT_EQ(
      run("render scene.json -o whole.exr --size 32x20 --integrator qmc --spp 4096 --seed 9 --shading normal --quiet")
          .status,
      0);
  const Image whole = read_exr(path("whole.exr"));
  ASSERT_EQ(reference.height, 5);
  double sum = 0;
  for (int row = 0; row < 5; ++row)
    for (int x = 0; x < 32; ++x) {
      const double got = reference.find("R")->values[static_cast<size_t>(row * 32 + x)];
      const double wanted = whole.find("R")->values[static_cast<size_t>((4 * row + 2) * 32 + x)];
      sum += (got - wanted) * (got - wanted);
    }
  EXPECT_LT(sum / (5 * 32), 1e-3) << "rows 2, 6, 10, 14 and 18";
  EXPECT_EQ(run(kSmall + "--methods tc --rows 20 --force").status, 0);
  EXPECT_EQ(data()["entries"][0]["height"], 20) << "all of them";
}

TEST_F(CliStudy, InterruptedItGoesOnWhereItStopped) {
  ASSERT_EQ(run(kSmall + "--quiet").status, 0);
  const std::string whole = read(path("out/runs.csv"));
  // As an interruption leaves it: the last lines missing, one of them half.
  const size_t cut = whole.size() * 2 / 3;
  write("out/runs.csv", whole.substr(0, cut));
  std::filesystem::remove(path("out/index.html"));
  const CliResult again = run(kSmall + "--quiet");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err, "");
  const size_t kept = whole.rfind('\n', cut) + 1;
  const std::string continued = read(path("out/runs.csv"));
  EXPECT_EQ(continued.substr(0, kept), whole.substr(0, kept)) << "what was measured is kept";
  EXPECT_EQ(runs().size(), static_cast<size_t>(std::count(whole.begin(), whole.end(), '\n')) - 1);
  EXPECT_TRUE(exists("out/index.html"));
  // The errors, if not the times, are the same as without an interruption.
  write("first.csv", whole);
  const std::vector<study::Run> all = runs();
  std::istringstream text(whole);
  std::string line;
  std::getline(text, line);
  for (const study::Run& r : all) {
    std::getline(text, line);
    const study::Run first = study::parse_run(line, "first.csv");
    EXPECT_EQ(first.error.mse, r.error.mse);
    EXPECT_EQ(first.setting, r.setting);
  }
}

TEST_F(CliStudy, CtrlCKeepsWhatIsDone) {
  // A shell that sends the signal once a few runs are in the log.
  write(
      "interrupt.sh",
      "\"$@\" --quiet 2> err.txt & pid=$!\n"
      "for i in $(seq 200); do [ \"$(wc -l < out/runs.csv 2>/dev/null || echo 0)\" -gt 5 ] && break; sleep 0.05; done\n"
      "kill -INT $pid; wait $pid; echo $? > status.txt\n");
  const std::string command =
      "cd '" + path("") +
      "' && bash -m interrupt.sh '" KAIROS_CLI
      "' study scene.json -o out --size 64x40 --seeds 900 --reference-spp 64 --methods owen-sobol,tc "
      "--keys 0 --budgets 4,8 --tc-rays 1 --shading-samples 2";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read(path("status.txt")), "1\n");
  EXPECT_EQ(read(path("err.txt")), "kairos: interrupted; the same command goes on from here\n");
  EXPECT_GT(runs().size(), 4u);
  EXPECT_FALSE(exists("out/index.html"));
}

TEST_F(CliStudy, ErrorsAreOneLine) {
  ASSERT_EQ(run(kSmall + "--quiet --methods owen-sobol").status, 0);
  const CliResult other = run(kSmall + "--quiet --methods owen-sobol,auto");
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(other.one_line_error()) << other.err;
  EXPECT_NE(other.err.find("--force"), std::string::npos);
  EXPECT_EQ(run(kSmall + "--quiet --methods auto --force").status, 0);
  EXPECT_EQ(runs().size(), 4u);
  EXPECT_TRUE(data()["entries"][0]["comparisons"].empty()) << "no baseline";
  const std::pair<const char*, int> bad[] = {{"--methods tc,nonsense", 2},
                                             {"--budgets 4,0", 2},
                                             {"--budgets 4,", 2},
                                             {"--shading normal,normal", 2},
                                             {"--keys 130", 2},
                                             {"--seeds 0", 2},
                                             {"--clock sun", 2}};
  for (const auto& [options, status] : bad) {
    const CliResult result = run(std::string("study scene.json -o bad ") + options);
    EXPECT_EQ(result.status, status) << options;
    EXPECT_TRUE(result.one_line_error()) << result.err;
    EXPECT_FALSE(exists("bad")) << options;
  }
  const CliResult missing = run("study nowhere.json -o bad2");
  EXPECT_EQ(missing.status, 1);
  EXPECT_TRUE(missing.one_line_error()) << missing.err;
  write("file", "");
  EXPECT_EQ(run("study scene.json -o file").status, 1);
}

}  // namespace
}  // namespace kairos
