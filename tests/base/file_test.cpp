// Files are read in their size of memory, and up to a limit.
#include "base/file.h"

#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <kairos/error.h>

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

TEST(ReadFile, ReadsPipesToTheirEnd) {
  const TempFolder folder;
  const std::string pipe = folder.path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const size_t size : {0, 1, 65536, 300'000}) {
    std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << text_of(size); });
    const std::vector<uint8_t> bytes = read_file(pipe, 300'000);
    writer.join();
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), text_of(size));
  }
  std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << text_of(10); });
  EXPECT_THROW(read_file(pipe, 9), Error);
  writer.join();
}

}  // namespace
}  // namespace kairos
