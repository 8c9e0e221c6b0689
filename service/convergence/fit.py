"""Slopes of error curves and the count that reaches a target, with intervals that respect the noise of replicates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RESAMPLES = 400
CONFIDENCE = 0.95
"""That all intervals of one result hold together: those of single curves are wider, the more curves there are."""
LEAST_POINTS = 4
ROUNDING = 3e-7  # relative errors below this are float32 rounding of weights and sums


@dataclass(frozen=True)
class Fit:
    """A power law error = c count^slope for each angle; NaN where no curve of at least four points is there.

    Intervals have shape (angles, 2). count_to_target is at least 1; inf where the bias alone is above the target, NaN
    where there is no fit.
    """

    slope: Array
    slope_interval: Array
    count_to_target: Array
    count_interval: Array


def fit_power_law(
    counts: Sequence[int], errors: Array, bias: Array, least_count: Array, target: float, curves: int, independent: bool
) -> Fit:
    """Fit the random part of the errors, that is without the bias, to a power of the count.

    errors: relative, signed, (K, R, angles). bias: of the technique, signed, (angles,). least_count: counts below it
    are not fitted, (angles,): there the mean of the samples is not yet normal, and replicates see too few of the rare
    large weights. curves: how many are in the result, all of whose intervals are to hold at once. independent: whether
    samples are; the count to the target then follows from their variance, and not from the fitted slope. The noise of
    the points is correlated, because counts are nested, so whole replicates are resampled.
    """
    squares = (errors - bias) ** 2
    rms = np.sqrt(np.mean(squares, axis=1))
    used = (np.asarray(counts)[:, None] >= least_count) & (rms > ROUNDING)
    reduced = np.sqrt(np.maximum(target**2 - bias**2, 0.0))
    replicates = errors.shape[1]
    rng = np.random.default_rng(0)
    shares = rng.multinomial(replicates, np.full(replicates, 1 / replicates), RESAMPLES) / replicates
    resampled = np.sqrt(np.einsum("br,kra->bka", shares, squares))
    slope, count = _lines(counts, rms[None], used, reduced, independent)
    slopes, targets = _lines(counts, resampled, used, reduced, independent)
    widen = student_quantile(1.0 - (1.0 - CONFIDENCE) / curves, replicates - 1) * math.sqrt(
        replicates / (replicates - 1)
    )
    half = widen * np.std(slopes, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.exp(widen * np.std(np.log(targets), axis=0))
    count = np.where(reduced > 0, count[0], np.where(np.isnan(count[0]), np.nan, np.inf))
    least = np.maximum(count, 1.0)
    return Fit(
        slope=slope[0],
        slope_interval=np.stack([slope[0] - half, slope[0] + half], axis=-1),
        count_to_target=least,
        count_interval=np.stack([np.maximum(count / factor, 1.0), np.maximum(count * factor, 1.0)], axis=-1),
    )


def student_quantile(confidence: float, freedom: int) -> float:
    """The two-sided quantile of Student's t, by its expansion about the normal one (Abramowitz and Stegun 26.7.5)."""
    z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    return (
        z
        + (z**3 + z) / (4 * freedom)
        + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)
        + (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / (384 * freedom**3)
    )


def _lines(
    counts: Sequence[int], rms: Array, used: NDArray[np.bool_], target: Array, independent: bool
) -> tuple[Array, Array]:
    """Slope and count at the target of straight lines through (log count, log rms), each of shape (B, angles).

    Of independent samples the count is their variance, count x rms^2 on average, over the target's square.
    """
    x = np.log(np.asarray(counts, float))[:, None]
    weight = np.where(used, 1.0, 0.0)
    y = np.log(np.maximum(rms, 1e-300))
    number = weight.sum(axis=0)
    enough = number >= LEAST_POINTS
    with np.errstate(divide="ignore", invalid="ignore"):
        x_mean = (weight * x).sum(axis=0) / number
        y_mean = (weight * y).sum(axis=1) / number
        dx = weight * (x - x_mean)
        slope = np.where(enough, (dx * (y - y_mean[:, None])).sum(axis=1) / (dx * dx).sum(axis=0), np.nan)
        if independent:
            variance = (weight * np.exp(x) * rms**2).sum(axis=1) / number
            log_count = np.where(enough, np.log(variance) - 2.0 * np.log(target), np.nan)
        else:
            log_count = x_mean + (np.log(target) - y_mean) / slope
    return slope, np.asarray(np.exp(np.clip(log_count, -50.0, 200.0)))
