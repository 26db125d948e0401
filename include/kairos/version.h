#pragma once

#include <kairos/export.h>

namespace kairos {

/// "major.minor.patch" of the library that is linked.
KAIROS_API const char* version();
/// One line: the compiler, the kind of build, and the libraries whose versions may matter to pictures and files.
KAIROS_API const char* built_with();

}  // namespace kairos
