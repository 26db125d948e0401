#include <kairos/version.h>

namespace kairos {

const char* version() { return KAIROS_VERSION; }
const char* built_with() { return KAIROS_BUILT_WITH; }

}  // namespace kairos
