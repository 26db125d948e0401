// Medians and 95 % intervals over few repetitions.
#pragma once

#include <span>

namespace kairos::study {

struct Estimate {
  double median = 0;
  double low = 0, high = 0;  ///< 95 % interval of the mean; NaN from a single value
};

/// Of at least one value; the mean of the two in the middle for an even number.
double median(std::span<const double> values);

/// Median of the values, and Student's interval of their mean: they are taken as independent and near to normal. At
/// least one value.
Estimate estimate(std::span<const double> values);

/// The same for positive values whose logarithms are meant, as ratios are.
Estimate estimate_of_ratios(std::span<const double> values);

/// The 97.5 % quantile of Student's distribution; degrees: of freedom, at least 1. Within 1e-3.
double student_quantile(size_t degrees);

}  // namespace kairos::study
