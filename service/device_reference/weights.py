"""Moments of a technique's weight over its (u1, u2) square, in double precision on the device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.device_reference.drawn import Drawn
from service.device_reference.pilot import GRADED_AT_BOTH, Points, piloted_panels, shares
from service.estimators.cubature import Goal, Integrals, Values, integrate
from service.estimators.panels import NARROWEST_DOUBLE, Array, Panels, children
from service.estimators.quadrature import LEAST_VARIANCE, Evaluator
from service.moments import central_moments
from service.probe import Probe
from service.sampling import Cells

TOLERANCE = 1e-5
COARSE = 1e-4
"""Tolerance of the first of two resolutions, whose difference is the second witness of the error."""

MOST_NODES = 1 << 14
"""Nodes for one cell in the first resolution, at the most; the second has eight times as many."""

SAFETY = 3.0
SLIVER = 1e-4
"""What a value may be off by, relative to it, where a kink lies so close to a border of panels that no node is between.

With these two errors up to 89.5 degrees stay within what is stated, over the catalogue: tests/benchmarks/own_truths.py.
"""

DOUBTFUL = 8.0
"""So many standard errors of the pilot between it and the quadrature mean that the quadrature missed something."""


@dataclass(frozen=True)
class WeightMoments:
    """Moments of the weight, what they may be off by, and what decides whether to trust them; each (cells,).

    variance and fourth (central) are inf where they grew without limit, fourth NaN where two resolutions disagree.
    seen: the largest weights at the nodes, for the search that follows.
    """

    mean: Array
    mean_error: Array
    variance: Array
    variance_error: Array
    fourth: Array
    zero: Array
    trusted: NDArray[np.bool_]
    seen: Integrals


def weight_moments(probe: Probe, cells: Cells, drawn: Drawn, hints: Points) -> WeightMoments:
    """Integrate the weight and its powers for every cell, wo and parameters in float64.

    `hints` are points about which panels have to be small, beside those of the pilot.
    """
    pipeline = probe.engine.pipeline(probe.model, probe.technique, "quadrature", precision="double")
    with Evaluator(probe.engine.device, pipeline, cells, "double") as evaluate:
        coarse, fine = two_resolutions(evaluate, _first(drawn, len(cells), hints), np.ones(len(cells), bool))
    return _moments(coarse, fine, drawn)


def two_resolutions(
    evaluate: Callable[[Panels], Values], first: Panels, variance: NDArray[np.bool_]
) -> tuple[Integrals, Integrals]:
    """Integrate to COARSE, and again to TOLERANCE beginning with all panels of the first in quarters.

    So what no node of the first has seen has a second chance, and shows in the difference. `variance`: whether it
    counts, (cells,).
    """
    count, found, panels = len(variance), [], first
    for tolerance, nodes in ((COARSE, MOST_NODES), (TOLERANCE, 8 * MOST_NODES)):
        goal = Goal(tolerance, LEAST_VARIANCE, variance, nodes, NARROWEST_DOUBLE)
        found.append(integrate(count, False, goal, evaluate, panels))
        every = np.ones(len(found[-1].panels), bool)
        panels = children(found[-1].panels, every, every)
    return found[0], found[1]


def _first(drawn: Drawn, cells: int, hints: Points) -> Panels:
    w = np.abs(np.nan_to_num(drawn.weight, nan=0.0, posinf=0.0, neginf=0.0))
    with np.errstate(over="ignore"):
        scaled = w / np.maximum(w.max(axis=1, keepdims=True), 1e-300)
    importance = 0.5 * (shares(drawn.measure * scaled) + shares(drawn.measure * scaled**2))
    count = w.shape[1]
    points = Points(
        np.repeat(np.arange(cells), count),
        np.tile(drawn.part, cells),
        np.tile(drawn.square[:, 0], cells),
        np.tile(drawn.square[:, 1], cells),
        importance.ravel(),
    )
    parts = tuple(np.unique(drawn.part).tolist())
    return piloted_panels(cells, parts, points.joined(hints), GRADED_AT_BOTH)


def uncertainty(fine: Array, coarse: Array, stated: Array) -> Array:
    """What an integral may be off by: the rule's own estimate or the difference of two resolutions, with a margin."""
    return np.asarray(SAFETY * np.maximum(stated, np.abs(fine - coarse)) + SLIVER * np.abs(fine))


def _moments(coarse: Integrals, fine: Integrals, drawn: Drawn) -> WeightMoments:
    mean, mean_before = (found.shift + found.powers[0] for found in (fine, coarse))
    variance, fourth = central_moments(fine.powers)
    variance_before, fourth_before = central_moments(coarse.powers)
    settled = np.abs(fourth - fourth_before) <= 1e-2 * fourth
    bad = (fine.nonfinite > 0) | ~np.isfinite(drawn.weight).all(axis=1)
    sampled = np.sum(drawn.measure * np.nan_to_num(drawn.weight, nan=0.0, posinf=0.0, neginf=0.0), axis=1)
    spread = np.sqrt(variance / drawn.weight.shape[1])
    missed = np.abs(sampled - mean) > DOUBTFUL * spread + 1e-9 * np.abs(mean)
    return WeightMoments(
        mean=mean,
        mean_error=uncertainty(mean, mean_before, fine.mean_error),
        variance=np.where(fine.growing, np.inf, variance),
        variance_error=uncertainty(variance, variance_before, fine.variance_error),
        fourth=np.where(fine.growing, np.inf, np.where(settled, fourth, np.nan)),
        zero=np.clip(fine.zero, 0.0, 1.0),
        trusted=~bad & (~missed | fine.growing),
        seen=fine,
    )
