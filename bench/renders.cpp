// What rays cost with everything that a picture needs, where that time goes, and what a second thread brings.
//
// usage: bench_renders SCENE... [options below] [--csv FILE]
//
// Rendered are some bands of rows, spread over the picture. Measures, for the CSV file, on one thread, in processor
// time, interleaved: for each number of time-continuous rays per pixel tc_ns per ray, and tc_rays_ns and tc_trace_ns,
// what is left of it without tracing and shading, and without shading; discrete_ns, discrete_rays_ns and
// discrete_trace_ns, the same of discrete rays (rays: their number per pixel). Shading is that with normals.
// Then, in wall clock, with one and with two threads: render_tc_1_s, render_tc_2_s, render_discrete_1_s,
// render_discrete_2_s, build_tc_1_s, build_tc_2_s, build_discrete_1_s, build_discrete_2_s.
#include <algorithm>
#include <cmath>
#include <optional>

#include <CLI/CLI.hpp>

#include <kairos/render.h>

#include "base/parallel.h"
#include "discrete/discrete_scene.h"
#include "integrators/integrator.h"
#include "measuring.h"
#include "policy/packet_choice.h"
#include "reported_run.h"
#include "shot_choice.h"
#include "study/measure.h"
#include "study/statistics.h"

namespace kairos::bench {
namespace {

struct Options {
  std::vector<int> tc_rays{1, 4, 16}, keys{0, 3, 5, 9};
  int spp = 16, bands = 6, band_height = 1, rounds = 3, thread_rounds = 3, build_rounds = 3;
  std::string csv;
};

void print(const std::string& text) { fmt::print(stderr, "{}\n", text); }

/// Rows of pixels, over the picture's whole width.
std::vector<Crop> bands_of(const Projection& projection, int count, int height) {
  std::vector<Crop> bands;
  for (int i = 0; i < count; ++i) {
    const int middle = projection.height * (2 * i + 1) / (2 * count);
    const int top = std::clamp(middle - height / 2, 0, std::max(0, projection.height - height));
    bands.push_back({0, projection.width, top, std::min(projection.height, top + height)});
  }
  return bands;
}

class Bench {
 public:
  Bench(const Shot& shot, const Options& options, Rows& rows)
      : shot_(shot),
        options_(options),
        rows_(rows),
        renderer_(shot),
        parts_(shot),
        bands_(bands_of(shot.projection, options.bands, options.band_height)),
        high_bands_(bands_of(shot.projection, options.bands, kHigher * options.band_height)) {
    for (const Crop& band : bands_) pixels_ += static_cast<double>((band.x1 - band.x0) * (band.y1 - band.y0));
    const bool moves =
        std::any_of(shot.meshes.begin(), shot.meshes.end(), [](const Mesh& m) { return !m.is_static(); });
    study::Conditions conditions;
    conditions.parts = {high_bands_[bands_.size() / 2]};
    keys_ = moves ? study::time_keys(renderer_, conditions, options.keys, {}).front().keys : options.keys.front();
    rows_.add("best_keys", keys_);
  }

  /// Interleaved: every number of time-continuous rays and the discrete ones, whole and in parts.
  void measure_parts() {
    struct Case {
      std::string name;
      IntegratorKind kind;
      int rays;
      double per_ray;
    };
    std::vector<Case> cases;
    std::vector<Measurement> measurements;
    const auto add = [&](IntegratorKind kind, int rays) {
      const std::string name = kind == IntegratorKind::tc ? "tc_" : "discrete_";
      const double per_ray = 1e9 / (pixels_ * rays);
      for (const char* part : {"rays_ns", "trace_ns", "ns"}) cases.push_back({name + part, kind, rays, per_ray});
      measurements.push_back([this, kind, rays] { return loop(kind, rays, false); });
      measurements.push_back([this, kind, rays] { return loop(kind, rays, true); });
      measurements.push_back([this, kind, rays] { return render_bands(bands_, kind, rays, 1).cpu; });
    };
    for (const int rays : options_.tc_rays) add(IntegratorKind::tc, rays);
    add(IntegratorKind::qmc, options_.spp);
    for (const Measurement& measurement : measurements) measurement();  // warms up
    const auto times = interleave(options_.rounds, measurements);
    for (size_t i = 0; i < cases.size(); ++i) {
      rows_.add(cases[i].name, cases[i].rays, times[i], cases[i].per_ray);
      print(fmt::format("{} {:2}: {:.0f}", cases[i].name, cases[i].rays, study::median(times[i]) * cases[i].per_ray));
    }
  }

  void measure_threads() {
    const int rays = options_.tc_rays[options_.tc_rays.size() / 2];
    const auto renders = [&](IntegratorKind kind, int count, int threads) {
      return [this, kind, count, threads] { return render_bands(high_bands_, kind, count, threads).wall; };
    };
    both("render_tc", options_.thread_rounds, rays, renders(IntegratorKind::tc, rays, 1),
         renders(IntegratorKind::tc, rays, 2));
    both("render_discrete", options_.thread_rounds, 4 * rays, renders(IntegratorKind::qmc, 4 * rays, 1),
         renders(IntegratorKind::qmc, 4 * rays, 2));
    const auto builds = [&](bool tc, int threads) {
      return [this, tc, threads] {
        return seconds_of(wall_seconds, [&] {
          TracerOptions options;
          options.precision = Precision::fast;
          with_threads(threads, [&] {
            if (tc)
              const Tracer tracer(shot_.meshes, options);
            else
              const DiscreteScene discrete(shot_.meshes);
          });
        });
      };
    };
    both("build_tc", options_.build_rounds, 0, builds(true, 1), builds(true, 2));
    both("build_discrete", options_.build_rounds, 0, builds(false, 1), builds(false, 2));
  }

