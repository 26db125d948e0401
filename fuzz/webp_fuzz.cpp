#include "picture_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  fuzz_picture(kairos::kWebp, {data, size});
  return 0;
}
