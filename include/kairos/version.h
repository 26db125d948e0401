#pragma once

#include <kairos/export.h>

namespace kairos {

/// "major.minor.patch" of the library that is linked.
KAIROS_API const char* version();

}  // namespace kairos
