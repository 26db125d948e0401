#include "study/statistics.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

namespace kairos::study {

double median(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

double student_quantile(size_t degrees) {
  constexpr double kTable[] = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281};
  if (degrees <= std::size(kTable)) return kTable[std::max<size_t>(degrees, 1) - 1];
  // Cornish and Fisher's expansion around the normal distribution's quantile.
  constexpr double z = 1.959964, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  const auto n = static_cast<double>(degrees);
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

Estimate estimate(std::span<const double> values) {
  const auto count = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / count;
  for (const double v : values) squares += (v - mean) * (v - mean);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (values.size() < 2) return {median(values), kUnknown, kUnknown};
  const double reach = student_quantile(values.size() - 1) * std::sqrt(squares / (count - 1) / count);
  return {median(values), mean - reach, mean + reach};
}

Estimate estimate_of_ratios(std::span<const double> values) {
  std::vector<double> logs;
  for (const double v : values) logs.push_back(std::log(v));
  const Estimate e = estimate(logs);
  return {median(values), std::exp(e.low), std::exp(e.high)};
}

}  // namespace kairos::study
