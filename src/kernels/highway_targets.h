// Which of Highway's targets the kernels are compiled for. To be included before hwy/foreach_target.h.
#pragma once

// The oldest instruction set of x86; machines without it get the scalar code. Elsewhere Highway finds its baseline
// itself.
#if defined(__x86_64__) || defined(__i386__)
#define HWY_BASELINE_TARGETS HWY_SSE4
#endif
// SVE and RVV: the kernels hold vectors in arrays, which those of unknown size cannot be put in. SSSE3 is older than
// the baseline, AVX3_DL has nothing that the kernels use beyond AVX3, and in place of SCALAR there is the code in
// double precision.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SCALAR)
