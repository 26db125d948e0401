// What a time-continuous ray costs beside the best discrete one, without sampler and shading: the same rays through
// both, one thread, processor time, interleaved; and what building either costs.
//
// usage: bench_rays SCENE... [options below] [--csv FILE]
//
// Measures, for the CSV file: build_tc_s, build_discrete_s (each round; the shot's own keys), bytes_tc, bytes_discrete
// (of the first of --keys), bytes_discrete_best, triangles, moving_triangles; for each number of camera rays per pixel
// tc_ns and discrete_ns per ray, packet (how many of them go together, with those of pixels beside it), and for one
// time-continuous ray nodes, tests (of triangles), root_solves, hits and segments; incoherent_tc_ns and
// incoherent_discrete_ns for single rays that each go their own way; best_keys and best_keys_incoherent: how many
// motion keys of Embree's (--keys) were fastest, and so are meant by "discrete".
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <CLI/CLI.hpp>

#include <kairos/names.h>
#include <kairos/tracer.h>

#include "base/parallel.h"
#include "discrete/discrete_scene.h"
#include "integrators/shot_parts.h"
#include "measuring.h"
#include "policy/packet_choice.h"
#include "ray_sets.h"
#include "reported_run.h"
#include "shot_choice.h"
#include "study/statistics.h"

namespace kairos::bench {
namespace {

struct Options {
  std::vector<int> rays_per_pixel{1, 4, 16}, keys{0, 3, 5, 9};
  uint32_t tiles = 64;
  size_t incoherent = 20000;
  int rounds = 5, build_rounds = 3;
  std::string instruction_set, csv;
  bool single = false, tc_only = false;
};

void print(const std::string& text) { fmt::print(stderr, "{}\n", text); }

TracerOptions tracer_options(const Options& options) {
  TracerOptions result;
  result.precision = Precision::fast;
  if (!options.instruction_set.empty()) {
    result.instruction_set = parse<InstructionSet>(options.instruction_set);
    if (!result.instruction_set) throw Error(ErrorCode::bad_usage, "--instruction-set", "there is none of that name");
  }
  return result;
}

DiscreteScene discrete_scene(const Shot& shot, int keys) {
  DiscreteOptions options;
  options.keys = keys;
  return DiscreteScene(shot.meshes, options);
}

/// Triangles, and seconds of building.
void measure_builds(const Shot& shot, const Options& options, Rows& rows) {
  size_t triangles = 0, moving = 0;
  for (const Mesh& mesh : shot.meshes) {
    triangles += mesh.triangle_count();
    if (!mesh.is_static()) moving += mesh.triangle_count();
  }
  rows.add("triangles", static_cast<double>(triangles));
  rows.add("moving_triangles", static_cast<double>(moving));
  print(fmt::format("{} triangles, {} of them moving", triangles, moving));
  std::vector<double> tc, discrete;
  size_t bytes = 0;  // so that nobody leaves out building what is not used
  const auto build_tc = [&] {
    tc.push_back(
        seconds_of(processor_seconds, [&] { bytes += Tracer(shot.meshes, tracer_options(options)).memory_bytes(); }));
  };
  const auto build_discrete = [&] {
    if (options.tc_only) return;
    discrete.push_back(seconds_of(processor_seconds, [&] { bytes += discrete_scene(shot, 0).memory_bytes(); }));
  };
  for (int round = 0; round < options.build_rounds; ++round) {  // A B, B A
    if (round % 2 == 0) build_tc();
    build_discrete();
    if (round % 2 != 0) build_tc();
  }
  rows.add("build_tc_s", 0, tc);
  rows.add("build_discrete_s", 0, discrete);
  if (bytes > 0 && !discrete.empty())
    print(fmt::format("building: tc {:.2f} s, discrete {:.2f} s", study::median(tc), study::median(discrete)));
}

/// Traces the same rays both ways.
class Race {
 public:
  Race(const Tracer& tracer, RaySet set) : tracer_(tracer), set_(std::move(set)), hits_(set_.rays.size()) {}

  double per_ray() const { return 1e9 / static_cast<double>(std::max<size_t>(1, set_.rays.size())); }

