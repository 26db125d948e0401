// Where the error and the time of a picture lie: in pixels in which nothing moves, and in those in which something may.
//
// usage: bench_regions SCENE... [--size WxH] [--shading NAME] [--frame F] [--shutter OPEN,CLOSE] [--crop X0,X1,Y0,Y1]
//                      [--methods A,B,...] [--budgets N,...] [--reference-spp N] [--keys N] [--seeds N]
//
// For every method and budget: processor time, rays per pixel, error (PSNR, dB, peak 1, values clipped to it), and
// which part of the squared error lies outside the motion mask and inside, with the share that the worst fifth of those
// pixels has of it. At the end what the methods gain over the first one at equal time. One thread.
#include <algorithm>
#include <cmath>
#include <ctime>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/render.h>

#include "motion/motion_mask.h"
#include "reported_run.h"
#include "scene/scene.h"

namespace kairos {
namespace {

struct Options {
  std::vector<std::string> scenes, methods{"qmc", "auto"};
  std::vector<int> budgets{16, 64, 128};
  int reference_spp = 2048, keys = 0, seeds = 3;
  ShotOptions shot;
  RenderParams params;
};

IntegratorKind parse_name(const std::string& text) {
  if (const auto kind = parse<IntegratorKind>(text)) return *kind;
  throw Error(ErrorCode::bad_usage, "--methods", "give integrators that kairos render has");
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::vector<double> squares(const Image& a, const Image& b) {
  std::vector<double> result(a.channels[0].values.size());
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < result.size(); ++i) {
      const double d = static_cast<double>(std::min(1.0f, a.channels[c].values[i])) -
                       static_cast<double>(std::min(1.0f, b.channels[c].values[i]));
      result[i] += d * d / 3;
    }
  return result;
}

void report(const Options& options) {
  const auto scene = load_scene(options.scenes, {});
  ShotOptions so = options.shot;
  so.textures = options.params.shading != ShadingKind::normal;
  if (is_lit(options.params.shading)) so.lights = LightChoice::automatic;
  const Shot shot = make_shot(*scene, so);
  RenderParams params = options.params;
  params.discrete_keys = options.keys;
  params.threads = 1;
  Renderer renderer(shot);
  const Projection& frame = shot.projection;
  const MotionMask mask(std::make_shared<const ScreenMotion>(shot, 0.5), Crop{0, frame.width, 0, frame.height});
  params.integrator = IntegratorKind::qmc;
  params.spp = options.reference_spp;
  params.seed = 1000001;
  Image reference = renderer.render(params);
  params.seed = 1000002;
  const Image other = renderer.render(params);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < reference.channels[c].values.size(); ++i)
      reference.channels[c].values[i] = (reference.channels[c].values[i] + other.channels[c].values[i]) / 2;
  const auto floor = squares(reference, other);
  double floor_sum = 0;
  for (const double v : floor) floor_sum += v;
  const size_t pixels = floor.size();
  fmt::print("{}: {}x{}, reference {:.1f} dB\n", options.scenes[0], reference.width, reference.height,
             -10 * std::log10(floor_sum / static_cast<double>(pixels)));
  std::vector<bool> moving(pixels);
  size_t inside = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const int x = reference.left + static_cast<int>(i % static_cast<size_t>(reference.width));
    const int y = reference.top + static_cast<int>(i / static_cast<size_t>(reference.width));
    moving[i] = mask.moves(x, y);
    inside += moving[i];
  }
  fmt::print("inside the mask: {:.1f} % of the pixels\n",
             100.0 * static_cast<double>(inside) / static_cast<double>(pixels));
  fmt::print("method budget    cpu ms   rays/px   PSNR | error outside (worst 20 % of px hold)  inside (worst 20 %)\n");
  struct Point {
    double time, psnr;
  };
  std::vector<std::vector<Point>> curves(options.methods.size());
  for (const int budget : options.budgets)
    for (size_t m = 0; m < options.methods.size(); ++m) {
      params.integrator = parse_name(options.methods[m]);
      params.spp = budget;
      std::vector<double> times, psnrs, rays, out, in, out_top, in_top;
      for (int seed = 0; seed < options.seeds; ++seed) {
        params.seed = static_cast<uint64_t>(seed);
        RenderStats stats;
        std::vector<double> ms;
        Image image;
        double spent = 0;
        do {
          image = renderer.render(params, &stats);
          ms.push_back(stats.render_cpu_seconds * 1e3);
          spent += ms.back();
        } while (spent < 150 && ms.size() < 5);
        const auto e = squares(reference, image);
        std::vector<double> o, i;
        double so2 = 0, si = 0;
        for (size_t p = 0; p < pixels; ++p) {
          (moving[p] ? i : o).push_back(e[p]);
          (moving[p] ? si : so2) += e[p];
        }
        const auto top = [](std::vector<double>& v, double sum) {
          std::sort(v.rbegin(), v.rend());
          double t = 0;
          for (size_t k = 0; k < v.size() / 5; ++k) t += v[k];
          return sum > 0 ? 100 * t / sum : 0;
        };
        times.push_back(*std::min_element(ms.begin(), ms.end()));
        rays.push_back(static_cast<double>(stats.rays) / static_cast<double>(pixels));
        psnrs.push_back(-10 * std::log10((so2 + si) / static_cast<double>(pixels)));
        out.push_back(100 * so2 / (so2 + si));
        in.push_back(100 * si / (so2 + si));
        out_top.push_back(top(o, so2));
        in_top.push_back(top(i, si));
      }
      curves[m].push_back({median(times), median(psnrs)});
      fmt::print("{:6} {:6} {:9.1f} {:9.1f} {:6.2f} | {:5.1f} % ({:.0f} %)   {:5.1f} % ({:.0f} %)", options.methods[m],
                 budget, median(times), median(rays), median(psnrs), median(out), median(out_top), median(in),
                 median(in_top));
      fmt::print("\n");
      std::fflush(stdout);
    }
  // gains at equal time over the first
  for (size_t m = 1; m < curves.size(); ++m) {
    fmt::print("gain of {}:", options.methods[m]);
    const auto& c = curves[m];
    for (size_t k = 0; k < curves[0].size(); ++k) {
      const double t = std::log(curves[0][k].time);
      size_t s = 1;
      while (s + 1 < c.size() && std::log(c[s].time) < t) ++s;
      const double a = std::log(c[s - 1].time), b = std::log(c[s].time);
      const double psnr = c[s - 1].psnr + (c[s].psnr - c[s - 1].psnr) * (t - a) / (b - a);
      fmt::print(" {}: {:+.2f}{}", options.budgets[k], psnr - curves[0][k].psnr,
                 t > b + 0.01 || t < a - 0.01 ? "*" : "");
    }
    fmt::print("\n");
  }
}

