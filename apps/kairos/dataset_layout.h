// Where data sets keep what: the names that their loaders read.
#pragma once

#include <span>
#include <string>

namespace kairos::cli {

/// Names have a %d for the frame's number within its sequence, as FrameName has it, and SEQ for the sequence's name;
/// empty: the data set has no such file.
struct DatasetLayout {
  const char* name;
  int first_number = 0;
  bool rolls = false;            ///< its blurred pictures are of a rolling shutter
  const char* exposed;           ///< with the shutter as it is
  const char* sharp = "";        ///< at an instant, globally: the middle of the middle line's exposure
  const char* sharp_first = "";  ///< that of the first line's
  const char* flow = "";         ///< from a sharp picture to the next
  const char* occlusion = "";    ///< of the flow
  const char* log = "";          ///< a file of the sequence that says how it was made, without a number
  const char* exposed_next =
      "";  ///< with a frame's number, the next frame's exposed picture; the last frame then has none
  const char* flow_seen = "";        ///< the flow where the point is seen in the next sharp picture
  const char* depth = "";            ///< text: depth along the view axis, each line in the middle of its exposure
  const char* undistort = "";        ///< flow from there to the sharp picture
  const char* undistort_first = "";  ///< the same, to the one at the first line
  const char* undistort_seen = "";   ///< white where the point is seen in both
  const char* velocity = "";         ///< of the sequence: how the camera moves in the first frame
  const char* transforms = "";       ///< of the sequence: poses and velocities of all frames
  int sharp_every = 0;  ///< above 0: every so manyth frame, the first among them, is sharp in place of exposed

  /// Does it say where things are, beside pictures?
  bool needs_shot() const { return *flow != 0 || *depth != 0 || *velocity != 0 || *transforms != 0; }
};

std::span<const DatasetLayout> dataset_layouts();

/// The name of a layout's file.
std::string dataset_file(const char* pattern, const std::string& sequence, int number);

}  // namespace kairos::cli
