#include "event_folder/folder_layout.h"

#include <array>
#include <cstdio>

#include <kairos/error.h>

namespace kairos {

std::string FolderPlan::place(const std::string& name) const {
  const std::filesystem::path path = folder / name;
  std::error_code failure;
  std::filesystem::create_directories(path.parent_path(), failure);
  if (failure) throw Error(ErrorCode::io, path.parent_path().string(), "cannot be made: " + failure.message());
  return path.string();
}

std::string FolderPlan::place(const char* pattern, int number) const {
  std::array<char, 128> name{};
  std::snprintf(name.data(), name.size(), pattern, number);
  return place(name.data());
}

void FolderPlan::write_picture(const Image& image, const std::string& path) const {
  write_image(image, path, view);
  if (exr) write_image(image, std::filesystem::path(path).replace_extension(".exr").string());
}

Image depth_picture(const Image& image) {
  Image grey = image;
  std::erase_if(grey.channels, [](const Channel& channel) { return channel.name != "depth.Z"; });
  grey.channels.front().name = "Y";
  grey.attributes.clear();  // of flow
  return grey;
}

std::string trajectory_line(int64_t time, const CameraPose& pose) {
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(), "%.9f %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", static_cast<double>(time) * 1e-9,
                pose[4], pose[5], pose[6], pose[1], pose[2], pose[3], pose[0]);
  return line.data();
}

}  // namespace kairos
