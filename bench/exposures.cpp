// How far exposures of a coded picture over time are from those of the exact one, beside a stack of sub-frames, and
// what they take: a row of the table of docs/time.md. bench/exposures.py renders the files.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/time_file.h>

#include "measuring.h"

namespace {

using namespace kairos;

/// A box, a trapezoid, or one of both that moves from the first line to the last, with the integral 1; nowhere shorter
/// than a sixteenth of the time.
PixelWeights random_shutter(std::mt19937& random, int height) {
  const auto real = [&](double least, double most) { return std::uniform_real_distribution<>(least, most)(random); };
  const double length = std::exp2(real(-4, 0)), readout = random() % 3 == 0 ? real(0, 1 - length) : 0;
  const double open = real(0, 1 - length - readout);
  std::vector<TimeWeight::Point> points{{0, 1}, {1, 1}};
  if (random() % 2 == 0) points = {{0, 0}, {real(0, 0.5), 1}, {real(0.5, 1), 1}, {1, 0}};
  const double sum = TimeWeight(points).integral(0, 1);
  PixelWeights weights;
  weights.varies_in_y = readout > 0;
  weights.at = [=](int, int y) {
    const double begin = open + readout * y / height;
    return TimeWeight(points).stretched(begin, std::min(1.0, begin + length), 1 / (sum * length));
  };
  return weights;
}

/// Equal parts of the time, exact means, each rounded to 16 bits as files of pictures have them.
class Stack {
 public:
  Stack(const TimePicture& exact, int count) {
    for (int i = 0; i < count; ++i) {
      const double begin = i / static_cast<double>(count), end = (i + 1) / static_cast<double>(count);
      images_.push_back(exact.expose(TimeWeight({{begin, 1.0 * count}, {end, 1.0 * count}})));
      for (Channel& channel : images_.back().channels)
        for (float& value : channel.values) value = rounded(value);
    }
  }

  float expose(const TimeWeight& weight, size_t channel, size_t pixel) const {
    const auto count = static_cast<double>(images_.size());
    double sum = 0;
    for (size_t i = 0; i < images_.size(); ++i)
      sum += weight.integral(static_cast<double>(i) / count, static_cast<double>(i + 1) / count) *
             static_cast<double>(images_[i].channels[channel].values[pixel]);
    return static_cast<float>(sum);
  }

 private:
  static float rounded(float value) {
    int exponent = 0;
    const float mantissa = std::frexp(value, &exponent);
    return std::ldexp(std::round(mantissa * 2048) / 2048, exponent);
  }
  std::vector<Image> images_;
};

struct Errors {
  double most = 0, squares = 0;
  uint64_t count = 0;

  /// Relative to what is brighter than 1.
  void add(float value, float exact) {
    const double error = std::abs(static_cast<double>(value) - static_cast<double>(exact)) /
                         std::max(1.0, std::abs(static_cast<double>(exact)));
    most = std::max(most, error);
    squares += error * error;
    ++count;
  }
  std::string text() const {
    return fmt::format("{:.5f}, {:.1f} dB", most, -10 * std::log10(squares / static_cast<double>(count)));
  }
};

template <class Work>
double milliseconds(int times, const Work& work) {
  const double before = bench::processor_seconds();
  for (int i = 0; i < times; ++i) work();
  return (bench::processor_seconds() - before) * 1e3 / times;
}

int run(int argc, char** argv) {
  CLI::App app("Prints largest and RMS error of random exposures, of the file and of a stack, and milliseconds");
  std::string exact_path, coded_path;
  int shutters = 200, stack_size = 64;
  app.add_option("EXACT", exact_path)->required();
  app.add_option("CODED", coded_path)->required();
  app.add_option("--shutters", shutters);
  app.add_option("--stack", stack_size);
  CLI11_PARSE(app, argc, argv);
  const TimeFile exact_file = TimeFile::open(exact_path);
  const TimePicture& exact = exact_file.picture();
  ExposeOptions single;
  single.threads = 1;
  const TimeWeight box({{0.25, 2}, {0.75, 2}});
  const double first = milliseconds(1, [&] { TimeFile::open(coded_path).picture().expose(box, single); });
  const TimeFile coded_file = TimeFile::open(coded_path);
  const TimePicture& coded = coded_file.picture();
  coded.expose(box, single);
  const double later = milliseconds(5, [&] { coded.expose(box, single); });
  const Stack stack(exact, stack_size);
  std::mt19937 random(1);
  Errors of_file, of_stack;
  const TimeFrame& frame = exact.frame();
  for (int i = 0; i < shutters; ++i) {
    const PixelWeights weights = random_shutter(random, frame.frame_height);
    const Image right = exact.expose(weights), image = coded.expose(weights);
    for (int y = 0; y < frame.height; ++y) {
      const TimeWeight of_row = weights.at(0, y);
      for (int x = 0; x < frame.width; ++x)
        for (size_t c = 0; c < 3; ++c) {
          const auto pixel = static_cast<size_t>(y) * static_cast<size_t>(frame.width) + static_cast<size_t>(x);
          of_file.add(image.channels[c].values[pixel], right.channels[c].values[pixel]);
          if ((x + y + i) % 16 == 0)  // a stack is slow to expose this way
            of_stack.add(stack.expose(of_row, c, pixel), right.channels[c].values[pixel]);
        }
    }
  }
  fmt::print("{} | {} | {:.1f} | {:.1f}\n", of_file.text(), of_stack.text(), first, later);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
