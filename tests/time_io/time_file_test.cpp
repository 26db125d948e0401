// Files of pictures over time: what was written is read.
#include <cmath>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include <kairos/time_file.h>

#include "time_files.h"

namespace kairos {
namespace {

TEST_F(TimeFiles, HoldWhatAFilmHolds) {
  for (const double tolerance : {0.0, 0x1p-10}) {
    write({tolerance, {2, 25}, "mark", true});
    const TimeFile file = TimeFile::open(path_);
    file.check();
    const TimePicture memory = in_memory(tolerance);
    const TimeWeight weight({{0.125, 2}, {0.625, 2}});
    ExposeOptions options;
    options.coverage = true;
    expect_same(file.picture().expose(weight, options), memory.expose(weight, options));
    expect_same(file.picture().at(0.3), memory.at(0.3));
    const PixelWeights weights{[&](int, int) { return weight; }};
    expect_same(file.picture().objects(weights), memory.objects(weights));
    expect_same(file.picture().objects_at(0.3), memory.objects_at(0.3));
    EXPECT_GT(memory.objects(weights).seen.size(), size_t{65} * 37) << "two meshes in most pixels";
    const TimeQuality quality = file.picture().quality(), wanted = memory.quality();
    EXPECT_EQ(quality.tolerance, tolerance);
    EXPECT_EQ(quality.deviation, wanted.deviation);
    EXPECT_EQ(quality.rounding, wanted.rounding);
    EXPECT_EQ(quality.pieces, wanted.pieces);
    EXPECT_EQ(quality.missing, 0u);
    const TimeFrame& frame = file.picture().frame();
    EXPECT_EQ(frame.left, 3);
    EXPECT_EQ(frame.height, 37);
    EXPECT_EQ(frame.frame_width, 70);
    EXPECT_EQ(frame.open, 2);
    EXPECT_EQ(frame.close, 2.5);
    EXPECT_EQ(frame.frame_time, 2);
    EXPECT_EQ(frame.fps, 25);
    EXPECT_EQ(frame.attributes.size(), memory.frame().attributes.size());
    EXPECT_TRUE(file.info().finished);
    EXPECT_EQ(file.info().bytes, bytes_of(path_).size());
    EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
  }
}

// Three slabs of time, each of which shows other things, are one picture: what each shows in its third of the time.
TEST_F(TimeFiles, HoldSlabsOfTime) {
  const uint32_t seed = test::seed();
  params_.crop = Crop{20, 40, 10, 14};
  for (const double tolerance : {0.0, 0x1p-10}) {
    TimeFileOptions options{tolerance, {}, "", true};
    options.slabs = 3;
    const auto add_slab = [&](TimeFileWriter& writer, int slab) {
      pixels_ = PixelSource(seed + static_cast<uint32_t>(slab));
      writer.begin_slab(slab);
      add_pixels(writer, all);
    };
    {
      TimeFileWriter writer(path_, shot_, params_, options);
      EXPECT_EQ(writer.tiles(), 3u);
      for (const int slab : {0, 1, 2}) add_slab(writer, slab);
      writer.finish();
    }
    const std::string whole = bytes_of(path_);
    std::vector<TimePicture> slabs;
    for (const uint32_t slab : {0u, 1u, 2u}) {
      pixels_ = PixelSource(seed + slab);
      slabs.push_back(in_memory(tolerance));
    }
    const TimeFile file = TimeFile::open(path_);
    file.check();
    EXPECT_EQ(file.info().slabs, 3);
    const TimePicture& all_of_it = file.picture();
    EXPECT_EQ(all_of_it.quality().tolerance, tolerance / 3);
    EXPECT_EQ(all_of_it.quality().missing, 0u);
    EXPECT_EQ(all_of_it.quality().pieces,
              slabs[0].quality().pieces + slabs[1].quality().pieces + slabs[2].quality().pieces);
    // A box over the end of the first, all of the second and the beginning of the third.
    const auto near = [](const Image& a, const std::vector<std::pair<Image, double>>& parts) {
      for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < a.channels[c].values.size(); ++i) {
          double sum = 0;
          for (const auto& [image, share] : parts) sum += share * static_cast<double>(image.channels[c].values[i]);
          ASSERT_NEAR(a.channels[c].values[i], sum, 1e-5);
        }
    };
    const auto box = [](double begin, double end) {
      return TimeWeight({{begin, 1 / (end - begin)}, {end, 1 / (end - begin)}});
    };
    near(all_of_it.expose(box(0.25, 0.75)), {{slabs[0].expose(box(0.75, 1)), 1 / 6.0},
                                             {slabs[1].expose(), 2 / 3.0},
                                             {slabs[2].expose(box(0, 0.25)), 1 / 6.0}});
    near(all_of_it.expose(box(0.4, 0.5)), {{slabs[1].expose(box(0.2, 0.5)), 1.0}});
    near(all_of_it.at(0.9), {{slabs[2].at(0.7), 1.0}});
    const auto seen_in_all = all_of_it.objects({[&](int, int) { return box(0.4, 0.5); }});
    const auto seen = slabs[1].objects({[&](int, int) { return box(0.2, 0.5); }});
    ASSERT_EQ(seen_in_all.first, seen.first);
    for (size_t i = 0; i < seen.seen.size(); ++i) {
      EXPECT_EQ(seen_in_all.seen[i].mesh, seen.seen[i].mesh);
      EXPECT_NEAR(seen_in_all.seen[i].coverage, seen.seen[i].coverage, 1e-5);
      EXPECT_NEAR(seen_in_all.seen[i].depth, seen.seen[i].depth, 1e-3);
    }
    EXPECT_THAT(message(path_), "");

    // Whatever ends a recording, the slabs that are there are kept.
    {
      TimeFileWriter writer(path_, shot_, params_, options);
      add_slab(writer, 1);
      writer.begin_slab(0);
    }
    const TimePicture part = TimeFile::open(path_ + ".part").picture();
    near(part.expose(box(0.25, 0.75)), {{slabs[1].expose(), 2 / 3.0}});
    EXPECT_EQ(part.quality().missing, size_t{20} * 4);
    TimeFileWriter writer(path_, shot_, params_, options);
    EXPECT_EQ(writer.tiles_before(), 1u);
    EXPECT_FALSE(writer.slab_is_there(0));
    EXPECT_TRUE(writer.slab_is_there(1));
    for (const int slab : {2, 0}) add_slab(writer, slab);
    writer.finish();
    EXPECT_TRUE(bytes_of(path_) == whole);
    // In parts, which are merged.
    std::vector<std::string> parts;
    for (const int slab : {0, 2, 1}) {
      TimeFileWriter of_part(parts.emplace_back(folder_.path("part" + std::to_string(slab))), shot_, params_, options);
      add_slab(of_part, slab);
      of_part.finish_part();
    }
    merge_time_files(parts, path_);
    EXPECT_TRUE(bytes_of(path_) == whole);
  }
}

/// Looks whether records are those that pixels hand over, in all of their numbers.
class SameRecords : public PixelConsumer {
 public:
  explicit SameRecords(uint32_t seed) : pixels_(seed) {}

