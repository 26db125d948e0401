// What light that is shared through cells of surfaces is worth: error and time of discrete and time-continuous rays,
// each with and without, those of tc and auto also where `--cells auto` thinks best, and how much of the error is bias.
// One thread, processor time; what is looked at and raced beforehand counts by the crop's share of the frame. Crops
// should have edges that are multiples of 64, since light is shared in squares of so many pixels.
//
// usage: bench_cells SCENE... [--size WxH] [--crop X0,X1,Y0,Y1] [--shading NAME] [--spp A,B,...] [--tc RxN,...]
//                    [--auto A,B,...] [--cells off,auto,on] [--seeds N] [--reference SPP]
//
// Prints for each picture, in Markdown, microseconds per pixel (of which before the picture, as a share), its error in
// dB (values above 1 count as 1), the gain over discrete samples in the same time, without cells and with, on straight
// lines of dB over the logarithm of time, and the share of bias in the squared error. Errors are against the mean of 2
// x SPP discrete samples without cells, less what that has itself. The bias is the mean of (A1 - U1)(A2 - U2) over
// pixels and channels, where A1, A2 are pictures of different seeds and U1, U2 the halves of the reference: noise of
// all four cancels.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/render.h>

#include "reported_run.h"
#include "shot_choice.h"

namespace kairos::bench {
namespace {

using Values = std::vector<double>;

/// Red, green and blue of all pixels, as a display shows them.
Values shown(const Image& image) {
  Values values;
  for (const char* name : {"R", "G", "B"})
    for (const float v : image.find(name)->values) values.push_back(std::clamp(static_cast<double>(v), 0.0, 1.0));
  return values;
}

double mean_product(const Values& a, const Values& b, const Values& c, const Values& d) {  // of a - b and c - d
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (c[i] - d[i]);
  return sum / static_cast<double>(a.size());
}

double decibels(double square) { return square > 0 ? -10 * std::log10(square) : 99; }

struct Row {
  std::string name;
  double microseconds = 0, before = 0, square = 0, bias = 0;
};

double at_time(const std::vector<Row>& rows, double microseconds) {  // dB, of rows of rising time
  if (rows.size() < 2) return NAN;
  size_t i = 1;
  while (i + 1 < rows.size() && rows[i].microseconds < microseconds) ++i;
  const Row &a = rows[i - 1], &b = rows[i];
  const double place = std::log(microseconds / a.microseconds) / std::log(b.microseconds / a.microseconds);
  return decibels(a.square) + place * (decibels(b.square) - decibels(a.square));
}

class Bench {
 public:
  Bench(const Shot& shot, const RenderParams& params, int seeds, int reference_spp)
      : renderer_(shot), params_(params), seeds_(seeds) {
    params_.threads = 1;
    const Crop crop = params_.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height});
    pixels_ = static_cast<double>(crop.x1 - crop.x0) * (crop.y1 - crop.y0);
    frame_pixels_ = static_cast<double>(shot.projection.width) * shot.projection.height;
    RenderParams reference = params_;
    reference.integrator = IntegratorKind::qmc;
    reference.spp = reference_spp;
    reference.cells = Cells::off;
    for (int half = 0; half < 2; ++half) {
      reference.seed = static_cast<uint64_t>(1000 + half);
      halves_[half] = shown(renderer_.render(reference));
    }
    mean_ = halves_[0];
    for (size_t i = 0; i < mean_.size(); ++i) mean_[i] = (mean_[i] + halves_[1][i]) / 2;
    own_ = mean_product(halves_[0], halves_[1], halves_[0], halves_[1]) / 4;
    fmt::print("{} seeds, reference {:.1f} dB\n\n", seeds, decibels(own_));
    std::fflush(stdout);
  }

  Row measure(const std::string& name, RenderParams params) {
    Row row{name};
    std::vector<Values> pictures;
    std::vector<double> times;
    for (int seed = 0; seed < seeds_; ++seed) {
      params.seed = static_cast<uint64_t>(seed);
      RenderStats stats;
      pictures.push_back(shown(renderer_.render(params, &stats)));
      const double before = stats.prepare_cpu_seconds / frame_pixels_ * 1e6;
      times.push_back((stats.render_cpu_seconds - stats.prepare_cpu_seconds) / pixels_ * 1e6 + before);
      row.before += before / seeds_;
      row.square += (mean_product(pictures.back(), mean_, pictures.back(), mean_) - own_) / seeds_;
    }
    std::sort(times.begin(), times.end());
    row.microseconds = times[times.size() / 2];
    for (int seed = 1; seed < seeds_; ++seed) {
      const auto i = static_cast<size_t>(seed);
      row.bias += mean_product(pictures[i - 1], halves_[0], pictures[i], halves_[1]) / (seeds_ - 1);
    }
    return row;
  }

