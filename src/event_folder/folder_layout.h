// What a folder of a recording holds, and how: one kind for each data set.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kairos/camera_pose.h>
#include <kairos/event_file.h>
#include <kairos/event_folder.h>
#include <kairos/image.h>

namespace kairos {

/// What a layout is told.
struct FolderPlan {
  std::filesystem::path folder;
  int width, height;
  Intrinsics lens;
  size_t meshes;  ///< that masks may number, from 1
  EventFileOptions file;
  WriteOptions view;  ///< of PNGs
  bool exr;

  /// The path of a file of it, in a folder that is there. Throws Error(io).
  std::string place(const std::string& name) const;
  /// `pattern`: printf's, of the number.
  std::string place(const char* pattern, int number) const;
  /// A PNG, and an EXR beside it where they are wanted.
  void write_picture(const Image& image, const std::string& path) const;
  /// Nanoseconds of a stamp in files whose events have the epoch in them.
  int64_t stamp(int64_t time) const { return time + file.epoch; }
};

using CameraPose = std::array<double, 7>;  // camera_pose's, looking along z

/// All that is known of an instant for which there is a picture. Times are nanoseconds from the recording's begin.
struct Moment {
  int number;
  int64_t time, open, close;  ///< the exposure's middle, begin and end
  CameraPose pose;
  std::array<std::array<double, 4>, 4> matrix;  ///< camera_matrix's
  const Image& sharp;                           ///< with a channel "mesh.id"
  const Image* blurred;                         ///< null: not wanted
  const Image& depth;                           ///< "depth.Z", at pixels' middles
  const Image* flow;                            ///< to the next moment; null for the last one
  int64_t next;                                 ///< time of the next moment

  const Image& picture() const { return blurred != nullptr ? *blurred : sharp; }
};

class FolderLayout {
 public:
  virtual ~FolderLayout() = default;
  /// Do moments share out the time from the begin to the last event, both of which are moments?
  virtual bool spans_events() const { return false; }
  virtual EventSink& events() = 0;
  virtual void finish_events() = 0;
  virtual void add(const Moment& moment) = 0;
  virtual void add_pose(int64_t time, const CameraPose& pose) = 0;
  /// After all else.
  virtual void finish() = 0;
};

std::unique_ptr<FolderLayout> make_rpg_layout(const FolderPlan& plan);
std::unique_ptr<FolderLayout> make_dsec_layout(const FolderPlan& plan);
std::unique_ptr<FolderLayout> make_evimo2_layout(const FolderPlan& plan);
std::unique_ptr<FolderLayout> make_eventnerf_layout(const FolderPlan& plan);

/// A picture of the image's "depth.Z" alone, as the grey of an EXR, which is what most programs look for.
Image depth_picture(const Image& image);
/// "t px py pz qx qy qz qw", seconds first, and a newline: a pose of TUM's trajectories.
std::string trajectory_line(int64_t time, const CameraPose& pose);

}  // namespace kairos