  RecordNeeds needs() const override { return {}; }
  void add(const PixelRecord& record) override {
    ++count;
    const PixelRecord& wanted = pixels_.record(record.x, record.y);
    ASSERT_EQ(record.background.x, wanted.background.x);
    ASSERT_EQ(record.window.end, wanted.window.end);
    ASSERT_EQ(record.rays.size(), wanted.rays.size());
    ASSERT_EQ(record.parts.size(), wanted.parts.size());
    ASSERT_EQ(record.knots.size(), wanted.knots.size());
    for (size_t i = 0; i < record.rays.size(); ++i) {
      const PixelRay &a = record.rays[i], &b = wanted.rays[i];
      ASSERT_TRUE(a.is_over_time());
      ASSERT_EQ(std::tuple(a.film.x, a.film.y, a.weight, a.first_part, a.parts, a.visibility_segments, a.density),
                std::tuple(b.film.x, b.film.y, b.weight, b.first_part, b.parts, b.visibility_segments, b.density));
    }
    for (size_t i = 0; i < record.parts.size(); ++i) {
      const SeenPart &a = record.parts[i], &b = wanted.parts[i];
      ASSERT_EQ(std::tuple(a.where.begin, a.where.end, a.where.dist_begin, a.where.dist_end, a.where.mesh,
                           a.where.triangle, a.where.front, a.first_knot, a.knots, a.layer, a.opacity),
                std::tuple(b.where.begin, b.where.end, b.where.dist_begin, b.where.dist_end, b.where.mesh,
                           b.where.triangle, b.where.front, b.first_knot, b.knots, b.layer, b.opacity));
    }
    for (size_t i = 0; i < record.knots.size(); ++i) {
      const Knot &a = record.knots[i], &b = wanted.knots[i];
      ASSERT_EQ(std::tuple(a.time, a.colour.x, a.colour.y, a.colour.z),
                std::tuple(b.time, b.colour.x, b.colour.y, b.colour.z));
    }
  }

  size_t count = 0;

