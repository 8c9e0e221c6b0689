"""From sums of powers to statistics with error bars.

The device sums powers of (weight - shift), where the shift is a median of the cell's first weights. A median lies
within one standard deviation of the mean, so moving the moments to the mean cancels at most about one bit, and a
technique with zero variance reports zero rather than rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
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
        powers = sums / n
        central2, central4 = central_moments(powers)
        variance = np.where((n > 1) & (moments >= 2), central2 * n / (n - 1), np.nan)
        spread = np.maximum(central4 - (n - 3) / (n - 1) * variance**2, 0.0)
        return Statistics(
            mean=np.where(n > 0, shift + powers[0], np.nan),
            mean_stderr=np.sqrt(variance / n),
            variance=variance,
            variance_stderr=np.where((n > 3) & (moments >= 4), np.sqrt(spread / n), np.nan),
            kurtosis=np.where(moments < 4, np.nan, np.where(central2 > 0, central4 / central2**2, 1.0)),
        )


def central_moments(powers: Sequence[Array] | Array) -> tuple[Array, Array]:
    """The second and the fourth central moment from the means of the powers 1 to 4 about any point; not below 0."""
    a, b, c, d = powers
    return np.maximum(b - a * a, 0.0), np.maximum(d - 4 * a * c + 6 * a * a * b - 3 * a**4, 0.0)


def bernstein_half_width(variance: Array, bound: Array, samples: int, false_alarm: float) -> Array:
    """Half width of a two-sided interval for the mean of `samples` values in [0, bound] with this variance.

    By Bernstein's inequality, which holds at any count and for any tail. What is infinite counts as 0.
    """
    log_term = math.log(2.0 / false_alarm)
    linear = np.where(np.isfinite(bound), bound, 0.0) * log_term / 3.0
    spread = np.where(np.isfinite(variance), variance, 0.0)
    return np.asarray((linear + np.sqrt(linear**2 + 2.0 * samples * spread * log_term)) / samples)
