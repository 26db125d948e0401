// What a time-continuous ray costs beside a discrete one: the same camera rays through both, one thread, interleaved.
//
// usage: bench_rays SCENE... [--size WxH] [--rays N] [--rounds N] [--instruction-set NAME] [--shutter OPEN,CLOSE]
//                   [--threads N] [--builds N]
//
// Prints build times (by --threads threads, the median of --builds) and bytes of both accelerators, then for every
// round the time per ray of each, the median of the ratio, and the counters of a time-continuous ray. The sampler and
// shading are left out.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <random>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "base/parallel.h"
#include "discrete/discrete_scene.h"

namespace kairos {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Jittered rays in tiles, as an integrator would trace them; only so many tiles, spread over the image, as give about
/// `wanted` rays.
std::vector<Ray> camera_rays(const Projection& projection, int rays_per_pixel, size_t wanted) {
  constexpr int kTile = 16;
  const int columns = (projection.width + kTile - 1) / kTile, rows = (projection.height + kTile - 1) / kTile;
  const size_t tiles = static_cast<size_t>(columns) * static_cast<size_t>(rows);
  const size_t rays_per_tile = static_cast<size_t>(kTile * kTile * rays_per_pixel);
  const double stride = std::max(1.0, static_cast<double>(tiles * rays_per_tile) / static_cast<double>(wanted));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double half = std::tan(projection.vfov / 2);
  std::vector<Ray> rays;
  for (double place = 0; place < static_cast<double>(tiles); place += stride) {
    const int tile = static_cast<int>(place), x0 = tile % columns * kTile, y0 = tile / columns * kTile;
    for (int y = y0; y < std::min(y0 + kTile, projection.height); ++y)
      for (int x = x0; x < std::min(x0 + kTile, projection.width); ++x)
        for (int i = 0; i < rays_per_pixel; ++i) {
          const double px = (x + uniform(random)) / projection.width * 2 - 1;
          const double py = 1 - (y + uniform(random)) / projection.height * 2;
          const double aspect = static_cast<double>(projection.width) / projection.height;
          rays.push_back({{0, 0, 0}, to_float(Vec3d{px * half * aspect, py * half, -1})});
        }
  }
  return rays;
}

/// Of all threads: on a busy machine the better measure of what a build costs.
double processor_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct BuildTimes {
  std::vector<double> seconds, processor_seconds;

  template <class Build>
  void measure(const Build& build) {
    const auto start = Clock::now();
    const double processor_start = processor_time();
    build();
    seconds.push_back(seconds_since(start));
    processor_seconds.push_back(processor_time() - processor_start);
  }
};

int run(int argc, char** argv) {
  CLI::App app("What a time-continuous ray costs beside a discrete one");
  std::vector<std::string> scenes;
  std::string size = "960x540", instruction_set, shutter;
  std::vector<int> rays_per_pixel{1, 4, 16};
  size_t wanted = 200000;
  int rounds = 5;
  bool discrete_wanted = true;
  int build_threads = 1, builds = 1;
  app.add_option("scene", scenes)->required();
  app.add_option("--size", size);
  app.add_option("--rays-per-pixel", rays_per_pixel)->delimiter(',');
  app.add_option("--rays", wanted);
  app.add_option("--rounds", rounds);
  app.add_option("--instruction-set", instruction_set);
  app.add_option("--shutter", shutter);
  app.add_option("--threads", build_threads, "For building; rays are traced by one thread");
  app.add_option("--builds", builds, "Build so often, alternating, and print the median");
  bool single = false;
  app.add_flag("--single", single, "No packets");
  app.add_flag("!--tc-only", discrete_wanted);
  CLI11_PARSE(app, argc, argv);

  const auto scene = load_scene(scenes);
  ShotOptions shot_options;
  if (std::sscanf(size.c_str(), "%dx%d", &shot_options.width, &shot_options.height) != 2)
    throw Error(ErrorCode::bad_usage, "--size", "give it as WIDTHxHEIGHT");
  double open = 0, close = 0;
  if (!shutter.empty()) {
    if (std::sscanf(shutter.c_str(), "%lf,%lf", &open, &close) != 2)
      throw Error(ErrorCode::bad_usage, "--shutter", "give it as OPEN,CLOSE");
    shot_options.shutter = {open, close};
  }
  const Shot shot = make_shot(*scene, shot_options);
  for (const std::string& note : shot.notes) fmt::print("{}\n", note);
  size_t triangles = 0;
  for (const Mesh& mesh : shot.meshes) triangles += mesh.triangles.size();

  TracerOptions options;
  options.precision = Precision::fast;
  if (!instruction_set.empty()) options.instruction_set = parse_instruction_set(instruction_set);
  std::optional<Tracer> built_tracer;
  std::optional<DiscreteScene> built_discrete;
  BuildTimes tracer_builds, discrete_builds;
  std::optional<ThreadLimit> limit(build_threads);
  for (int build = 0; build < std::max(1, builds); ++build) {
    built_tracer.reset();
    tracer_builds.measure([&] { built_tracer.emplace(shot.meshes, options); });
    built_discrete.reset();
    discrete_builds.measure([&] {
      built_discrete.emplace(discrete_wanted ? std::span<const Mesh>(shot.meshes) : std::span<const Mesh>());
    });
  }
  const Tracer& tracer = *built_tracer;
  const DiscreteScene& discrete = *built_discrete;
  fmt::print("{} triangles, {}; threads for building: {}\n", triangles, to_string(tracer.instruction_set()),
             build_threads);
  fmt::print("build: tc {:.2f} s, discrete {:.2f} s, ratio {:.2f}\n", median(tracer_builds.seconds),
             median(discrete_builds.seconds), median(tracer_builds.seconds) / median(discrete_builds.seconds));
  fmt::print("processor time: tc {:.2f} s, discrete {:.2f} s, ratio {:.2f}\n", median(tracer_builds.processor_seconds),
             median(discrete_builds.processor_seconds),
             median(tracer_builds.processor_seconds) / median(discrete_builds.processor_seconds));
  limit.emplace(1);
  const double count = static_cast<double>(std::max<size_t>(1, triangles));
  fmt::print("bytes per triangle: tc {:.0f}, discrete {:.0f}\n", static_cast<double>(tracer.memory_bytes()) / count,
             static_cast<double>(discrete.memory_bytes()) / count);

  for (const int n : rays_per_pixel) {
    const std::vector<Ray> rays = camera_rays(shot.projection, n, wanted);
    std::vector<float> times;
    std::mt19937 random(2);
    for (size_t i = 0; i < rays.size(); ++i) times.push_back(std::uniform_real_distribution<float>(0, 1)(random));
    std::vector<std::optional<DiscreteHit>> hits(rays.size());
    std::vector<double> tc_times, discrete_times, ratios;
    const double per_ray = 1e9 / static_cast<double>(rays.size());
    TraceCounters counters;
    for (int round = 0; round < rounds; ++round) {
      Tracer::Workspace workspace;
      Clock::time_point start;
      const auto trace_all = [&] {
        start = Clock::now();
        // Rays of one pixel go together, as an integrator would trace them.
        const size_t most = std::min(Tracer::kMaxPacket, static_cast<size_t>(single ? 1 : n));
        for (size_t i = 0; i < rays.size(); i += most)
          if (most > 1)
            tracer.trace_packet(std::span(rays).subspan(i, std::min(most, rays.size() - i)), Visibility::visible,
                                workspace);
          else
            tracer.trace(rays[i], Visibility::visible, workspace);
        tc_times.push_back(seconds_since(start) * per_ray);
      };
      const auto intersect_all = [&] {
        start = Clock::now();
        discrete.intersect(rays, times, hits);
        discrete_times.push_back(seconds_since(start) * per_ray);
      };
      if (round % 2 == 0) {
        trace_all();
        intersect_all();
      } else {
        intersect_all();
        trace_all();
      }
      ratios.push_back(tc_times.back() / discrete_times.back());
      counters = workspace.counters();
    }
    const double traced = static_cast<double>(counters.rays);
    const auto mean = [&](uint64_t value) { return static_cast<double>(value) / traced; };
    fmt::print(
        "{:2} rays/pixel: tc {:.0f} ns, discrete {:.0f} ns, ratio {:.2f} ({:.2f} to {:.2f}); per tc ray: {:.1f} nodes, "
        "{:.1f} triangles, {:.1f} root solves, {:.1f} hits, {:.2f} segments\n",
        n, median(tc_times), median(discrete_times), median(ratios), *std::min_element(ratios.begin(), ratios.end()),
        *std::max_element(ratios.begin(), ratios.end()), mean(counters.nodes), mean(counters.triangles),
        mean(counters.root_solves), mean(counters.hits), mean(counters.segments));
  }
  return 0;
}

}  // namespace
}  // namespace kairos

int main(int argc, char** argv) {
  try {
    return kairos::run(argc, argv);
  } catch (const kairos::Error& error) {
    fmt::print(stderr, "bench_rays: {}\n", error.what());
    return 1;
  }
}
