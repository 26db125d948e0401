// The file by which loaders of DSEC take a lens's distortion away.
#pragma once

#include <string>

namespace kairos {

/// Of a camera without distortion: where each pixel is. Throws Error(io).
void write_rectify_map(const std::string& path, int width, int height);

}  // namespace kairos