 private:
  PixelSource pixels_;
};

TEST_F(TimeFiles, HandOverRecordsAgain) {
  const uint32_t seed = test::seed();
  TimeFileOptions options;
  options.rays = true;
  options.slabs = 2;
  TimeFileWriter writer(path_, shot_, params_, options);
  for (const uint32_t slab : {0u, 1u}) {
    pixels_ = PixelSource(seed + slab);
    writer.begin_slab(static_cast<int>(slab));
    add_pixels(writer, all);
  }
  writer.finish();
  const TimeFile file = TimeFile::open(path_);
  ASSERT_TRUE(file.has_rays());
  for (const uint32_t slab : {0u, 1u}) {
    SameRecords same(seed + slab);
    file.replay(same, static_cast<int>(slab));
    EXPECT_EQ(same.count, size_t{65} * 37);
  }
  // Deep samples of segments, across the border of the slabs, are the exposure, and say when they were seen.
  const PixelWeights weights{[](int, int) { return TimeWeight({{0.25, 0}, {0.5, 8 / 3.0}, {0.75, 8 / 3.0}}); }};
  ExposeOptions with_coverage;
  with_coverage.coverage = true;
  const Image image = file.picture().expose(weights, with_coverage);
  const DeepImage deep = deep_segments(image, file, weights);
  const auto values = [&](const char* name) -> const std::vector<float>& { return deep.image.find(name)->values; };
  for (size_t pixel = 0; pixel + 1 < deep.first.size(); ++pixel) {
    double red = 0, open = 1, covered = 0;
    for (size_t i = deep.first[pixel]; i < deep.first[pixel + 1]; ++i) {
      red += open * static_cast<double>(values("R")[i]);
      if (values("id")[i] > 0) covered += open * static_cast<double>(values("A")[i]);
      open *= 1 - static_cast<double>(values("A")[i]);
      ASSERT_TRUE(i == deep.first[pixel] || values("Z")[i] > values("Z")[i - 1]);
      if (values("id")[i] > 0) {
        ASSERT_TRUE(values("time.begin")[i] >= 0.25f && values("time.begin")[i] < values("time.end")[i] &&
                    values("time.end")[i] <= 0.75f);
      }
    }
    ASSERT_NEAR(red, image.channels[0].values[pixel], 1e-5);
    ASSERT_NEAR(open, 0, 2e-4);
    ASSERT_NEAR(covered, image.channels[3].values[pixel], 1e-3);
  }
  SameRecords same(seed);
  EXPECT_THROW(file.replay(same, 2), Error);
  EXPECT_THROW(file.replay(same, 0, [](double) { return false; }), Error);
  write();
  EXPECT_THROW(TimeFile::open(path_).replay(same), Error);
}

// Vertices of two keys on a straight line, cut out of the middle; a camera that turns and travels; what blends.
TEST_F(TimeFiles, HoldWhereEverythingIs) {
  const auto turned = [](double time) {
    const double angle = 1.5 * time;
    return std::array<Vec3d, 3>{Vec3d{std::cos(angle), 0, -std::sin(angle)}, Vec3d{0, 1, 0},
                                Vec3d{std::sin(angle), 0, std::cos(angle)}};
  };
  Mesh& mesh = shot_.meshes[0];
  mesh.name = "moves";
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = {0, 0.5f, 1};
  mesh.positions = {
      {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}, {{0, 4, -1}, {1, 4, -1}, {0, 5, -1}}, {{2, 4, -1}, {3, 4, -1}, {2, 5, -1}}};
  mesh.one_sided = true;
  shot_.meshes[1] = mesh;
  shot_.meshes[1].material = 1;
  shot_.materials.resize(2);
  shot_.materials[1].alpha_mode = Material::AlphaMode::blend;
  shot_.camera_moves = true;
  shot_.world_from_camera = turned;
  shot_.camera_position = [](double time) { return Vec3d{time, 2, 3}; };
  shot_.projection.shift = {0.1, 0.2};
  write({0x1p-6, {}, "", true, true});
  const TimeFile file = TimeFile::open(path_);
  ASSERT_TRUE(file.has_geometry());
  const Shot whole = file.shot(2, 2.5);
  EXPECT_EQ(whole.meshes[0].positions.size(), 3u);
  EXPECT_EQ(whole.meshes[0].key_times[1], 0.5f);
  EXPECT_EQ(whole.projection.shift[1], 0.2);
  EXPECT_TRUE(whole.meshes[1].triangles.empty()) << "blends";

  const Shot part = file.shot(2.125, 2.375);
  const Mesh& cut = part.meshes[0];
  EXPECT_EQ(cut.name, "moves");
  EXPECT_TRUE(cut.one_sided);
  ASSERT_EQ(cut.key_times, (std::vector<float>{0, 0.5f, 1}));
  EXPECT_EQ(cut.positions[0][1].y, 2);
  EXPECT_EQ(cut.positions[1][0].y, 4);
  EXPECT_EQ(cut.positions[2][2].x, 1);
  for (const double time : {0.0, 0.3, 1.0}) {
    const auto axes = part.world_from_camera(time), wanted = turned(0.25 + time / 2);
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(length(axes[i] - wanted[i]), 0, 2e-6);
    EXPECT_NEAR(part.camera_position(time).x, 0.25 + time / 2, 1e-9);
  }
  EXPECT_THROW(file.shot(1.9, 2.5), Error);
  EXPECT_THROW(file.shot(2.5, 2.5), Error);
}

}  // namespace
}  // namespace kairos
