# SPDX-License-Identifier: GPL-3.0-or-later
"""95 % confidence intervals of what a study repeats."""
import math

import numpy as np

Z = 1.959963984540054  # 0.975 quantile of the normal distribution
RESAMPLES = 4000


def wilson(passed, count):
    """(low, high) of a rate: Wilson, JASA 22 (1927) 209-212. (0, 1) of nothing."""
    if count == 0:
        return 0.0, 1.0
    rate, z2 = passed / count, Z * Z / count
    centre = (rate + z2 / 2) / (1 + z2)
    half = Z / (1 + z2) * math.sqrt(rate * (1 - rate) / count + z2 / (4 * count))
    # The bounds at 0 and 1 are exact; rounding must not move them.
    return (0.0 if passed == 0 else centre - half), (1.0 if passed == count else centre + half)


def bootstrap(values, quantile, seed=1):
    """(low, high) of a quantile of what `values` were drawn from: percentile bootstrap (Efron 1979), fixed seed.

    Both are NaN for fewer than two values. RandomState, for its numbers are the same in all versions of numpy.
    """
    values = np.asarray(values, float)
    if values.size < 2:
        return math.nan, math.nan
    draws = np.random.RandomState(seed).randint(0, values.size, (RESAMPLES, values.size))
    estimates = np.quantile(values[draws], quantile, axis=1)
    low, high = np.quantile(estimates, [0.025, 0.975])
    return float(low), float(high)
