// Runs the built program as a shell would.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kairos {

struct CliResult {
  int status = -1;  ///< exit status; 128 + signal if it was killed
  std::string out, err;

  /// One line that begins with "kairos: ".
  bool one_line_error() const {
    return err.rfind("kairos: ", 0) == 0 && err.find('\n') == err.size() - 1 && out.empty();
  }
};

/// A folder of its own with a small scene in it: a bar that moves to the right in front of a square that stands still.
class CliTest : public testing::Test {
 protected:
  CliTest() {
    std::string name = (std::filesystem::temp_directory_path() / "kairos_cli_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    write("bar_0.obj", "v -1 -1 -2\nv -0.8 -1 -2\nv -0.8 1 -2\nv -1 1 -2\nf 1 2 3\nf 1 3 4\n");
    write("bar_1.obj", "v 0.8 -1 -2\nv 1 -1 -2\nv 1 1 -2\nv 0.8 1 -2\nf 1 2 3\nf 1 3 4\n");
    write("square.obj", "v -1 -1 -3\nv 1 -1 -3\nv 1 1 -3\nv -1 1 -3\nf 1 2 3 4\n");
    write("scene.json", R"({"kairos": 1,
      "meshes": [{"name": "bar", "keys": ["bar_0.obj", "bar_1.obj"], "material": "green"},
                 {"name": "square \"x\"", "keys": ["square.obj"]}],
      "materials": {"green": {"base_color": [0, 1, 0]}},
      "camera": {"vfov_degrees": 60, "keys": [{"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]}]},
      "image": {"width": 32, "height": 20}, "background": [0.25, 0, 0]})");
  }
  ~CliTest() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  static std::string read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  size_t files() const { return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder_), {})); }

  /// arguments: as a shell reads them, in the test's folder; they may send standard error elsewhere. before: what the
  /// shell does first.
  CliResult run(const std::string& arguments, const std::string& before = {}) const {
    const std::string command = "cd '" + folder_.string() + "'; exec > '" + output_.string() + ".out' 2> '" +
                                output_.string() + ".err'; " + before + "'" KAIROS_CLI "' " + arguments;
    const int status = std::system(command.c_str());
    CliResult result;
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = read(output_.string() + ".out");
    result.err = read(output_.string() + ".err");
    std::filesystem::remove(output_.string() + ".out");
    std::filesystem::remove(output_.string() + ".err");
    return result;
  }

  std::filesystem::path folder_;

 private:
  const std::filesystem::path output_ =
      std::filesystem::temp_directory_path() / ("kairos_cli_output_" + std::to_string(getpid()));
};

}  // namespace kairos
