"""References of the cells of one series, from its own shader code in double precision."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from service.checks.effort import FULL
from service.checks.tails import INFINITE_VARIANCE, follow
from service.device_reference.drawn import draw
from service.device_reference.hemisphere import Albedo, albedos
from service.device_reference.preimages import preimages
from service.device_reference.sky import survey
from service.device_reference.supremum import suprema
from service.device_reference.weights import WeightMoments, weight_moments
from service.engine import Engine
from service.estimators.panels import Array
from service.estimators.quadrature import LEAST_VARIANCE
from service.inputs import Cells as Views
from service.probe import Probe
from service.reference import CellReference
from service.sampling import Cells
from service.scene import SeriesPlan

WORST = 1e-2
"""A value whose relative error may be larger than this is not given."""

CONFIRMING = 1e-3
"""Relative error of an albedo up to which it confirms a mean that agrees."""

ALONE = 3e-4
"""The same up to which an albedo is given where no mean agrees: a lobe that it missed would show in its error."""

TAIL = replace(FULL, tail_levels=16)
"""Where the weight has no bound and the variance no converged value, the tail is followed down to 4^-16."""


def device_reference(plan: SeriesPlan, engine: Engine, theta_o_deg: Sequence[float]) -> list[CellReference]:
    """The reference of every angle; a value is NaN where the quadrature does not converge, inf where it diverges.

    Raises ShaderFileError for code that does not compile with double in place of float, LoopLimitReached and
    IncompleteRun for loops that reach the limit, and what the device raises.
    """
    probe = Probe(engine, plan.model, plan.technique)
    cells = _cells(plan, probe, theta_o_deg)
    drawn = draw(probe, cells)
    sky = survey(probe, cells, drawn)
    moments = weight_moments(probe, cells, drawn, preimages(probe, cells, drawn, sky))
    albedo, largest = albedos(probe, cells, sky), suprema(probe, cells, moments.seen, drawn.splits)
    known = _known(moments, albedo)
    infinite = known & np.isinf(largest) & np.isinf(moments.variance)
    undecided = known & np.isinf(largest) & ~infinite & ~_near(moments)
    infinite[undecided] = _tail_index(probe, cells, undecided) < INFINITE_VARIANCE
    return _assemble(moments, albedo, np.where(known, largest, np.nan), known, infinite)


def _known(m: WeightMoments, a: Albedo) -> NDArray[np.bool_]:
    """Cells whose moments are those of the technique, and not of the part of the square that was looked at.

    The integral over directions agrees, or else the pilot must have seen the directions that matter.
    """
    exact = a.trusted & (a.error + a.uncovered_error <= CONFIRMING * a.albedo)
    return np.asarray(m.trusted & ((_agree(m, a) & exact) | a.seen))


def _agree(m: WeightMoments, a: Albedo) -> NDArray[np.bool_]:
    """Where the mean weight is the albedo, as far as either is known."""
    return np.asarray(np.abs(m.mean - (a.albedo - a.uncovered)) <= m.mean_error + a.error + a.uncovered_error)


def _near(m: WeightMoments) -> NDArray[np.bool_]:
    """Where the variance has converged well enough to be given."""
    with np.errstate(invalid="ignore"):
        return np.asarray(m.variance_error <= WORST * np.maximum(m.variance, LEAST_VARIANCE / WORST))


def _tail_index(probe: Probe, cells: Cells, chosen: NDArray[np.bool_]) -> Array:
    if not chosen.any():
        return np.zeros(0)
    none = np.zeros(int(chosen.sum()))
    some = Views(cells.wo[chosen], cells.parameters[chosen], none, none)
    return follow(probe, some, TAIL, np.random.default_rng(0)).index


def _cells(plan: SeriesPlan, probe: Probe, theta_o_deg: Sequence[float]) -> Cells:
    phi = math.radians(plan.azimuth_deg)
    theta = [math.radians(angle) for angle in theta_o_deg]
    wo = np.array([(math.sin(t) * math.cos(phi), math.sin(t) * math.sin(phi), math.cos(t)) for t in theta])
    row = [plan.parameters.get(name, parameter.default) for name, parameter in probe.declared.items()]
    return Cells(wo, np.zeros((len(wo), 2), np.uint32), np.tile(np.array(row, np.float64), (len(wo), 1)))


def _assemble(
    m: WeightMoments, a: Albedo, largest: Array, known: NDArray[np.bool_], infinite: NDArray[np.bool_]
) -> list[CellReference]:
    mean_known = known & (m.mean_error <= WORST * np.abs(m.mean))
    albedo_known = a.trusted & (a.error <= np.where(mean_known & _agree(m, a), WORST, ALONE) * a.albedo)
    variance = np.where(infinite, np.inf, np.where(known & _near(m), m.variance, np.nan))
    uncovered_known = a.trusted & (a.uncovered_error <= WORST * np.maximum(a.albedo, 1e-300))
    columns = {
        "mean": np.where(mean_known, m.mean, np.nan),
        "albedo": np.where(albedo_known, a.albedo, np.nan),
        "variance": variance,
        "fourth_moment": np.where(infinite, np.inf, np.where(np.isnan(variance), np.nan, m.fourth)),
        "max_weight": largest,
        "uncovered": np.where(uncovered_known, a.uncovered, np.nan),
        "zero_probability": np.where(known, m.zero, np.nan),
        "tail_strength": np.zeros(len(m.mean)),
        "mean_uncertainty": np.where(mean_known, m.mean_error, np.nan),
        "albedo_uncertainty": np.where(albedo_known, a.error, np.nan),
        "variance_uncertainty": np.where(np.isnan(variance), np.nan, np.where(infinite, np.inf, m.variance_error)),
    }
    return [CellReference(**{name: float(column[at]) for name, column in columns.items()}) for at in range(len(m.mean))]
