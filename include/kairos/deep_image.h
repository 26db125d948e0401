// Pictures with any number of samples in a pixel, one behind the other: deep OpenEXR.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/image.h>

namespace kairos {

struct DeepImage {
  /// Sizes, attributes and channels; a channel's values are [sample], not [pixel]. Among them is "Z".
  Image image;
  std::vector<size_t> first;  ///< [pixel], rows from the top, and the end of the last one: of its samples
  /// Where there is an integer channel "id": what its numbers stand for. Empty names are left out.
  std::vector<std::string> names;
};

/// Writes EXR with scan lines of deep samples, whole or not at all; colours as 32 bits. go_on: as WriteOptions'. Throws
/// Error(bad_usage) for another extension, and for samples that do not belong to pixels; Error(io), Error(cancelled).
KAIROS_API void write_deep_image(const DeepImage& deep, const std::string& path,
                                 const std::function<bool()>& go_on = {});

}  // namespace kairos
