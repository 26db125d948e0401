// Writes OpenEXR files.
#pragma once

#include <string>

#include <kairos/image.h>

namespace kairos {

/// Throws Error(io).
void write_exr(const Image& image, const std::string& path, const WriteOptions& options);

}  // namespace kairos
