// Events as simulators make them that know frames alone: the yardstick of kairos events. docs/events.md, "Against
// frames".
//
// Frames of one instant each, at a fixed rate or as often as the fastest thing of the picture asks for (as ESIM has it:
// H. Rebecq, D. Gehrig, D. Scaramuzza 2018), by discrete rays at the same points in all of them, so that sampling
// makes no events. What finding the fastest thing takes is not counted, either. Between two frames the logarithm is
// taken to run straight (as ESIM has it), or events are dealt out to even parts of the time between them (as v2e has
// it). What building trees for each frame takes is not counted.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <kairos/error.h>
#include <kairos/event_file.h>
#include <kairos/flow.h>
#include <kairos/names.h>
#include <kairos/render.h>

namespace {

struct Arguments {
  std::string scene, out, rule = "esim";
  int width = 346, height = 260, samples = 4;
  double from = 0, to = 1, fps = 1000;
  double adaptive = 0;  // pixels that the fastest thing goes from frame to frame; 0: fps frames a second
  kairos::ShadingKind shading = kairos::ShadingKind::flat;
};

kairos::ShotOptions shot_options(const Arguments& arguments, double open, double close) {
  kairos::ShotOptions options;
  options.frame = 0;
  options.fps = 1;
  options.shutter = std::array<double, 2>{open, close};
  options.width = arguments.width;
  options.height = arguments.height;
  options.lights =
      arguments.shading == kairos::ShadingKind::flat ? kairos::LightChoice::file : kairos::LightChoice::automatic;
  return options;
}

/// Seconds until the next frame.
double step(const kairos::Scene& scene, const Arguments& arguments, double time) {
  if (arguments.adaptive == 0) return 1 / arguments.fps;
  constexpr double kProbe = 1e-3, kLeastRate = 30;
  const kairos::Image moved = kairos::flow(kairos::make_shot(scene, shot_options(arguments, time, time + kProbe)), {});
  const auto &u = moved.find("flow.u")->values, &v = moved.find("flow.v")->values;
  double most = 0;
  for (size_t i = 0; i < u.size(); ++i) {
    const double length = std::hypot(static_cast<double>(u[i]), static_cast<double>(v[i]));
    if (std::isfinite(length)) most = std::max(most, length);
  }
  return std::min(arguments.adaptive * kProbe / std::max(most, 1e-9), 1 / kLeastRate);
}

constexpr double kThreshold = 0.2, kDark = 1.0 / 255;

/// What each pixel shows, as a logarithm.
std::vector<double> frame(const kairos::Scene& scene, const Arguments& arguments, double time, double& seconds) {
  const kairos::Shot shot = kairos::make_shot(scene, shot_options(arguments, time, time));
  kairos::RenderParams params;
  params.integrator = kairos::IntegratorKind::qmc;
  params.shading = arguments.shading;
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
  int frames = 0;
  double last = 0, length = arguments.to - arguments.from;
  for (double next = 0; last < length - 1e-9; last = next) {
    next = std::min(last + step(*scene, arguments, arguments.from + last), length);
    ++frames;
    const std::vector<double> now = frame(*scene, arguments, arguments.from + next, seconds);
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
        const double time = last + std::clamp(place, 0.0, 1.0) * (next - last);
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
  std::printf("%.3f %d\n", seconds, frames);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Events of frames; prints the processor time of rendering them, and how many there were");
  app.add_option("SCENE", arguments.scene)->required();
  app.add_option("-o", arguments.out)->required();
  app.add_option("--width", arguments.width);
  app.add_option("--height", arguments.height);
  app.add_option("--fps", arguments.fps);
  app.add_option("--adaptive", arguments.adaptive);
  app.add_option_function<std::string>("--shading", [&](const std::string& name) {
    arguments.shading = kairos::parse<kairos::ShadingKind>(name).value_or(kairos::ShadingKind::flat);
  });
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
