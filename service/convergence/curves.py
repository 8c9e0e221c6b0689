"""Errors of the estimators, measured: many independent replicates at many counts, against the exact values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.convergence.scene import ConvergenceScene
from service.convergence.truth import Truth
from service.engine import Engine
from service.estimators.quadrature import quadrature
from service.estimators.sampled import open_sampler, replicated
from service.left_out import error_curve_features, structure_without
from service.moments import from_power_sums
from service.random_numbers import replicate_key
from service.scene import Estimator, Method, SeriesPlan
from service.statistics import series_cells

Array = NDArray[np.float64]
TOLERANCES = tuple(10.0 ** (-k / 2) for k in range(1, 11))
"""What the quadrature is asked for, one point of its curve each: 0.3 to 1e-5."""

RULE_REPEATS = 3
"""A quadrature takes a fraction of a millisecond; the quickest of three runs is the one that nothing disturbed."""


@dataclass(frozen=True)
class Curve:
    """Errors of one estimator of one series.

    counts: samples for each angle, shape (K,). mean_errors: relative errors of the mean against the albedo, of every
    replicate, (K, R, angles); R is 1 for the quadrature. variance_errors: the same of the variance, NaN where it is
    infinite or zero. device_ms: what the estimator itself took for one angle at each count, (K,).
    """

    method: Method
    counts: list[int]
    mean_errors: Array
    variance_errors: Array
    device_ms: list[float]
    built_ms: float

    @property
    def mean_rmse(self) -> Array:
        """Root mean square over replicates, shape (K, angles)."""
        return np.asarray(np.sqrt(np.mean(self.mean_errors**2, axis=1)))

    @property
    def variance_rmse(self) -> Array:
        """Root mean square over replicates, shape (K, angles)."""
        return np.asarray(np.sqrt(np.mean(self.variance_errors**2, axis=1)))


def sampled_curve(
    plan: SeriesPlan,
    scene: ConvergenceScene,
    engine: Engine,
    method: Method,
    truth: Truth,
    advance: Callable[[int], None],
) -> Curve:
    """Errors under `mc` or `qmc`. A replicate's counts are nested: the first 2^k of its samples."""
    cells = series_cells(plan, scene)
    keys = [
        replicate_key(scene.estimator.seed, number, angle)
        for number in range(scene.replicates)
        for angle in scene.angles_deg
    ]
    many = replicated(cells, keys)
    shape = (scene.replicates, len(cells))
    means, variances = [], []
    structure = structure_without(error_curve_features(plan, method))
    with open_sampler(plan, engine, many, structure, sobol=method == "qmc") as (sampler, built_ms):
        prefixes = sampler.run_prefixes(scene.counts, advance)
        for sums in prefixes:
            statistics = from_power_sums(sums.counted, sums.shift, sums.powers, structure.moments)
            means.append(statistics.mean.reshape(shape))
            variances.append(statistics.variance.reshape(shape))
    largest = prefixes[-1]
    ns_per_sample = largest.device_ns / (scene.counts[-1] * len(many))
    return Curve(
        method=method,
        counts=scene.counts,
        mean_errors=_relative(np.array(means), truth.albedo),
        variance_errors=_relative(np.array(variances), truth.variance),
        device_ms=[count * ns_per_sample / 1e6 for count in scene.counts],
        built_ms=built_ms,
    )


def quadrature_curve(plan: SeriesPlan, scene: ConvergenceScene, engine: Engine, truth: Truth) -> Curve:
    """Errors of the quadrature at ever smaller tolerances. Counts are nodes, on average over the angles."""
    cells = series_cells(plan, scene)
    finite = np.isfinite(truth.variance)
    structure = structure_without(error_curve_features(plan, "quadrature"))
    runs = []
    for tolerance in TOLERANCES:
        rule = Estimator(method="quadrature", tolerance=tolerance)
        again = [
            quadrature(plan, engine, cells, rule, finite, with_variance=True, structure=structure)
            for _ in range(RULE_REPEATS)
        ]
        runs.append(min(again, key=lambda run: run.device_ns))
    moments = [run.statistics for run in runs if run.statistics is not None]
    return Curve(
        method="quadrature",
        counts=[round(run.evaluations / len(cells)) for run in runs],
        mean_errors=_relative(np.array([[one.mean] for one in moments]), truth.albedo),
        variance_errors=_relative(np.array([[one.variance] for one in moments]), truth.variance),
        device_ms=[run.device_ns / 1e6 / len(cells) for run in runs],
        built_ms=math.fsum(run.built_ms for run in runs),
    )


def _relative(values: Array, exact: Sequence[float] | Array) -> Array:
    truth = np.asarray(exact)
    usable = np.isfinite(truth) & (np.abs(truth) > 1e-12)
    return np.asarray(np.where(usable, values / np.where(usable, truth, 1.0) - 1.0, np.nan))
