// Where data sets keep what: the names that their loaders read.
#pragma once

#include <span>
#include <string>

namespace kairos::cli {

/// Names have a %d for the frame's number within its sequence, as FrameName has it, and SEQ for the sequence's name;
/// empty: the data set has no such file.
struct DatasetLayout {
  const char* name;
  int first_number;
  bool rolls;               ///< its blurred pictures are of a rolling shutter
  const char* exposed;      ///< with the shutter as it is
  const char* sharp;        ///< at an instant, globally: the middle of the middle line's exposure
  const char* sharp_first;  ///< that of the first line's
  const char* flow;         ///< from a sharp picture to the next
  const char* occlusion;    ///< of the flow
  const char* log;          ///< a file of the sequence that says how it was made, without a number
};

std::span<const DatasetLayout> dataset_layouts();

/// The name of a layout's file.
std::string dataset_file(const char* pattern, const std::string& sequence, int number);

}  // namespace kairos::cli
