// A page on which a person chooses the shutter of a picture over time. docs/time.md.
#pragma once

#include <string>

#include <kairos/export.h>
#include <kairos/time_picture.h>

namespace kairos {

struct ShutterPageOptions {
  std::string file;            ///< the picture's name, as commands that the page shows call it
  int width = 320;             ///< pixels at most; wider pictures are reduced by means over squares of pixels
  double tolerance = 0x1p-13;  ///< TimeQuality's, of what the page holds: 1/256 for a sixteenth of the time
  int threads = 0;             ///< 0: as many as the machine has
  std::function<bool(double fraction)> progress = {};  ///< as render's
};

/// HTML that needs nothing beside itself: it holds what its pixels show over time, and integrates the weights of
/// shutters against that, as TimePicture does. Throws Error(bad_input) for a picture of a single instant, what
/// reading a file does, and Error(cancelled).
KAIROS_API std::string shutter_page(const TimePicture& picture, const ShutterPageOptions& options);

}  // namespace kairos
