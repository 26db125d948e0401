"""Medians and 95 % intervals over few repetitions: the same as src/study/statistics.h."""

import math
import statistics

TABLE = [12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281]


def student_quantile(degrees):
    """The 97.5 % quantile of Student's distribution, within 1e-3."""
    if degrees <= len(TABLE):
        return TABLE[max(degrees, 1) - 1]
    z = 1.959964  # Cornish and Fisher's expansion around the normal distribution's quantile
    return (z + (z**3 + z) / (4 * degrees) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * degrees**2) +
            (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / (384 * degrees**3))


def estimate(values):
    """(median, low, high): the median, and Student's interval of the mean; NaN for the latter from a single value."""
    if len(values) < 2:
        return (values[0], math.nan, math.nan)
    mean = statistics.fmean(values)
    reach = student_quantile(len(values) - 1) * statistics.stdev(values) / math.sqrt(len(values))
    return (statistics.median(values), mean - reach, mean + reach)


def estimate_of_ratios(values):
    """The same for positive values whose logarithms are meant."""
    _, low, high = estimate([math.log(value) for value in values])
    return (statistics.median(values), math.exp(low), math.exp(high))
