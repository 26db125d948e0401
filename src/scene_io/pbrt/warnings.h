// What a pbrt scene says that Kairos leaves out.
#pragma once

#include "scene_io/file_warnings.h"

namespace kairos::pbrt {

using Place = FilePlace;
using Warnings = FileWarnings;

[[noreturn]] inline void fail(const Place& place, const std::string& what) { fail_at(place, what); }

}  // namespace kairos::pbrt
