"""What errors are measured against: exact mean and variance of a technique, exact albedo of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.catalogue import hemisphere
from service.engine import Engine
from service.estimators.quadrature import quadrature
from service.reference_store import plan_reference
from service.scene import Estimator, Scene, SeriesPlan
from service.statistics import series_cells

Array = NDArray[np.float64]
TOLERANCE = 1e-5
_RULE = Estimator(method="quadrature", tolerance=TOLERANCE)


@dataclass(frozen=True)
class Truth:
    """Exact values of a series, each of shape (angles,). variance and kurtosis (m4/m2^2) are inf where they diverge."""

    albedo: Array
    mean: Array
    variance: Array
    kurtosis: Array

    @property
    def floor(self) -> Array:
        """The relative error that no number of samples removes: the bias; 0 where it is below float32 rounding."""
        bias = np.abs(self.mean - self.albedo) / np.maximum(np.abs(self.albedo), 1e-300)
        return np.asarray(np.where(bias > 1e-5, bias, 0.0))


def series_truth(plan: SeriesPlan, scene: Scene, engine: Engine) -> Truth:
    """The float64 reference; where it is not known, the device's quadrature in float32."""
    angles = scene.angles_deg
    cells = plan_reference(plan, angles, engine)
    if cells is None:
        return _by_quadrature(plan, scene, engine)
    albedo, mean, variance, fourth = (
        np.array([getattr(cell, name) for cell in cells]) for name in ("albedo", "mean", "variance", "fourth_moment")
    )
    if np.isnan([albedo, mean, variance]).any():
        return _by_quadrature(plan, scene, engine)
    with np.errstate(divide="ignore", invalid="ignore"):
        kurtosis = np.where(variance > 1e-20, fourth / variance**2, 1.0)
    return Truth(albedo, mean, variance, np.where(np.isfinite(fourth), kurtosis, np.inf))


def _by_quadrature(plan: SeriesPlan, scene: Scene, engine: Engine) -> Truth:
    albedo, _, _ = _moments(replace(plan, technique=hemisphere()), scene, engine)
    mean, variance, kurtosis = _moments(plan, scene, engine)
    return Truth(albedo, mean, variance, kurtosis)


def _moments(plan: SeriesPlan, scene: Scene, engine: Engine) -> tuple[Array, Array, Array]:
    """Mean, variance and kurtosis of a series by quadrature; inf where the variance diverges."""
    names = engine.catalogue.parameters_of(plan.model, plan.technique)
    values = {name: plan.parameters.get(name, parameter.default) for name, parameter in names.items()}
    cells = series_cells(replace(plan, parameters=values), scene)
    statistics = quadrature(plan, engine, cells, _RULE, np.ones(len(cells), bool), with_variance=True).statistics
    assert statistics is not None  # a quadrature always has moments
    return (
        statistics.mean,
        np.where(np.isnan(statistics.variance), np.inf, statistics.variance),
        np.where(np.isnan(statistics.kurtosis), np.inf, statistics.kurtosis),
    )


def relative_variances(
    plan: SeriesPlan, scene: Scene, engine: Engine, rows: Sequence[dict[str, float]]
) -> tuple[Array, Array]:
    """Variance and mean of a technique for several sets of parameter values: shape (rows, angles) each.

    By the device's quadrature, which does not see rounding: a variance below 1e-9 is that of a constant weight.
    """
    found = [_moments(replace(plan, parameters=row), scene, engine) for row in rows]
    return np.array([variance for _, variance, _ in found]), np.array([mean for mean, _, _ in found])
