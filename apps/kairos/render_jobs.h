// What kairos render has to do: one picture, those of a sequence, or parts of them; and what of it is done already.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <kairos/scene.h>

#include "frames.h"
#include "parts.h"

namespace kairos::cli {

/// What render was told to write.
struct RenderFiles {
  std::string out, stats_file, time;  ///< names of files, or empty: with `frames`, of a sequence's, but for `time`
  std::optional<FrameRange> frames;
  std::optional<Part> part;  ///< of the job
};

/// One picture of a sequence, or the only one.
struct FrameJob {
  ShotOptions shot;
  int slabs = 0;                      ///< above 0: `time` holds so many frames from the shot's on, all of their time
  std::string out, stats_file, time;  ///< names of files, or empty
  std::optional<Part> part;           ///< of the picture, which `out` and `time` are the files of
};

/// The pictures of a sequence, or the only one. With a part, a run of them; and where there are more parts than
/// pictures, a run of pieces, into which each is divided.
std::vector<FrameJob> all_jobs(const RenderFiles& files, const ShotOptions& shot);

/// Are all files of a job there, whole, and made as `mark` says? Throws Error(bad_input) as is_part_there does.
bool is_there(const FrameJob& job, const std::string& mark);

/// The pixels of a job: all that are asked for, or a part's band of them, which holds whole tiles where it is kept over
/// time.
Crop pixels_of(const FrameJob& job, const Crop& whole);

}  // namespace kairos::cli
