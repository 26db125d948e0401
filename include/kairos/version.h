#pragma once

namespace kairos {

/// "major.minor.patch" of the library that is linked.
const char* version();

}  // namespace kairos