  const RenderParams& params() const { return params_; }

 private:
  Renderer renderer_;
  RenderParams params_;
  int seeds_;
  double pixels_ = 0, frame_pixels_ = 0, own_ = 0;
  Values halves_[2], mean_;
};

void report(Bench& bench, const std::vector<int>& budgets, const std::vector<std::string>& tc,
            const std::vector<int>& automatic, const std::vector<std::string>& cells) {
  fmt::print("| | µs per pixel | error | over discrete | over discrete, cells | bias |\n|{}\n",
             " --- | --- | --- | --- | --- | --- |");
  std::vector<Row> discrete, shared;
  const auto measure = [&](const std::string& name, const RenderParams& params) {
    const Row row = bench.measure(name, params);
    if (params.integrator == IntegratorKind::qmc) (params.cells == Cells::off ? discrete : shared).push_back(row);
    return row;
  };
  const auto print = [&](const Row& row) {
    const auto over = [&](const std::vector<Row>& rows) {
      return rows.size() < 2 ? std::string()
                             : fmt::format("{:+.1f}", decibels(row.square) - at_time(rows, row.microseconds));
    };
    fmt::print("| {} | {:.1f} ({:.0f} %) | {:.1f} dB | {} | {} | {:.0f} % |\n", row.name, row.microseconds,
               100 * row.before / row.microseconds, decibels(row.square), over(discrete), over(shared),
               100 * row.bias / row.square);
    std::fflush(stdout);
  };
  for (const Cells on : {Cells::off, Cells::on}) {
    std::vector<Row> rows;
    for (const int spp : budgets) {
      RenderParams params = bench.params();
      params.integrator = IntegratorKind::qmc;
      params.spp = spp;
      params.cells = on;
      rows.push_back(measure(fmt::format("{} discrete{}", spp, on == Cells::on ? ", cells" : ""), params));
    }
    for (const Row& row : rows) print(row);
  }
  for (const std::string& text : tc)
    for (const std::string& kind : cells) {
      RenderParams params = bench.params();
      params.integrator = IntegratorKind::tc;
      if (std::sscanf(text.c_str(), "%dx%d", &params.tc_rays, &params.shading_samples) != 2)
        throw Error(ErrorCode::bad_usage, "--tc", "give it as RAYSxSAMPLES");
      params.cells = *parse<Cells>(kind);
      print(measure(fmt::format("`tc` {}, {}", text, kind), params));
    }
  for (const int spp : automatic)
    for (const std::string& kind : cells) {
      RenderParams params = bench.params();
      params.integrator = IntegratorKind::automatic;
      params.spp = spp;
      params.cells = *parse<Cells>(kind);
      print(measure(fmt::format("{} `auto`, {}", spp, kind), params));
    }
}

int run(int argc, char** argv) {
  CLI::App app("What light that is shared through cells of surfaces is worth");
  const ShotChoice choice(app, "640x360");
  std::string crop, shading = "whitted";
  std::vector<int> budgets{4, 16, 64}, automatic;
  std::vector<std::string> tc{"2x8", "4x8", "8x8", "16x8"}, cells{"off", "auto", "on"};
  int seeds = 2, reference = 512;
  app.add_option("--crop", crop);
  app.add_option("--shading", shading);
  app.add_option("--spp", budgets)->delimiter(',');
  app.add_option("--tc", tc)->delimiter(',');
  app.add_option("--auto", automatic)->delimiter(',');
  app.add_option("--cells", cells)->delimiter(',')->check(CLI::IsMember({"off", "auto", "on"}));
  app.add_option("--seeds", seeds)->check(CLI::Range(2, 1000));
  app.add_option("--reference", reference)->check(CLI::Range(1, 1 << 16));
  CLI11_PARSE(app, argc, argv);

  const Shot shot = choice.make(true);
  RenderParams params;
  params.shading = parse<ShadingKind>(shading).value_or(ShadingKind::whitted);
  if (!crop.empty()) {
    Crop& part = params.crop.emplace();
    if (std::sscanf(crop.c_str(), "%d,%d,%d,%d", &part.x0, &part.x1, &part.y0, &part.y1) != 4)
      throw Error(ErrorCode::bad_usage, "--crop", "give it as X0,X1,Y0,Y1");
  }
  Bench bench(shot, params, seeds, reference);
  report(bench, budgets, tc, automatic, cells);
  return 0;
}

}  // namespace
}  // namespace kairos::bench

int main(int argc, char** argv) { return kairos::bench::reported_run("bench_cells", kairos::bench::run, argc, argv); }
