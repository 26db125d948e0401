// Events as simulators make them that know frames alone: the yardstick of kairos events. docs/events.md, "Against
// frames".
//
// Frames of one instant each, at a fixed rate, by discrete rays at the same points in all of them, so that sampling
// makes no events. Between two frames the logarithm is taken to run straight (as ESIM has it), or events are dealt out
// to even parts of the time between them (as v2e has it). What building trees for each frame takes is not counted.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <kairos/error.h>
#include <kairos/event_file.h>
#include <kairos/render.h>

namespace {

struct Arguments {
  std::string scene, out, rule = "esim";
  int width = 346, height = 260, fps = 1000, samples = 4;
  double from = 0, to = 1;
};

constexpr double kThreshold = 0.2, kDark = 1.0 / 255;

/// What each pixel shows, as a logarithm.
std::vector<double> frame(const kairos::Scene& scene, const Arguments& arguments, double time, double& seconds) {
  kairos::ShotOptions options;
  options.frame = 0;
  options.fps = 1;
  options.shutter = std::array<double, 2>{time, time};
  options.width = arguments.width;
  options.height = arguments.height;
  const kairos::Shot shot = kairos::make_shot(scene, options);
  kairos::RenderParams params;
  params.integrator = kairos::IntegratorKind::qmc;
  params.shading = kairos::ShadingKind::flat;
  params.spp = arguments.samples;
  params.threads = 1;
  kairos::RenderStats stats;
  const kairos::Image image = kairos::render(shot, params, &stats);
  seconds += stats.render_cpu_seconds;
  const auto& red = image.find("R")->values;
  const auto& green = image.find("G")->values;
  const auto& blue = image.find("B")->values;
  std::vector<double> result(red.size());
  for (size_t i = 0; i < red.size(); ++i)
    result[i] = std::log(0.2126 * static_cast<double>(red[i]) + 0.7152 * static_cast<double>(green[i]) +
                         0.0722 * static_cast<double>(blue[i]) + kDark);
  return result;
}

void run(const Arguments& arguments) {
  const auto scene = kairos::load_scene({arguments.scene});
  kairos::EventFileOptions file;
  file.time = kairos::EventFileOptions::Time::nanoseconds;
  kairos::EventFileWriter writer(arguments.out, arguments.width, arguments.height, file);
  double seconds = 0;
  std::vector<double> before = frame(*scene, arguments, arguments.from, seconds), level = before;
  const auto frames = static_cast<int>(std::floor((arguments.to - arguments.from) * arguments.fps + 1e-9));
  for (int n = 1; n <= frames; ++n) {
    const std::vector<double> now =
        frame(*scene, arguments, arguments.from + static_cast<double>(n) / arguments.fps, seconds);
    std::vector<kairos::Event> events;
    int most = 0;
    for (size_t i = 0; i < now.size(); ++i)
      most = std::max(most, static_cast<int>(std::floor(std::abs(now[i] - level[i]) / kThreshold)));
    for (size_t i = 0; i < now.size(); ++i) {
      const int polarity = now[i] > level[i] ? 1 : -1,
                count = static_cast<int>(std::floor(std::abs(now[i] - level[i]) / kThreshold));
      for (int k = 1; k <= count; ++k) {
        const double change = now[i] - before[i];
        const double place = arguments.rule == "v2e" ? static_cast<double>(k) / most
                             : change == 0           ? 0
                                                     : (level[i] + polarity * k * kThreshold - before[i]) / change;
        const double time = (n - 1 + std::clamp(place, 0.0, 1.0)) / arguments.fps;
        events.push_back({static_cast<int64_t>(time * 1e9),
                          static_cast<uint16_t>(i % static_cast<size_t>(arguments.width)),
                          static_cast<uint16_t>(i / static_cast<size_t>(arguments.width)),
                          static_cast<int8_t>(polarity), kairos::EventKind::signal});
      }
      level[i] += polarity * count * kThreshold;
    }
    std::sort(events.begin(), events.end());
    writer.add(events);
    before = now;
  }
  writer.finish();
  std::printf("%.3f\n", seconds);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Events of frames; prints the processor time of rendering them");
  app.add_option("SCENE", arguments.scene)->required();
  app.add_option("-o", arguments.out)->required();
  app.add_option("--width", arguments.width);
  app.add_option("--height", arguments.height);
  app.add_option("--fps", arguments.fps);
  app.add_option("--samples", arguments.samples);
  app.add_option("--rule", arguments.rule)->check(CLI::IsMember({"esim", "v2e"}));
  app.add_option("--from", arguments.from);
  app.add_option("--to", arguments.to);
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const kairos::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
