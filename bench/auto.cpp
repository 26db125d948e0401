// How large the errors of ways to render a shot are, and how long they take: of what bench/auto_table.py asks whether
// `auto` is ever worse than what is fixed.
//
// usage: bench_auto SCENE... [--size WxH] [--frame F] [--shutter OPEN,CLOSE] [--camera NAME] [--instances WHICH]
//                   [--shading normal] [--rows N] [--budgets N,...] [--tc-rays N,...] [--methods NAME,...] [--seed N]
//                   [--seeds N] [--reference N] [--keep-reference FILE] [--csv FILE]
//
// Rows are spread evenly over the frame; what is looked at before counts by their share of it. One thread, processor
// time. For the CSV file METHOD_s and METHOD_db: seconds, and -10 log10 of the mean squared error of colours as a
// display shows them, of the methods
//   discrete  as many samples everywhere       (rays: samples)
//   spread    where they are needed, as auto would have them
//   auto
//   tc        time-continuous rays             (rays: these)
//   mixed     with 16 times as many rays to what stands still
// The reference: time-continuous rays with 32 times as many to what stands still, with a seed of its own. It takes as
// long as all else: kept in a file, it is made once for any number of runs with other methods and seeds.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/render.h>

#include "measuring.h"
#include "reported_run.h"
#include "shot_choice.h"

namespace kairos::bench {
namespace {

struct Seen {
  std::vector<float> values;  // of red, green and blue, as a display shows them
  double seconds = 0;
  RayPrices prices;
};

class Ways {
 public:
  Ways(const Shot& shot, ShadingKind shading, int rows) : shot_(shot), renderer_(shot), shading_(shading) {
    const int height = shot.projection.height;
    rows = std::clamp(rows, 1, height);
    for (int i = 0; i < rows; ++i) rows_.push_back(static_cast<int>((i + 0.5) * height / rows));
  }

  RenderParams params(IntegratorKind integrator, int tc_rays, int spp, uint64_t seed) const {
    RenderParams params;
    params.integrator = integrator;
    params.tc_rays = tc_rays;
    params.spp = spp;
    params.seed = seed;
    params.shading = shading_;
    params.threads = 1;
    return params;
  }

  /// How many a picture has.
  size_t values() const { return 3 * rows_.size() * static_cast<size_t>(shot_.projection.width); }

  Seen render(RenderParams params) {
    Seen seen;
    const double share = static_cast<double>(rows_.size()) / shot_.projection.height;
    for (const int row : rows_) {
      params.crop = Crop{0, shot_.projection.width, row, row + 1};
      RenderStats stats;
      const Image image = renderer_.render(params, &stats);
      seen.seconds += stats.render_cpu_seconds - (1 - share) * stats.prepare_cpu_seconds;
      if (stats.prices) seen.prices = *stats.prices;
      for (const char* channel : {"R", "G", "B"})
        for (const float value : image.find(channel)->values) seen.values.push_back(std::clamp(value, 0.0f, 1.0f));
    }
    return seen;
  }

 private:
  const Shot& shot_;
  Renderer renderer_;
  ShadingKind shading_;
  std::vector<int> rows_;
};

double decibels(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  return -10 * std::log10(std::max(sum / static_cast<double>(a.size()), 1e-12));
}

struct Choice {
  std::vector<int> budgets{2, 4, 8, 16, 32, 64, 128, 256, 512}, tc_rays{1, 2, 4, 8, 16, 32};
  std::vector<std::string> methods{"discrete", "spread", "auto", "tc", "mixed"};
  int rows = 30, seed = 0, seeds = 1, reference = 64;
  std::string kept_reference;