  /// together: rays of a packet; 1: one by one.
  /// per_strip: rays of which packets are made.
  void trace(size_t per_strip, size_t together) {
    for (size_t first = 0; first < set_.rays.size(); first += per_strip) {
      const size_t end = std::min(first + per_strip, set_.rays.size());
      for (size_t i = first; i < end; i += together)
        if (together == 1)
          tracer_.trace(set_.rays[i], Visibility::visible, workspace_);
        else
          tracer_.trace_packet(std::span(set_.rays).subspan(i, std::min(together, end - i)), Visibility::visible,
                               workspace_);
    }
  }
  void intersect(const DiscreteScene& scene) { scene.intersect(set_.rays, set_.times, hits_); }
  void intersect_singly(const DiscreteScene& scene) {
    for (size_t i = 0; i < set_.rays.size(); ++i) hits_[i] = scene.intersect(set_.rays[i], set_.times[i]);
  }
  TraceCounters counters() const { return workspace_.counters(); }
  void forget_counters() { workspace_ = {}; }

 private:
  const Tracer& tracer_;
  RaySet set_;
  std::vector<std::optional<DiscreteHit>> hits_;
  Tracer::Workspace workspace_;
};

/// The scene, among those of all keys, through which `intersect` goes fastest: by the least of some interleaved tries.
size_t fastest(const std::vector<DiscreteScene>& scenes, const std::function<void(const DiscreteScene&)>& intersect) {
  constexpr int kTries = 4;
  std::vector<double> least(scenes.size(), INFINITY);
  for (int i = 0; i < kTries; ++i)
    for (size_t s = 0; s < scenes.size(); ++s)
      least[s] = std::min(least[s], seconds_of(processor_seconds, [&] { intersect(scenes[s]); }));
  return static_cast<size_t>(std::min_element(least.begin(), least.end()) - least.begin());
}

/// Interleaved times per ray, in nanoseconds, of the time-continuous rays and (not for --tc-only) the discrete ones.
template <class Trace, class Intersect>
void race_and_report(const std::string& name, int rays, const Options& options, double per_ray, const Trace& trace,
                     const Intersect& intersect, Rows& rows) {
  std::vector<Measurement> both{[&] { return seconds_of(processor_seconds, trace); }};
  if (!options.tc_only) both.push_back([&] { return seconds_of(processor_seconds, intersect); });
  const auto times = interleave(options.rounds, both);
  rows.add(name + "tc_ns", rays, times[0], per_ray);
  if (options.tc_only) return;
  rows.add(name + "discrete_ns", rays, times[1], per_ray);
  std::vector<double> ratios;
  for (size_t i = 0; i < times[0].size(); ++i) ratios.push_back(times[0][i] / times[1][i]);
  const study::Estimate ratio = study::estimate_of_ratios(ratios);
  print(fmt::format("{}{} rays per pixel: tc {:.0f} ns, discrete {:.0f} ns, ratio {:.2f} ({:.2f} to {:.2f})", name,
                    rays, study::median(times[0]) * per_ray, study::median(times[1]) * per_ray, ratio.median, ratio.low,
                    ratio.high));
}

void measure_rays(const Shot& shot, const Options& options, Rows& rows) {
  const Tracer tracer(shot.meshes, tracer_options(options));
  const bool moves = std::any_of(shot.meshes.begin(), shot.meshes.end(), [](const Mesh& m) { return !m.is_static(); });
  std::vector<int> keys = options.keys;
  if (!moves) keys.resize(1);
  if (options.tc_only) keys.clear();
  rows.add("bytes_tc", static_cast<double>(tracer.memory_bytes()));
  std::vector<DiscreteScene> scenes;
  for (const int k : keys) scenes.push_back(discrete_scene(shot, k));

  Race coherent(tracer, camera_rays(shot.projection, 4, options.tiles));
  Race incoherent(tracer, incoherent_rays(shot.meshes, options.incoherent));
  size_t best = 0, best_incoherent = 0;
  if (!scenes.empty()) {
    best = fastest(scenes, [&](const DiscreteScene& s) { coherent.intersect(s); });
    best_incoherent = fastest(scenes, [&](const DiscreteScene& s) { incoherent.intersect_singly(s); });
    rows.add("best_keys", keys[best]);
    rows.add("best_keys_incoherent", keys[best_incoherent]);
    rows.add("bytes_discrete", static_cast<double>(scenes.front().memory_bytes()));
    rows.add("bytes_discrete_best", static_cast<double>(scenes[best].memory_bytes()));
    print(fmt::format("fastest discrete rays: at least {} keys, incoherent {}", keys[best], keys[best_incoherent]));
  }
  // Which packets an integrator would take.
  ShotParts parts(shot);
  const PixelContext context{CameraRays(shot.projection), Sampler(SamplerKind::owen_sobol, 1, 0),
                             PixelFilter(FilterKind::box), parts.shader(ShadingKind::normal, false, 0, 0)};
  const PacketChoice packets = choose_packets(context, shot.projection, tracer);
  for (const int n : options.rays_per_pixel) {
    Race race(tracer, camera_rays(shot.projection, n, options.tiles));
    const auto count = static_cast<uint32_t>(n);
    const int strip = options.single ? 1 : packets.strip(count);
    const size_t per_strip = static_cast<size_t>(n) * static_cast<size_t>(strip);
    const bool share = !options.single && (strip > 1 || packets.together(count));
    const size_t together = share ? std::min(Tracer::kMaxPacket, per_strip) : 1;
    const auto trace = [&] { race.trace(per_strip, together); };
    const auto intersect = [&] { race.intersect(scenes[best]); };
    trace();  // warms up
    race.forget_counters();
    race_and_report("", n, options, race.per_ray(), trace, intersect, rows);
    rows.add("packet", n, 0, static_cast<double>(together));
    const TraceCounters c = race.counters();
    const auto mean = [&](uint64_t sum) { return static_cast<double>(sum) / static_cast<double>(c.rays); };
    rows.add("nodes", n, 0, mean(c.nodes));
    rows.add("tests", n, 0, mean(c.triangles));
    rows.add("root_solves", n, 0, mean(c.root_solves));
    rows.add("hits", n, 0, mean(c.hits));
    rows.add("segments", n, 0, mean(c.segments));
    print(
        fmt::format("    packets of {}; {:.1f} nodes, {:.1f} triangles, {:.1f} root solves, {:.1f} hits, {:.2f} "
                    "segments per time-continuous ray",
                    together, mean(c.nodes), mean(c.triangles), mean(c.root_solves), mean(c.hits), mean(c.segments)));
  }
  if (options.incoherent == 0) return;
  const auto trace = [&] { incoherent.trace(1, 1); };
  trace();
  race_and_report(
      "incoherent_", 1, options, incoherent.per_ray(), trace,
      [&] { incoherent.intersect_singly(scenes[best_incoherent]); }, rows);
}

int run(int argc, char** argv) {
  CLI::App app("What a time-continuous ray costs beside a discrete one");
  const ShotChoice choice(app, "960x540");
  Options options;
  app.add_option("--rays-per-pixel", options.rays_per_pixel)->delimiter(',');
  app.add_option("--keys", options.keys, "Motion keys to give Embree at least; 0: those of the shot")->delimiter(',');
  app.add_option("--tiles", options.tiles, "How many of 16x16 pixels are traced, spread over the picture");
  app.add_option("--incoherent", options.incoherent, "How many of those; 0: none");
  app.add_option("--rounds", options.rounds)->check(CLI::Range(1, 1000));
  app.add_option("--build-rounds", options.build_rounds, "0: building is not measured")->check(CLI::Range(0, 1000));
  app.add_option("--instruction-set", options.instruction_set);
  app.add_option("--csv", options.csv, "The file to write; standard output, if not given");
  app.add_flag("--single", options.single, "No packets");
  app.add_flag("--tc-only", options.tc_only);
  CLI11_PARSE(app, argc, argv);

  Rows rows(options.csv);
  with_threads(1, [&] {
    const Shot shot = choice.make(false);
    for (const std::string& note : shot.notes) print(note);
    measure_builds(shot, options, rows);
    measure_rays(shot, options, rows);
  });
  return 0;
}

}  // namespace
}  // namespace kairos::bench

int main(int argc, char** argv) { return kairos::bench::reported_run("bench_rays", kairos::bench::run, argc, argv); }
