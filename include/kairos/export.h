// What the shared library shows to the programs that are linked with it: everything else is hidden.
#pragma once

#if defined(__GNUC__)
#define KAIROS_API __attribute__((visibility("default")))
/// For a part of a shown class that is nobody else's business.
#define KAIROS_LOCAL __attribute__((visibility("hidden")))
#else
#define KAIROS_API
#define KAIROS_LOCAL
#endif
