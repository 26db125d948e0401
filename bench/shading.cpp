// What clusters do for the shading of time-continuous rays: error against the number of shading samples, evaluations
// and time, with and without. One thread; times are the processor's, not the wall's.
//
// usage: bench_shading SCENE... [--size WxH] [--shading NAME] [--frame F] [--shutter OPEN,CLOSE] [--tc-rays N]
//                      [--samples A,B,...] [--seeds N]
//
// For each number N of samples per ray and both settings it prints shading evaluations per ray, microseconds per ray
// (tracing and shading), and two errors in dB (PSNR of linear values, peak 1, values clipped to it): of shading alone,
// against the very same rays with 128 samples, and of the picture, against one of more rays. Each is the median over
// pictures with seeds of their own. Clipping and median are there since a single bright speck would decide otherwise.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/compare.h>
#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/render.h>

#include "reported_run.h"

namespace kairos {
namespace {

constexpr int kReferenceRays = 128, kReferenceSamples = 8, kLimitSamples = 128;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

Image clipped(Image image) {
  for (Channel& channel : image.channels)
    for (float& value : channel.values) value = std::min(value, 1.0f);
  return image;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Row {
  double evaluations, microseconds, shading_error, picture_error;
};

/// Microseconds at which `rows` reach an error of shading, on straight lines of dB over the logarithm of time; nothing
/// if they don't.
std::optional<double> time_for(const std::vector<Row>& rows, double error) {
  if (rows.front().shading_error >= error) return rows.front().microseconds;
  for (size_t i = 1; i < rows.size(); ++i) {
    const Row &a = rows[i - 1], &b = rows[i];
    if (b.shading_error < error) continue;
    const double place = (error - a.shading_error) / (b.shading_error - a.shading_error);
    return a.microseconds * std::pow(b.microseconds / a.microseconds, place);
  }
  return std::nullopt;
}

void report(const Shot& shot, RenderParams params, int seeds, const std::vector<int>& samples) {
  Renderer renderer(shot);
  params.threads = 1;
  const auto picture = [&](int rays, int n, Clusters clusters, int seed) {
    params.tc_rays = rays;
    params.shading_samples = n;
    params.clusters = clusters;
    params.seed = static_cast<uint64_t>(seed);
    return clipped(renderer.render(params));
  };
  const int rays = params.tc_rays;
  const Image reference = picture(kReferenceRays, kReferenceSamples, Clusters::off, seeds);
  std::vector<Image> limits;
  std::vector<double> floor;
  for (int seed = 0; seed < seeds; ++seed) {
    limits.push_back(picture(rays, kLimitSamples, Clusters::off, seed));
    floor.push_back(difference(reference, limits.back(), "").psnr);
  }
  fmt::print("{} rays per pixel; the picture's error with {} samples: {:.2f} dB\n", rays, kLimitSamples, median(floor));
  fmt::print("  N  clusters  evaluations/ray  us/ray  error of shading  error of picture\n");
  std::vector<Row> without, with;
  for (const int n : samples)
    for (const Clusters clusters : {Clusters::off, Clusters::on}) {
      std::vector<double> evaluations, microseconds, shading, whole;
      for (int seed = 0; seed < seeds; ++seed) {
        params.tc_rays = rays;
        params.shading_samples = n;
        params.clusters = clusters;
        params.seed = static_cast<uint64_t>(seed);
        RenderStats stats;
        const double start = processor_seconds();
        Image image = renderer.render(params, &stats);
        const auto traced = static_cast<double>(stats.rays);
        microseconds.push_back((processor_seconds() - start) / traced * 1e6);
        image = clipped(std::move(image));
        evaluations.push_back(static_cast<double>(stats.shading_samples) / traced);
        shading.push_back(difference(limits[static_cast<size_t>(seed)], image, "").psnr);
        whole.push_back(difference(reference, image, "").psnr);
      }
      const Row row{median(evaluations), median(microseconds), median(shading), median(whole)};
      fmt::print("{:3}  {:8}  {:15.2f}  {:6.2f}  {:13.2f} dB  {:13.2f} dB\n", n, to_string(clusters), row.evaluations,
                 row.microseconds, row.shading_error, row.picture_error);
      (clusters == Clusters::on ? with : without).push_back(row);
    }
  fmt::print("time with clusters for the error of shading without:");
  for (size_t i = 0; i < samples.size(); ++i) {
    const auto time = time_for(with, without[i].shading_error);
    fmt::print(" N = {}: {}{}", samples[i],
               time ? fmt::format("{:.0f} %", 100 * *time / without[i].microseconds) : "not reached",
               i + 1 < samples.size() ? "," : "\n");
  }
}

int run(int argc, char** argv) {
  CLI::App app("What clusters do for the shading of time-continuous rays");
  std::vector<std::string> scenes;
  std::string size = "240x135", shutter, shading_name = "normal";
  ShotOptions options;
  RenderParams params;
  double frame = 0;
  int seeds = 5;
  std::vector<int> samples{1, 2, 4, 8, 16};
  app.add_option("scene", scenes)->required();
  app.add_option("--size", size);
  app.add_option("--shading", shading_name);
  const auto* frame_option = app.add_option("--frame", frame);
  app.add_option("--shutter", shutter);
  app.add_option("--tc-rays", params.tc_rays);
  app.add_option("--samples", samples)->delimiter(',');
  app.add_option("--seeds", seeds)->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);

  if (std::sscanf(size.c_str(), "%dx%d", &options.width, &options.height) != 2)
    throw Error(ErrorCode::bad_usage, "--size", "give it as WIDTHxHEIGHT");
  if (frame_option->count() > 0) options.frame = frame;
  double open = 0, close = 0;
  if (!shutter.empty()) {
    if (std::sscanf(shutter.c_str(), "%lf,%lf", &open, &close) != 2)
      throw Error(ErrorCode::bad_usage, "--shutter", "give it as OPEN,CLOSE");
    options.shutter = {open, close};
  }
  const std::optional<ShadingKind> shading = parse<ShadingKind>(shading_name);
  if (!shading) throw Error(ErrorCode::bad_usage, "--shading", "give one of those that kairos render has");
  params.shading = *shading;
  if (is_lit(*shading)) options.lights = LightChoice::automatic;
  const auto scene = load_scene(scenes);
  report(make_shot(*scene, options), params, seeds, samples);
  return 0;
}

}  // namespace
}  // namespace kairos

int main(int argc, char** argv) { return kairos::bench::reported_run("bench_shading", kairos::run, argc, argv); }
