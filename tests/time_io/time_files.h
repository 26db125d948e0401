// A small picture over time in a file: what tests of such files share.
#pragma once

#include <fstream>
#include <random>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/object_layers.h>
#include <kairos/time_file.h>

#include "pixel/record_builder.h"
#include "seed.h"
#include "temp_folder.h"

namespace kairos {

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
inline void put_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// A pixel that sees a few things one after the other, which its place and the seed decide.
class PixelSource {
 public:
  explicit PixelSource(uint32_t seed) : seed_(seed) {}

  const PixelRecord& record(int x, int y) {
    std::mt19937 random(seed_ + static_cast<uint32_t>(x * 1000 + y));
    const auto real = [&] { return std::uniform_real_distribution<float>()(random); };
    builder_.begin_pixel(x, y, {real(), real(), real()});
    for (uint32_t ray = 0; ray < 3; ++ray) {
      const uint32_t first = builder_.part_count();
      for (float now = real() / 4; now < 1;) {
        const float end = std::min(1.0f, now + real() / 3);
        const uint32_t knot = builder_.add_knot(now, {real(), real(), real()}, {}, {});
        builder_.add_part({{now, end, 1 + real(), 1 + real(), ray % 2, 0, true}, knot, 1});
        now = end + real() / 8;
      }
      builder_.add_ray({{}, 1, PixelRay::kAll, first, builder_.part_count() - first, 1});
    }
    return builder_.finish();
  }

 private:
  uint32_t seed_;
  RecordBuilder builder_{false};
};

class TimeFiles : public testing::Test {
 protected:
  TimeFiles() {
    shot_.projection.width = 70;
    shot_.projection.height = 40;
    shot_.meshes.resize(2);
    shot_.shutter_open = 2;
    shot_.shutter_close = 2.5;
    params_.shading = ShadingKind::flat;
    params_.crop = Crop{3, 68, 1, 38};
    path_ = folder_.path("picture.ktime");
  }

  /// Those pixels of the crop for which `which` says yes, in the order of the numbers.
  template <class Which>
  void add_pixels(PixelConsumer& consumer, const Which& which) {
    for (int y = params_.crop->y0; y < params_.crop->y1; ++y)
      for (int x = params_.crop->x0; x < params_.crop->x1; ++x)
        if (which(x, y) && !consumer.has(x, y)) consumer.add(pixels_.record(x, y));
  }
  static bool all(int, int) { return true; }

  void write(const TimeFileOptions& options = {}) {
    TimeFileWriter writer(path_, shot_, params_, options);
    add_pixels(writer, all);
    writer.finish();
  }
  TimePicture in_memory(double tolerance) {
    TimeFilm film(shot_, params_, tolerance, {}, true);
    add_pixels(film, all);
    return film.take();
  }
  static void expect_same(const Image& a, const Image& b) {
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (size_t c = 0; c < a.channels.size(); ++c) EXPECT_EQ(a.channels[c].values, b.channels[c].values);
  }
  static void expect_same(const ExposedObjects& a, const ExposedObjects& b) {
    EXPECT_EQ(a.first, b.first);
    ASSERT_EQ(a.seen.size(), b.seen.size());
    for (size_t i = 0; i < a.seen.size(); ++i) {
      const SeenObject &x = a.seen[i], &y = b.seen[i];
      ASSERT_EQ(std::tuple(x.mesh, x.colour.x, x.colour.y, x.colour.z, x.coverage, x.depth),
                std::tuple(y.mesh, y.colour.x, y.colour.y, y.colour.z, y.coverage, y.depth));
    }
  }
  /// Of opening and reading everything; empty where nothing is wrong.
  std::string message(const std::string& path) const {
    try {
      TimeFile::open(path).check();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input);
      return error.what();
    }
    return "";
  }

  TempFolder folder_;
  Shot shot_;
  RenderParams params_;
  PixelSource pixels_{test::seed()};
  std::string path_;
};

}  // namespace kairos
