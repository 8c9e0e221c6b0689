"""Which estimator answers a series, and with which count: as asked for, or as the tolerance needs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from service.estimators.estimate import Estimate
from service.estimators.quadrature import LEAST_VARIANCE, quadrature
from service.estimators.sampled import REPLICATES, SeriesRun, monte_carlo, nothing_drawn, quasi_monte_carlo
from service.reference import CellReference
from service.scene import Estimator, Scene

FIRST_SAMPLES = 1 << 16
MOST_SAMPLES = 1 << 26
"""Samples for each angle that a tolerance may lead to: seconds an angle on two cores."""
CONFIDENCE = 2.0
"""A sampled statistic has reached the tolerance when so many of its standard errors are below it."""
ATTEMPTS = 4

Draw = Callable[[Estimator], Estimate]


def estimate(run: SeriesRun, scene: Scene, reference: Sequence[CellReference] | None) -> Estimate:
    """The statistics of one series by the estimator of the scene, or by the one that reaches its tolerance first.

    A tolerance without a method is tried with the quadrature, which needs the least; a series that it cannot resolve
    within its budget is sampled by `qmc`, with as many points as its own error bars ask for.
    """
    asked, count = scene.estimator, len(run.cells)
    if not run.structure.drawn:
        run.advance(asked.samples * count)
        return nothing_drawn(count, asked)
    with_variance = "variance" in scene.statistics
    finite_variance = np.ones(count, bool)
    if reference is not None:
        finite_variance = ~np.isinf([cell.variance for cell in reference])

    def drawn(method: str) -> Draw:
        if method == "mc":
            return lambda one: monte_carlo(run, one)
        return lambda one: quasi_monte_carlo(run, scene.angles_deg, one)

    if asked.method in ("mc", "qmc"):
        draw = drawn(asked.method)
        return draw(asked) if asked.tolerance is None else _sampled_to(draw, asked, finite_variance, with_variance)
    by_rule = quadrature(run.plan, run.engine, run.cells, asked, finite_variance, with_variance, run.structure)
    if asked.method == "quadrature" or not np.any(by_rule.unreached & ~by_rule.divergent):
        return by_rule
    by_samples = _sampled_to(drawn("qmc"), asked, finite_variance & ~by_rule.divergent, with_variance)
    return replace(by_samples, device_ns=by_samples.device_ns + by_rule.device_ns)


def _sampled_to(draw: Draw, asked: Estimator, finite_variance: NDArray[np.bool_], with_variance: bool) -> Estimate:
    """Draw more and more until the error bars say that the tolerance is reached, or the count would be too large."""
    tolerance, samples, spent = asked.tolerance or 0.0, FIRST_SAMPLES, 0
    for _ in range(ATTEMPTS):
        found = draw(asked.model_copy(update={"samples": samples}))
        spent += found.device_ns
        excess = np.where(finite_variance, _stated_error(found, with_variance), 0.0) / tolerance
        worst = float(np.max(np.nan_to_num(excess, nan=np.inf), initial=0.0))
        if worst <= 1.0 or found.estimator.samples >= MOST_SAMPLES:
            break
        # Half an order is what any estimator has; a steeper one only ends earlier.
        needed = found.estimator.samples * min(worst, 1e6) ** 2 * 1.1
        samples = min(MOST_SAMPLES, REPLICATES << math.ceil(math.log2(needed / REPLICATES)))
    return replace(found, unreached=excess > 1.0, device_ns=spent)


def _stated_error(found: Estimate, with_variance: bool) -> NDArray[np.float64]:
    """The error that an estimate states for itself, relative to the variance or, where that is not asked, the mean."""
    if found.statistics is None:
        return np.zeros(len(found.largest))
    s = found.statistics
    if with_variance:
        return np.asarray(CONFIDENCE * s.variance_stderr / np.maximum(s.variance, LEAST_VARIANCE))
    return np.asarray(CONFIDENCE * s.mean_stderr / np.maximum(np.abs(s.mean), LEAST_VARIANCE))
