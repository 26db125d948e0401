#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/image.h>

#include "base/atomic_file.h"
#include "base/file.h"
#include "image/read_exr.h"
#include "image/srgb.h"
#include "image/write_png.h"

namespace kairos {
namespace {

namespace fs = std::filesystem;

class Output : public testing::Test {
 protected:
  Output() {
    std::string name = (fs::temp_directory_path() / "kairos_output_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Output() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  size_t files() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

Image picture() {
  Image image;
  image.width = 5;
  image.height = 3;
  image.left = 2;
  image.top = 4;
  image.frame_width = 20;
  image.frame_height = 10;
  int next = 0;
  for (const char* name : {"B", "G", "R"}) {
    image.channels.push_back({name, Channel::Storage::colour, std::vector<float>(15)});
    for (float& value : image.channels.back().values) value = 0.1f * static_cast<float>(++next);
  }
  image.channels.push_back({"depth.Z", Channel::Storage::exact, std::vector<float>(15, 1.0f / 3)});
  image.channels.back().values[4] = std::numeric_limits<float>::infinity();
  image.channels.push_back({"mesh.id", Channel::Storage::integer, std::vector<float>(15, 16777215)});
  image.attributes = {{"kairos:command_line", std::string("kairos render 'a b'")},
                      {"kairos:mesh_names", std::vector<std::string>{"a", "b c"}},
                      {"kairos:render_seconds", 1.5},
                      {"kairos:samples", 64},
                      {"kairos:shutter", std::array<double, 2>{0.1, 0.2}}};
  return image;
}

const Attribute* attribute(const Image& image, const std::string& name) {
  for (const Attribute& a : image.attributes)
    if (a.name == name) return &a;
  return nullptr;
}

TEST_F(Output, ExrComesBackAsItWas) {
  const Image image = picture();
  write_image(image, path("a.exr"));
  const Image back = read_exr(path("a.exr"));
  EXPECT_EQ(back.width, 5);
  EXPECT_EQ(back.height, 3);
  EXPECT_EQ(back.left, 2);
  EXPECT_EQ(back.top, 4);
  EXPECT_EQ(back.frame_width, 20);
  EXPECT_EQ(back.frame_height, 10);
  ASSERT_EQ(back.channels.size(), image.channels.size());
  for (const Channel& channel : image.channels) {
    ASSERT_NE(back.find(channel.name), nullptr) << channel.name;
    EXPECT_EQ(back.find(channel.name)->values, channel.values) << channel.name;
  }
  for (const Attribute& written : image.attributes) {
    ASSERT_NE(attribute(back, written.name), nullptr) << written.name;
    EXPECT_EQ(attribute(back, written.name)->value, written.value) << written.name;
  }
  EXPECT_EQ(files(), 1u) << "the temporary file is gone";
}

TEST_F(Output, HalfRoundsColoursOnlyAndNeverToInfinity) {
  Image image = picture();
  image.channels[0].values[0] = 1e6f;
  write_image(image, path("a.exr"), {.half = true});
  const Image back = read_exr(path("a.exr"));
  EXPECT_EQ(back.find("B")->values[0], 65504);
  EXPECT_NE(back.find("B")->values[2], image.channels[0].values[2]);
  EXPECT_NEAR(back.find("B")->values[2], image.channels[0].values[2], 1e-3);
  EXPECT_EQ(back.find("depth.Z")->values, image.channels[3].values);
  EXPECT_EQ(back.find("mesh.id")->values, image.channels[4].values);
}

TEST_F(Output, PngIsSrgbOfTheColour) {
  EXPECT_EQ(srgb_code(0), 0);
  EXPECT_EQ(srgb_code(1), 255);
  EXPECT_EQ(srgb_code(7), 255);
  EXPECT_EQ(srgb_code(-1), 0);
  EXPECT_EQ(srgb_code(std::nanf("")), 0);
  EXPECT_EQ(srgb_code(0.2140f), 127);  // IEC 61966-2-1
  EXPECT_EQ(srgb_code(0.002f), 7);     // its straight part: 12.92 * 0.002 * 255
  write_image(picture(), path("a.PNG"));
  const auto bytes = read_file(path("a.PNG"), 1 << 20);
  ASSERT_GT(bytes.size(), 24u);
  EXPECT_EQ(std::string(bytes.begin() + 1, bytes.begin() + 4), "PNG");
  EXPECT_EQ(bytes[19], 5) << "width";
  EXPECT_EQ(bytes[23], 3) << "height";
  EXPECT_EQ(files(), 1u);
}

TEST_F(Output, AnExtensionMayBeTheWholeName) {
  write_image(picture(), path(".exr"));
  EXPECT_EQ(read_exr(path(".exr")).width, 5);
}

TEST_F(Output, RefusesOtherExtensionsAsBadUsage) {
  for (const char* name : {"a.jpg", "a", "exr", "", "a.exr.gz"}) try {
      check_writable_image(path(name));
      FAIL() << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::bad_usage);
    }
}

TEST_F(Output, WhatCannotBeWrittenIsKnownBefore) {
  fs::create_directory(path("folder.exr"));
  for (const std::string& name : {path("missing/a.exr"), path("folder.exr"), path(std::string(300, 'a') + ".exr")})
    try {
      check_writable_image(name);
      FAIL() << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::io) << e.what();
    }
  check_writable_image(path("a.exr"));
  EXPECT_EQ(files(), 1u) << "trying leaves nothing behind";
}

TEST_F(Output, AnAbandonedFileLeavesTheOldOneAlone) {
  std::ofstream(path("a")) << "old";
  {
    AtomicFile file(path("a"));
    file.write("new", 3);
  }
  EXPECT_EQ(read_file(path("a"), 10).size(), 3u);
  EXPECT_EQ(read_file(path("a"), 10)[0], 'o');
  EXPECT_EQ(files(), 1u);
  AtomicFile file(path("a"));
  file.write("newer", 5);
  file.commit();
  EXPECT_EQ(read_file(path("a"), 10).size(), 5u);
}

TEST_F(Output, WritesThroughASymbolicLink) {
  std::ofstream(path("real")) << "old";
  fs::create_symlink(path("real"), path("link"));
  AtomicFile file(path("link"));
  file.write("newer", 5);
  file.commit();
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(read_file(path("real"), 10).size(), 5u);
}

TEST_F(Output, WritesWhatADanglingLinkStandsFor) {
  fs::create_directory(path("folder"));
  fs::create_symlink("folder/real", path("link"));
  AtomicFile file(path("link"));
  file.write("newer", 5);
  file.commit();
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(read_file(path("folder/real"), 10).size(), 5u);
  fs::create_symlink("loop", path("loop"));
  EXPECT_THROW(AtomicFile(path("loop")), Error);
}

// Two at once, in threads or in containers that count processes alike, and a name that somebody has put a link at.
TEST_F(Output, WritersOfOneFileDoNotMeet) {
  AtomicFile first(path("a")), second(path("a"));
  EXPECT_EQ(files(), 2u);
  first.write("first", 5);
  second.write("2nd", 3);
  second.commit();
  EXPECT_EQ(read_file(path("a"), 10).size(), 3u);
  first.commit();
  EXPECT_EQ(read_file(path("a"), 10).size(), 5u);
  EXPECT_EQ(files(), 1u);
}

TEST_F(Output, AnyNameOfAFileWillDo) {
  const std::string longest(255, 'a');
  AtomicFile file(path(longest));
  file.write("newer", 5);
  file.commit();
  EXPECT_EQ(read_file(path(longest), 10).size(), 5u);
}

TEST_F(Output, AReplacedFileHandsOnItsPermissions) {
  std::ofstream(path("a")) << "old";
  fs::permissions(path("a"), fs::perms::owner_read | fs::perms::owner_write);
  AtomicFile file(path("a"));
  file.commit();
  EXPECT_EQ(fs::status(path("a")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Output, DevicesAreNotReplaced) { EXPECT_THROW(AtomicFile("/dev/null"), Error); }

TEST_F(Output, DamagedExrFilesAreRefused) {
  write_image(picture(), path("a.exr"));
  const auto bytes = read_file(path("a.exr"), 1 << 20);
  int refused = 0;
  const auto try_bytes = [&](const std::vector<uint8_t>& damaged) {
    std::ofstream(path("b.exr"), std::ios::binary)
        .write(reinterpret_cast<const char*>(damaged.data()), static_cast<std::streamsize>(damaged.size()));
    try {
      read_exr(path("b.exr"), 1 << 20);
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  };
  for (size_t size = 0; size < bytes.size(); size += 7)
    try_bytes({bytes.begin(), bytes.begin() + static_cast<long>(size)});
  EXPECT_EQ(refused, static_cast<int>((bytes.size() + 6) / 7));
  for (size_t i = 0; i < bytes.size(); ++i) {  // must not crash; what it reads is another matter
    auto damaged = bytes;
    damaged[i] = static_cast<uint8_t>(damaged[i] ^ 0x55);
    try_bytes(damaged);
  }
  EXPECT_THROW(read_exr(path("none.exr")), Error);
  EXPECT_THROW(read_exr(path("a.exr"), 100), Error) << "over the limit";
}

TEST_F(Output, PngHasStraightAlphaAndColoursOfTheView) {
  Image image{4, 1, 0, 0, 4, 1, {}, {}};
  const auto add = [&](const char* name, std::vector<float> values) {
    image.channels.push_back({name, Channel::Storage::colour, std::move(values)});
  };
  add("R", {0.25f, 0, 0.125f, 1});
  add("G", {0, 0, 0.125f, 1});
  add("B", {0, 0, 0.125f, 1});
  add("A", {0.5f, 0, 1, 1.0f + 1e-6f});
  write_image(image, path("a.png"));
  const Image straight = read_image(path("a.png"));
  const auto values = [&](const Image& read, const char* name) { return read.find(name)->values; };
  ASSERT_NE(straight.find("A"), nullptr);
  EXPECT_NEAR(values(straight, "A")[0], 128.0f / 255, 1e-6);
  EXPECT_NEAR(values(straight, "R")[0], 0.5, 0.003) << "divided by its alpha";
  EXPECT_EQ(values(straight, "A")[1], 0);
  EXPECT_EQ(values(straight, "R")[1], 0);
  EXPECT_EQ(values(straight, "A")[3], 1);
  EXPECT_EQ(values(straight, "R")[3], 1);

  WriteOptions options;
  options.view = ViewTransform::filmic;
  options.exposure = 1;
  write_image(image, path("b.png"), options);
  const Image seen = read_image(path("b.png"));
  EXPECT_NEAR(values(seen, "G")[2], 0.25, 0.003);
  EXPECT_NEAR(values(seen, "R")[3], 1 - 0.09 / 1.6, 0.004) << "radiance 2 on the shoulder";
  write_image(image, path("a.exr"), options);
  EXPECT_EQ(values(read_image(path("a.exr")), "R"), image.channels[0].values) << "EXR holds what was rendered";
  EXPECT_EQ(values(read_image(path("a.exr")), "A"), image.channels[3].values);
  options.exposure = 101;
  EXPECT_THROW(write_image(image, path("c.png"), options), Error);
}

}  // namespace
}  // namespace kairos
