// Files are read in their size of memory, and up to a limit.
#include "base/file.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <kairos/error.h>

#include "error_matchers.h"
#include "temp_folder.h"

namespace kairos {
namespace {

std::string text_of(size_t size) {
  std::string text(size, '\0');
  for (size_t i = 0; i < size; ++i) text[i] = static_cast<char>(i * 31 + i / 251);
  return text;
}

TEST(ReadFile, TakesNoMoreMemoryThanTheFileIsLarge) {
  const TempFolder folder;
  for (const size_t size : {0, 1, 65535, 65536, 65537, 3'000'000}) {
    const std::string path = folder.write("a", text_of(size));
    const std::vector<uint8_t> bytes = read_file(path, size);
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), text_of(size)) << size;
    EXPECT_EQ(bytes.capacity(), size);
    EXPECT_THROW(read_file(folder.write("a", text_of(size + 1)), size), Error);
  }
}

TEST(ReadFile, WhatIsNoFileIsRefusedAtOnce) {
  const TempFolder folder;
  ASSERT_EQ(mkfifo(folder.path("pipe").c_str(), 0600), 0);
  expect_error([&] { read_file(folder.path("pipe"), 10); }, {"pipe: is no file"}, ErrorCode::io);
  expect_error([] { read_file("/dev/zero", 10); }, {"/dev/zero: is no file"}, ErrorCode::io);
  expect_error([&] { read_file(folder.path("."), 10); }, {"is a folder"}, ErrorCode::io);
  expect_error([&] { read_file(folder.path("none"), 10); }, {"none: cannot be opened"}, ErrorCode::io);
  std::filesystem::create_symlink(folder.write("real", "text"), folder.path("link"));
  EXPECT_EQ(read_file(folder.path("link"), 10).size(), 4u);
}

class SceneFolderTest : public testing::Test {
 protected:
  SceneFolderTest() {
    folder_.write("root/scene/a.json", "");
    folder_.write("root/textures/red.png", "");
    folder_.write("outside.png", "");
    std::filesystem::create_symlink(folder_.path("outside.png"), folder_.path("root/scene/link.png"));
  }

  bool allows(const SceneFolder& where, const std::string& name) const {
    std::string problem;
    const std::string path = where.try_resolve(name, problem);
    EXPECT_EQ(path.empty(), !problem.empty());
    return problem.empty();
  }

  TempFolder folder_;
  const std::string scene_ = folder_.path("root/scene"), root_ = folder_.path("root");
};

TEST_F(SceneFolderTest, WithoutARootNamesStayInTheFolder) {
  const SceneFolder where{scene_, ""};
  EXPECT_EQ(where.resolve("a.json", "x"), scene_ + "/a.json");
  for (const char* name : {"a.json", "./a.json", "not_there.png", "deeper/x/../y.png", "../scene/a.json"})
    EXPECT_TRUE(allows(where, name)) << name;
  EXPECT_TRUE(allows(where, scene_ + "/a.json"));
  for (const char* name : {"", "../textures/red.png", "/etc/passwd", "x/../../outside.png", "link.png", "..", "\\x"})
    EXPECT_FALSE(allows(where, name)) << name;
  EXPECT_FALSE(allows(where, std::string("a\0.json", 7)));
  expect_error([&] { where.resolve("../textures/red.png", "s.json: m"); },
               {"s.json: m: path '../textures/red.png'", "--root"});
}

TEST_F(SceneFolderTest, WithARootNamesStayInThat) {
  const SceneFolder where{scene_, root_};
  EXPECT_TRUE(std::filesystem::equivalent(where.resolve("../textures/red.png", "x"), root_ + "/textures/red.png"));
  for (const std::string& name :
       {std::string("../../outside.png"), std::string("link.png"), folder_.path("outside.png")})
    EXPECT_FALSE(allows(where, name)) << name;
  EXPECT_TRUE(allows(where, root_ + "/textures/red.png"));
  EXPECT_FALSE(allows({scene_, root_ + "/textures"}, "a.json")) << "not even beside the scene";
  EXPECT_FALSE(allows({scene_, root_ + "/scen"}, "a.json")) << "a folder, not the beginning of its name";
}

}  // namespace
}  // namespace kairos