int run(int argc, char** argv) {
  CLI::App app("Where the error lies");
  Options o;
  std::string size = "240x135", shutter, shading_name = "normal", crop;
  double frame = 0;
  app.add_option("scene", o.scenes)->required();
  app.add_option("--size", size);
  app.add_option("--shading", shading_name);
  const auto* frame_option = app.add_option("--frame", frame);
  app.add_option("--shutter", shutter);
  app.add_option("--crop", crop);
  app.add_option("--methods", o.methods)->delimiter(',');
  app.add_option("--budgets", o.budgets)->delimiter(',');
  app.add_option("--reference-spp", o.reference_spp);
  app.add_option("--keys", o.keys);
  app.add_option("--seeds", o.seeds)->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  if (std::sscanf(size.c_str(), "%dx%d", &o.shot.width, &o.shot.height) != 2)
    throw Error(ErrorCode::bad_usage, "--size", "give it as WIDTHxHEIGHT");
  if (frame_option->count() > 0) o.shot.frame = frame;
  double open = 0, close = 0;
  if (!shutter.empty()) {
    if (std::sscanf(shutter.c_str(), "%lf,%lf", &open, &close) != 2)
      throw Error(ErrorCode::bad_usage, "--shutter", "give it as OPEN,CLOSE");
    o.shot.shutter = {open, close};
  }
  if (!crop.empty()) {
    Crop c;
    if (std::sscanf(crop.c_str(), "%d,%d,%d,%d", &c.x0, &c.x1, &c.y0, &c.y1) != 4)
      throw Error(ErrorCode::bad_usage, "--crop", "give it as X0,X1,Y0,Y1");
    o.params.crop = c;
  }
  o.params.shading = parse<ShadingKind>(shading_name).value_or(o.params.shading);
  report(o);
  return 0;
}

}  // namespace
}  // namespace kairos

int main(int argc, char** argv) { return kairos::bench::reported_run("bench_regions", kairos::run, argc, argv); }
