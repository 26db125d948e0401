// kairos render: what it writes, and what it does not.
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/wait.h>

#include <kairos/version.h>

#include "cli.h"
#include "image/read_exr.h"

namespace kairos {
namespace {

class CliRender : public CliTest {
 protected:
  Image render(const std::string& options) const {
    const bool shading = options.find("--shading") != std::string::npos;
    const CliResult result =
        run("render scene.json -o out.exr --quiet " + options + (shading ? "" : " --shading normal"));
    EXPECT_EQ(result.status, 0) << options << "\n" << result.err;
    EXPECT_EQ(result.err, "") << "--quiet";
    EXPECT_EQ(result.out, "");
    return read_exr(path("out.exr"));
  }
};

template <class Value>
Value attribute(const Image& image, const std::string& name) {
  for (const Attribute& a : image.attributes)
    if (a.name == name) return std::get<Value>(a.value);
  throw std::runtime_error("no attribute " + name);
}

bool same_pixels(const Image& a, const Image& b) {
  for (const Channel& channel : a.channels)
    if (b.find(channel.name) == nullptr || b.find(channel.name)->values != channel.values) return false;
  return a.channels.size() == b.channels.size();
}

TEST_F(CliRender, TheHeaderSaysHowThePictureWasMade) {
  const Image tc = render(
      "--tc-rays 3 --shading-samples 2 --seed 12 --shading flat --filter gaussian --shutter 0,0.5 --frame 0 --fps 1");
  EXPECT_EQ(attribute<std::string>(tc, "kairos:version"), version());
  EXPECT_EQ(attribute<std::string>(tc, "kairos:integrator"), "tc");
  EXPECT_EQ(attribute<int>(tc, "kairos:samples"), 3);
  EXPECT_EQ(attribute<int>(tc, "kairos:shading_samples"), 2);
  EXPECT_EQ(attribute<std::string>(tc, "kairos:seed"), "12");
  EXPECT_EQ(attribute<std::string>(tc, "kairos:filter"), "gaussian");
  EXPECT_EQ((attribute<std::array<double, 2>>(tc, "kairos:shutter")), (std::array<double, 2>{0, 0.5}));
  EXPECT_GT(attribute<double>(tc, "kairos:render_seconds"), 0);
  const auto command_line = attribute<std::string>(tc, "kairos:command_line");
  EXPECT_EQ(command_line.rfind("kairos render scene.json -o out.exr --quiet --tc-rays 3", 0), 0u) << command_line;
  const Image qmc = render("--integrator qmc --spp 5 --sampler random --aov mesh");
  EXPECT_EQ(attribute<std::string>(qmc, "kairos:integrator"), "qmc");
  EXPECT_EQ(attribute<int>(qmc, "kairos:samples"), 5);
  EXPECT_EQ(attribute<std::string>(qmc, "kairos:sampler"), "random");
  EXPECT_EQ(attribute<std::vector<std::string>>(qmc, "kairos:mesh_names"),
            (std::vector<std::string>{"bar", "square \"x\""}));
}

TEST_F(CliRender, AovsAreLayers) {
  const Image image = render("--aov depth,normal,albedo,coverage,segments,mesh --half");
  for (const char* name : {"R", "G", "B", "depth.Z", "normal.X", "normal.Y", "normal.Z", "albedo.R", "albedo.G",
                           "albedo.B", "coverage.A", "segments.Y", "mesh.id"})
    EXPECT_NE(image.find(name), nullptr) << name;
  EXPECT_EQ(image.channels.size(), 13u);
  const size_t center = 10 * 32 + 16;
  EXPECT_EQ(image.find("mesh.id")->storage, Channel::Storage::integer);
  EXPECT_EQ(image.find("depth.Z")->storage, Channel::Storage::exact);
  EXPECT_EQ(image.find("R")->storage, Channel::Storage::colour);
  EXPECT_NEAR(image.find("depth.Z")->values[center], 2, 1e-5) << "the bar passes there";
  EXPECT_EQ(image.find("mesh.id")->values[center], 2) << "but the square is seen most";
  EXPECT_EQ(image.find("coverage.A")->values[center], 1);
}

TEST_F(CliRender, BitIdenticalForThreadsAndCrops) {
  for (const std::string integrator : {"tc --tc-rays 5", "qmc --spp 9"}) {
    const std::string options = "--aov depth,normal,mesh --filter gaussian --integrator " + integrator;
    const Image full = render(options + " --threads 1");
    EXPECT_TRUE(same_pixels(full, render(options + " --threads 2"))) << integrator;
    const Image crop = render(options + " --crop 5,21,3,17");
    EXPECT_EQ(crop.left, 5);
    EXPECT_EQ(crop.top, 3);
    EXPECT_EQ(crop.frame_width, 32);
    ASSERT_EQ(crop.width, 16);
    ASSERT_EQ(crop.height, 14);
    for (const Channel& channel : crop.channels)
      for (int y = 0; y < crop.height; ++y)
        EXPECT_EQ(std::memcmp(&channel.values[static_cast<size_t>(y * crop.width)],
                              &full.find(channel.name)->values[static_cast<size_t>((y + 3) * 32 + 5)],
                              sizeof(float) * static_cast<size_t>(crop.width)),
                  0)
            << channel.name << " row " << y;
  }
}

TEST_F(CliRender, StatsFileHoldsWhatTheContractSays) {
  for (const std::string integrator : {"tc", "qmc"}) {
    const CliResult result = run(
        "render scene.json -o a.png --threads 2 --tc-rays 4 --spp 4 --stats-file s.json --integrator " + integrator);
    ASSERT_EQ(result.status, 0) << result.err;
    const auto stats = nlohmann::json::parse(read(path("s.json")));
    for (const char* name : {"load_seconds", "build_seconds", "render_seconds"}) {
      EXPECT_GE(stats.at(name).get<double>(), 0) << name;
      EXPECT_LT(stats.at(name).get<double>(), 60) << name;
    }
    EXPECT_GT(stats.at("peak_memory_bytes").get<uint64_t>(), 1u << 20);
    EXPECT_EQ(stats.at("triangles"), 4);
    EXPECT_EQ(stats.at("bytes_per_triangle").at("geometry").get<double>() * 4, stats.at("geometry_memory_bytes"));
    EXPECT_EQ(stats.at("bytes_per_triangle").at("accel").get<double>() * 4, stats.at("accel_memory_bytes"));
    EXPECT_NEAR(stats.at("seconds_per_million_triangles").at("build").get<double>() * 4e-6,
                stats.at("build_seconds").get<double>(), 1e-9);
    EXPECT_NEAR(stats.at("file_seconds").get<double>() + stats.at("shot_seconds").get<double>(),
                stats.at("load_seconds").get<double>(), 1e-9);
    EXPECT_EQ(stats.at("rays"), 32 * 20 * 4);
    EXPECT_EQ(stats.at("threads"), 2);
    EXPECT_TRUE(stats.at("instruction_set").is_string());
    const auto& counters = stats.at("counters");
    EXPECT_GT(counters.at("segments_per_ray").get<double>(), 0);
    for (const char* name : {"nodes", "triangles_tested", "root_solves"})
      EXPECT_EQ(counters.at(name).is_number(), integrator == "tc") << name << ": Embree does not count";
    EXPECT_FALSE(result.err.empty()) << "a log, without --quiet";
  }
}

TEST_F(CliRender, InstructionSetsCanBeForced) {
  const CliResult result = run("render scene.json -o a.png --instruction-set scalar --stats-file s.json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(read(path("s.json"))).at("instruction_set"), "scalar");
  EXPECT_NE(result.err.find("scalar"), std::string::npos) << "the log names it";
}

// The bar is at the left when the shutter opens and at the right when it closes.
TEST_F(CliRender, AShutterOfNoLengthMakesAStillFrame) {
  for (const std::string integrator : {"tc", "qmc", "mixed", "auto"}) {
    const std::string options = "--shading flat --integrator " + integrator + " --spp 16 --fps 1 --frame 0 --shutter ";
    const Image open = render(options + "0,0"), close = render(options + "1,1");
    const auto green = [](const Image& image, int x) {  // more than there is of red: of the bar alone
      const auto pixel = static_cast<size_t>(10 * image.width + x);
      return image.find("G")->values[pixel] - image.find("R")->values[pixel];
    };
    EXPECT_NEAR(green(open, 8), 1, 1e-5) << integrator;  // the bar's pixel that is covered whole
    EXPECT_NEAR(green(close, 23), 1, 1e-5) << integrator;
    for (int x = 10; x < 22; ++x) {
      EXPECT_LE(green(open, x), 0) << integrator << " " << x;
      EXPECT_LE(green(close, x), 0) << integrator << " " << x;
    }
    EXPECT_EQ((attribute<std::array<double, 2>>(close, "kairos:shutter")), (std::array<double, 2>{1, 1}));
  }
}

TEST_F(CliRender, ProgressWithoutATerminalIsPlainLines) {
  const CliResult result = run("render scene.json -o a.png --tc-rays 2000");
  ASSERT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("\n100 %"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find('\r'), std::string::npos);
  EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
}

TEST_F(CliRender, ProgressForOpenJobDescriptionIsOnStandardOutput) {
  const std::string shot = "render scene.json -o p%d.png --tc-rays 100 --fps 8 --quiet --progress openjd ";
  const CliResult result = run(shot + "--frames 0-2");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  std::istringstream lines(result.out);
  double last = -1;
  for (std::string line; std::getline(lines, line);) {
    ASSERT_EQ(line.rfind("openjd_progress: ", 0), 0u) << line;
    const double percent = std::stod(line.substr(line.find(' ')));
    EXPECT_GT(percent, last) << "of all frames";
    last = percent;
  }
  EXPECT_EQ(last, 100);
  const CliResult failed = run("render absent.json -o a.png --progress openjd");
  EXPECT_EQ(failed.status, 1);
  EXPECT_EQ("kairos: " + failed.out.substr(failed.out.find(' ') + 1), failed.err);
  EXPECT_EQ(failed.out.rfind("openjd_fail: absent.json", 0), 0u) << failed.out;
}

TEST_F(CliRender, ThreadsAreThoseThatTheProcessMayRunOn) {
  const CliResult result = run("render scene.json -o a.png", "taskset -c 0 ");
  EXPECT_NE(result.err.find(" on 1 threads"), std::string::npos) << result.err;
}

struct Interruption {
  const char* scene;
  int signal, milliseconds;  // when it comes
};
void PrintTo(const Interruption& i, std::ostream* out) { *out << i.scene << "_" << i.signal << "_" << i.milliseconds; }

class Interrupted : public CliRender, public testing::WithParamInterface<Interruption> {};

// Starts a render of hours, waits a bit, sends a signal.
TEST_P(Interrupted, EndsAtOnceAndLeavesNothing) {
  write("slow.pbrt", R"(Camera "perspective" WorldBegin Shape "loopsubdiv" "integer levels" 10
      "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2])");  // takes seconds: interrupted while loading
  write("log.txt", "");
  const size_t before = files();
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0) _exit(99);
    dup2(open("log.txt", O_WRONLY), STDERR_FILENO);
    execl(KAIROS_CLI, "kairos", "render", GetParam().scene, "-o", "a.exr", "--tc-rays", "1000000", "--stats-file",
          "s.json", "--quiet", nullptr);
    _exit(98);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(GetParam().milliseconds));
  kill(child, GetParam().signal);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), GetParam().signal == SIGTERM ? 75 : 1);
  EXPECT_EQ(read(path("log.txt")), "kairos: interrupted\n");
  EXPECT_EQ(files(), before);
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupted,
                         testing::Values(Interruption{"scene.json", SIGINT, 400},
                                         Interruption{"scene.json", SIGTERM, 400},
                                         Interruption{"slow.pbrt", SIGINT, 300}));

}  // namespace
}  // namespace kairos