  bool has(const char* method) const { return std::find(methods.begin(), methods.end(), method) != methods.end(); }
};

/// Renders it, or reads what was kept of the same shot, rows and number of rays.
std::vector<float> reference_of(Ways& ways, const Choice& choice, size_t values) {
  if (!choice.kept_reference.empty()) {
    std::vector<float> kept(values);
    const auto bytes = static_cast<std::streamsize>(values * sizeof(float));
    std::ifstream in(choice.kept_reference, std::ios::binary);
    if (in.read(reinterpret_cast<char*>(kept.data()), bytes) && in.peek() == std::ifstream::traits_type::eof())
      return kept;
  }
  constexpr uint64_t kSeed = 977;
  const int rays = choice.reference;
  std::vector<float> made = ways.render(ways.params(IntegratorKind::mixed, rays, 32 * rays, kSeed)).values;
  if (!choice.kept_reference.empty()) {
    std::ofstream out(choice.kept_reference, std::ios::binary);
    out.write(reinterpret_cast<const char*>(made.data()), static_cast<std::streamsize>(made.size() * sizeof(float)));
    if (!out.flush()) throw Error(ErrorCode::io, choice.kept_reference, "cannot be written");
  }
  return made;
}

void measure(const Shot& shot, ShadingKind shading, const Choice& choice, Rows& rows) {
  Ways ways(shot, shading, choice.rows);
  const std::vector<float> reference = reference_of(ways, choice, ways.values());
  // Told that time-continuous rays are far too dear, auto traces none.
  Calibration dear;
  dear.discrete_sample = 1;
  dear.still_ray = ways.render(ways.params(IntegratorKind::automatic, 1, 2, 0)).prices.still_ray;
  dear.tc_ray.fill(1e6);
  for (int seed = choice.seed; seed < choice.seed + choice.seeds; ++seed) {
    const auto add = [&](const char* method, int effort, const RenderParams& params) {
      if (!choice.has(method)) return;
      const Seen seen = ways.render(params);
      rows.add(std::string(method) + "_s", effort, seed, seen.seconds);
      rows.add(std::string(method) + "_db", effort, seed, decibels(reference, seen.values));
    };
    for (const int budget : choice.budgets) {
      add("discrete", budget, ways.params(IntegratorKind::qmc, 1, budget, seed));
      RenderParams params = ways.params(IntegratorKind::automatic, 1, budget, seed);
      add("auto", budget, params);
      params.calibration = dear;
      add("spread", budget, params);
    }
    for (const int count : choice.tc_rays) {
      add("tc", count, ways.params(IntegratorKind::tc, count, count, seed));
      add("mixed", count, ways.params(IntegratorKind::mixed, count, 16 * count, seed));
    }
  }
}

int run(int argc, char** argv) {
  CLI::App app("Errors and times of ways to render");
  const ShotChoice shot(app, "480x270");
  Choice choice;
  std::string csv, shading = "normal";
  app.add_option("--shading", shading)->check(CLI::IsMember({"normal", "flat", "whitted", "path"}));
  app.add_option("--rows", choice.rows);
  app.add_option("--budgets", choice.budgets)->delimiter(',');
  app.add_option("--tc-rays", choice.tc_rays)->delimiter(',');
  app.add_option("--methods", choice.methods)
      ->delimiter(',')
      ->check(CLI::IsMember({"discrete", "spread", "auto", "tc", "mixed"}));
  app.add_option("--seed", choice.seed, "The first");
  app.add_option("--seeds", choice.seeds);
  app.add_option("--reference", choice.reference, "Time-continuous rays in a pixel of it");
  app.add_option("--keep-reference", choice.kept_reference,
                 "A file that keeps it between runs with the same shot, rows and number of its rays");
  app.add_option("--csv", csv, "The file to write; standard output, if not given");
  CLI11_PARSE(app, argc, argv);
  Rows rows(csv);
  measure(shot.make(true), *parse<ShadingKind>(shading), choice, rows);
  return 0;
}

}  // namespace
}  // namespace kairos::bench

int main(int argc, char** argv) { return kairos::bench::reported_run("bench_auto", kairos::bench::run, argc, argv); }
