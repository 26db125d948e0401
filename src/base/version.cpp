#include <kairos/version.h>

namespace kairos {
const char* version() { return KAIROS_VERSION; }
}  // namespace kairos