 private:
  struct Seconds {
    double wall = 0, cpu = 0;
  };

  void both(const std::string& name, int rounds, int rays, const Measurement& one, const Measurement& two) {
    if (rounds == 0) return;
    const auto times = interleave(rounds, {one, two});
    rows_.add(name + "_1_s", rays, times[0]);
    rows_.add(name + "_2_s", rays, times[1]);
    print(fmt::format("{}: one thread {:.2f} s, two {:.2f} s", name, study::median(times[0]), study::median(times[1])));
  }

  Seconds render_bands(const std::vector<Crop>& bands, IntegratorKind kind, int rays, int threads) {
    RenderParams params;
    params.integrator = kind;
    params.tc_rays = params.spp = rays;
    params.filter = FilterKind::box;
    params.discrete_keys = keys_;
    params.threads = threads;
    Seconds seconds;
    for (const Crop& band : bands) {
      params.crop = band;
      RenderStats stats;
      renderer_.render(params, &stats);
      seconds.wall += stats.render_seconds;
      seconds.cpu += stats.render_cpu_seconds;
    }
    return seconds;
  }

  /// What an integrator does but for shading and adding up; `trace`: or not even tracing.
  double loop(IntegratorKind kind, int count, bool trace) {
    const PixelContext context{CameraRays(shot_.projection),
                               Sampler(SamplerKind::owen_sobol, static_cast<uint32_t>(count), 0),
                               PixelFilter(FilterKind::box), parts_.shader(ShadingKind::normal, false, 0, 0)};
    const bool tc = kind == IntegratorKind::tc;
    const Tracer& tracer = parts_.tracer({});
    const DiscreteScene& discrete = parts_.discrete(keys_);
    const size_t most = tc ? Tracer::kMaxPacket : kRaysPerPoll;
    const PacketChoice packets = tc ? choose_packets(context, shot_.projection, tracer) : PacketChoice();
    const int strip = tc ? packets.strip(context.sampler.count()) : 1;
    const bool together = strip > 1 || packets.together(context.sampler.count());
    std::vector<Ray> rays;
    std::vector<float> times;
    std::vector<std::optional<DiscreteHit>> hits(static_cast<size_t>(count));
    Tracer::Workspace workspace;
    return seconds_of(processor_seconds, [&] {
      for (const Crop& band : bands_)
        for (int y = band.y0; y < band.y1; ++y)
          for (int left = band.x0; left < band.x1; left += strip) {
            rays.clear();
            times.clear();
            for (int x = left; x < std::min(left + strip, band.x1); ++x) {
              const Sampler::Pixel pixel = context.sampler.pixel(x, y);
              for (uint32_t i = 0; i < context.sampler.count(); ++i) {
                const SamplePoint point = context.sampler.point(pixel, i);
                rays.push_back(context.ray(x, y, point));
                times.push_back(point.time);
              }
            }
            for (size_t i = 0; i < rays.size() && trace; i += most) {
              const size_t size = std::min(most, rays.size() - i);
              if (tc)
                tracer.trace_packet(std::span(rays).subspan(i, size), Visibility::visible, workspace, {}, together);
              else
                discrete.intersect(std::span(rays).subspan(i, size), std::span(times).subspan(i, size),
                                   std::span(hits).subspan(i, size));
            }
            // All of it counts as used.
            asm volatile("" : : "g"(rays.data()), "g"(times.data()) : "memory");
          }
    });
  }

  const Shot& shot_;
  const Options& options_;
  Rows& rows_;
  Renderer renderer_;
  ShotParts parts_;
  static constexpr int kHigher = 4;  // so that two threads have enough to share
  std::vector<Crop> bands_, high_bands_;
  double pixels_ = 0;
  int keys_ = 0;
};

int run(int argc, char** argv) {
  CLI::App app("What rays cost with everything that a picture needs");
  const ShotChoice choice(app, "960x540");
  Options options;
  app.add_option("--tc-rays", options.tc_rays)->delimiter(',');
  app.add_option("--spp", options.spp);
  app.add_option("--keys", options.keys)->delimiter(',');
  app.add_option("--bands", options.bands)->check(CLI::Range(1, 1000));
  app.add_option("--band-height", options.band_height)->check(CLI::Range(1, 100000));
  app.add_option("--rounds", options.rounds)->check(CLI::Range(1, 1000));
  app.add_option("--thread-rounds", options.thread_rounds, "Of rendering with one thread and with two; 0: none");
  app.add_option("--build-rounds", options.build_rounds, "Of building with one thread and with two; 0: none");
  app.add_option("--csv", options.csv, "The file to write; standard output, if not given");
  CLI11_PARSE(app, argc, argv);

  Rows rows(options.csv);
  const Shot shot = choice.make(false);
  Bench bench(shot, options, rows);
  bench.measure_parts();
  bench.measure_threads();
  return 0;
}

}  // namespace
}  // namespace kairos::bench

int main(int argc, char** argv) { return kairos::bench::reported_run("bench_renders", kairos::bench::run, argc, argv); }
