// Files of pictures over time that were left unfinished, cut off or damaged.
#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/time_file.h>

#include "time_files.h"

namespace kairos {
namespace {

using testing::HasSubstr;

TEST_F(TimeFiles, GoOnWhereTheyWereLeft) {
  write();
  const std::string whole = bytes_of(path_);
  std::filesystem::remove(path_);
  const auto is_right = [](int x, int) { return x >= 32 + 3; };
  {
    TimeFileWriter writer(path_, shot_, params_);
    EXPECT_EQ(writer.tiles_before(), 0u);
    EXPECT_EQ(writer.tiles(), 6u);
    add_pixels(writer, is_right);
    try {
      writer.finish();
      ADD_FAILURE() << "pixels are missing";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("not finished"));
    }
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
  const TimeFile part = TimeFile::open(path_ + ".part");
  EXPECT_FALSE(part.info().finished);
  EXPECT_EQ(part.info().tiles_there, 4u);
  EXPECT_FALSE(part.picture().signal(35, 1).empty());
  EXPECT_TRUE(part.picture().signal(34, 1).empty());
  // As if ended in the middle of a chunk.
  std::filesystem::resize_file(path_ + ".part", std::filesystem::file_size(path_ + ".part") - 20);
  {
    TimeFileWriter writer(path_, shot_, params_);
    EXPECT_EQ(writer.tiles_before(), 3u);
    EXPECT_TRUE(writer.has(35, 1));
    EXPECT_FALSE(writer.has(3, 1));
    add_pixels(writer, [](int, int y) { return y >= 32 + 1; });
  }
  {
    TimeFileWriter writer(path_, shot_, params_);
    EXPECT_EQ(writer.tiles_before(), 5u) << "one of the lower three was there";
    add_pixels(writer, all);
    writer.finish();
  }
  EXPECT_EQ(bytes_of(path_), whole) << "whatever the order in which tiles were complete";
}

TEST_F(TimeFiles, EveryPrefixOfAPartIsContinuedOrBegun) {
  TimeFileOptions options;
  options.objects = options.geometry = true;
  write(options);
  const std::string whole = bytes_of(path_);
  std::string part;
  {
    TimeFileWriter writer(path_, shot_, params_, options);
    add_pixels(writer, all);
    part = bytes_of(path_ + ".part");
  }
  std::mt19937 random(test::seed());
  for (int i = 0; i < 12; ++i) {
    const size_t size = i == 0 ? 0 : i == 1 ? 63 : std::uniform_int_distribution<size_t>(1100, part.size())(random);
    put_bytes(path_ + ".part", part.substr(0, size));
    TimeFileWriter writer(path_, shot_, params_, options);
    add_pixels(writer, all);
    writer.finish();
    ASSERT_EQ(bytes_of(path_), whole) << size << " bytes were there";
  }
}

TEST_F(TimeFiles, DoNotGoOnWithAnotherRendering) {
  const auto refusal = [&](const TimeFileOptions& options) {
    try {
      const TimeFileWriter writer(path_, shot_, params_, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal({0x1p-10, {}, "a"}), "");
  EXPECT_EQ(refusal({0x1p-10, {}, "a"}), "");
  EXPECT_THAT(refusal({0x1p-10, {}, "b"}), HasSubstr("of another rendering"));
  EXPECT_THAT(refusal({0x1p-11, {}, "a"}), HasSubstr("of another rendering"));
  EXPECT_THAT(refusal({0x1p-11, {}, "a"}), HasSubstr(path_ + ".part"));
}

TEST_F(TimeFiles, AreWrittenByOneAtATime) {
  const TimeFileWriter writer(path_, shot_, params_);
  EXPECT_THROW(TimeFileWriter(path_, shot_, params_), Error);
}

TEST_F(TimeFiles, NoPrefixIsTakenForAWholeFile) {
  params_.crop = Crop{0, 3, 0, 2};
  write({0x1p-6, {}, "", true, true, true});
  const std::string whole = bytes_of(path_);
  EXPECT_EQ(message(path_), "");
  for (size_t size = whole.size(); size-- > 0;) {
    std::filesystem::resize_file(path_, size);
    ASSERT_THAT(message(path_), HasSubstr(path_)) << size;
  }
  put_bytes(path_, whole + "\n");
  EXPECT_THAT(message(path_), HasSubstr("has grown"));
}

TEST_F(TimeFiles, NoFlippedByteGoesUnnoticed) {
  params_.crop = Crop{0, 3, 0, 2};
  write({0x1p-6, {}, "", true, true, true});
  const std::string whole = bytes_of(path_);
  const Image right = TimeFile::open(path_).picture().expose();
  const ExposedObjects objects = TimeFile::open(path_).picture().objects_at(0.5);
  std::mt19937 random(test::seed());
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  const auto put_byte = [&](size_t i, int byte) {
    file.seekp(static_cast<std::streamoff>(i)).put(static_cast<char>(byte)).flush();
  };
  for (size_t i = 0; i < whole.size(); ++i)
    for (const int flip : {1, std::uniform_int_distribution<>(2, 255)(random)}) {  // a digit becomes another one
      put_byte(i, whole[i] ^ flip);
      if (message(path_).empty()) {
        const TimeFile same = TimeFile::open(path_);
        expect_same(same.picture().expose(), right);
        expect_same(same.picture().objects_at(0.5), objects);
        EXPECT_EQ(same.picture().frame().open, 2);
        EXPECT_EQ(same.picture().frame().close, 2.5);
        EXPECT_EQ(same.picture().frame().fps, 24);
        EXPECT_EQ(same.picture().frame().frame_width, 70);
      }
      put_byte(i, whole[i]);
    }
}

TEST_F(TimeFiles, OtherFilesAreRefusedInOneLine) {
  put_bytes(path_, std::string(1000, 'x'));
  EXPECT_THAT(message(path_), HasSubstr("is no picture over time"));
  EXPECT_THROW(TimeFile::open(path_ + "x"), Error);
  EXPECT_THROW(TimeFile::open(folder_.path("")), Error);
}

}  // namespace
}  // namespace kairos
