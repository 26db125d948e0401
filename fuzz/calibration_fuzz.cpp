// Any bytes as a calibration: read, and then it makes prices and is read again as it is written, or throws
// kairos::Error.
#include <cstdlib>

#include <kairos/error.h>

#include "policy/ray_prices.h"
#include "scene_io/calibration_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  kairos::CalibrationFile file;
  try {
    file = kairos::parse_calibration(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.json");
  } catch (const kairos::Error&) {
    return 0;
  }
  const kairos::RayPrices prices = kairos::prices_of(file.calibration);
  for (const double rays : {1.0, 3.0, 64.0})
    if (!(kairos::tc_ray_price(prices, rays) > 0)) std::abort();
  const kairos::CalibrationFile again = kairos::parse_calibration(kairos::calibration_text(file), "again.json");
  if (!(kairos::prices_of(again.calibration) == prices) || again.shading != file.shading) std::abort();
  return 0;
}
