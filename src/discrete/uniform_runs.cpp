#include "discrete/uniform_runs.h"

#include <cmath>

namespace kairos {

namespace {
constexpr double kRounding = 1.2e-7;  // two roundings of a float just below 1

bool evenly_spaced(std::span<const float> times) {
  const double first = times.front(), step = (times.back() - first) / static_cast<double>(times.size() - 1);
  for (size_t k = 1; k + 1 < times.size(); ++k)
    if (std::abs(static_cast<double>(times[k]) - (first + static_cast<double>(k) * step)) > kRounding) return false;
  return true;
}
}  // namespace

std::vector<UniformRun> uniform_runs(std::span<const float> key_times, size_t max_keys) {
  std::vector<UniformRun> runs;
  size_t first = 0;
  while (first + 1 < key_times.size()) {
    if (key_times[first] == key_times[first + 1]) {
      ++first;
      continue;
    }
    size_t last = first + 1;
    while (last + 1 < key_times.size() && last + 1 - first < max_keys && key_times[last + 1] > key_times[last] &&
           evenly_spaced(key_times.subspan(first, last + 2 - first)))
      ++last;
    runs.push_back({first, last});
    first = last;
  }
  return runs;
}

}  // namespace kairos
