"""From sums of powers to statistics with error bars.

The device sums powers of (weight - shift), where the shift is a median of the cell's first weights. A median lies
within one standard deviation of the mean, so moving the moments to the mean cancels at most about one bit, and a
technique with zero variance reports zero rather than rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Statistics:
    """Statistics of cells, each of shape (cells,). NaN where a cell has too few samples for one."""

    mean: Array
    mean_stderr: Array
    variance: Array
    variance_stderr: Array
    kurtosis: Array


def from_power_sums(count: NDArray[np.int64], shift: Array, sums: Array, moments: int = 4) -> Statistics:
    """Statistics from power sums.

    count: samples a cell, shape (cells,). shift: shape (cells,). sums: sums of (w - shift)^k for k = 1 to 4, shape
    (4, cells). The variance is the unbiased one (n - 1); its standard error is that of the sample variance of
    independent samples, sqrt((m4 - (n - 3)/(n - 1) s^4)/n), with the samples' own fourth central moment m4. Kurtosis
    is m4/m2^2. What needs a power above `moments`, the highest that was summed, is NaN.
    """
    n = count.astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b, c, d = sums / n
        central2 = np.maximum(b - a * a, 0.0)
        central4 = np.maximum(d - 4 * a * c + 6 * a * a * b - 3 * a**4, 0.0)
        variance = np.where((n > 1) & (moments >= 2), central2 * n / (n - 1), np.nan)
        spread = np.maximum(central4 - (n - 3) / (n - 1) * variance**2, 0.0)
        return Statistics(
            mean=np.where(n > 0, shift + a, np.nan),
            mean_stderr=np.sqrt(variance / n),
            variance=variance,
            variance_stderr=np.where((n > 3) & (moments >= 4), np.sqrt(spread / n), np.nan),
            kurtosis=np.where(moments < 4, np.nan, np.where(central2 > 0, central4 / central2**2, 1.0)),
        )
