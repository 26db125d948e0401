// A long rendering that survives being killed: strips of rows, each a part of the picture (parts.h), are written as it
// goes, and found by whoever runs the same command again.
#pragma once

#include <string>

#include <kairos/image.h>
#include <kairos/render.h>

#include "parts.h"

namespace kairos::cli {

struct CheckpointedPicture {
  const Shot& shot;
  RenderParams params;
  std::string out, mark, command_line;  ///< as in frame_mark.h, and for the header
  int frame = -1;                       ///< of a sequence
  WriteOptions write;                   ///< of the picture
  double seconds = 60;                  ///< at most so much work is lost, and one strip more
};

/// Renders what is not there yet, and merges. A strip is a fixed share of the rows, so that pictures have the same bits
/// however often they were interrupted, which writes what is done and throws Error(cancelled). Throws Error(bad_input)
/// where the folder of parts holds something else.
MergedPicture render_with_checkpoints(const CheckpointedPicture& picture, const Progress& progress);

}  // namespace kairos::cli
