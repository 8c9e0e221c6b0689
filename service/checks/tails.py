"""The tail of the weight and its supremum, by a search that follows the largest weights to the end of double precision.

Subset simulation (Au and Beck, 2001): a population in the (u1, u2) square is kept above a threshold that rises level by
level, each level holding a quarter of the probability of the one before. Moves are differences of members (differential
evolution), so that they shrink with the set, whatever its shape and place. What comes out is P(w > W) down to 10^-14,
where the weight either has stopped growing or follows a power law W^-alpha: its variance is infinite for alpha <= 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.checks.effort import Effort
from service.checks.outcome import Outcome, failed, passed
from service.inputs import Views, replay, views_of
from service.probe import Probe

Array = NDArray[Any]

KEPT = 4
FITTED = 8
"""Levels from which the tail's index is fitted: the last ones."""

INFINITE_VARIANCE = 2.25
"""A fitted index below this counts as 2 or less: the fit scatters by a few percent."""

UNBOUNDED = 20.0
"""A fitted index below this counts as growth without bound: over the last levels the weight doubles at least."""

_LAST = 1.0 - 2.0**-53


@dataclass(frozen=True)
class Tails:
    """What the search has found of every cell.

    thresholds: P(w > threshold) = 4^-level for the levels 1, 2, ..., shape (levels, cells). largest: weight, (cells,).
    u: where that is, (cells, 2).
    """

    cells: Views
    thresholds: Array
    largest: Array
    u: Array
    index: Array  # alpha of each cell; inf where the weight has stopped growing


def search(probe: Probe, effort: Effort, rng: np.random.Generator) -> Tails:
    """Follow the largest weights at the settings and views of the effort."""
    return follow(probe, views_of(probe, effort.tail_views, effort.tail_rows), effort, rng)


def follow(probe: Probe, cells: Views, effort: Effort, rng: np.random.Generator) -> Tails:
    """Follow the largest weights of every cell, all cells together."""
    count, size = len(cells), effort.tail_particles
    wo, parameters = np.repeat(cells.wo, size, axis=0), np.repeat(cells.parameters, size, axis=0)

    def weigh(u: Array) -> Array:
        w = probe.draw(wo, u.reshape(-1, 2), parameters, "double").weight.reshape(count, size)
        return np.where(np.isnan(w), -1.0, w)

    u = rng.random((count, size, 2))
    w = weigh(u)
    largest, place = np.full(count, -np.inf), np.zeros((count, 2))
    thresholds = []
    for _ in range(effort.tail_levels):
        largest, place = _note_largest(largest, place, u, w)
        order = np.argsort(-w, axis=1)[:, : size // KEPT]
        threshold = np.take_along_axis(w, order[:, -1:], axis=1)
        thresholds.append(threshold[:, 0])
        parents = np.tile(order, (1, KEPT))
        u = np.take_along_axis(u, parents[..., None], axis=1)
        w = np.take_along_axis(w, parents, axis=1)
        for _ in range(effort.tail_moves):
            proposed = _moved(u, rng)
            weight = weigh(proposed)
            better = weight >= threshold
            u = np.where(better[..., None], proposed, u)
            w = np.where(better, weight, w)
    largest, place = _note_largest(largest, place, u, w)
    levels = np.array(thresholds)
    return Tails(cells, levels, largest, place, np.array([tail_index(levels[:, i]) for i in range(count)]))


def _note_largest(largest: Array, place: Array, u: Array, w: Array) -> tuple[Array, Array]:
    best = np.argmax(w, axis=1)
    top = np.take_along_axis(w, best[:, None], axis=1)[:, 0]
    better = top > largest
    return np.where(better, top, largest), np.where(better[:, None], u[np.arange(len(u)), best], place)


def _moved(u: Array, rng: np.random.Generator) -> Array:
    """Every member moved by the scaled difference of two others, in both numbers or in one: a symmetric proposal."""
    count, size, _ = u.shape
    a, b = rng.integers(0, size, (2, count, size))
    rows = np.arange(count)[:, None]
    step = (u[rows, a] - u[rows, b]) * 2.0 ** rng.uniform(-6, 1, (count, size, 1))
    alone = rng.integers(0, 3, (count, size))
    step[..., 0] *= alone != 1
    step[..., 1] *= alone != 2
    moved = u + step
    # Reflected at the borders of the square.
    moved = np.abs(np.mod(moved + 1.0, 2.0) - 1.0)
    inside = (u + step >= 0) & (u + step < 1)
    return np.asarray(np.minimum(np.where(inside, u + step, moved), _LAST))


def tail_index(thresholds: Array) -> float:
    """alpha in P(w > W) ~ W^-alpha from the last levels; inf where the weight no longer grows."""
    last = thresholds[-FITTED - 1 :]
    if not np.isfinite(last).all():
        return 0.0
    if last[0] <= 0 or last[-1] <= last[0] * (1 + 1e-9):
        return math.inf
    x = math.log(KEPT) * np.arange(len(last))
    growth = float(np.polyfit(x, np.log(last), 1)[0])
    # A weight that approaches its bound slows down; a power law does not.
    half = len(last) // 2
    late = math.log(last[-1] / last[half]) / (x[-1] - x[half])
    growth = min(growth, 1.5 * late)
    return 1.0 / growth if growth > 1e-12 else math.inf


def _evidence(t: Tails, cell: int) -> dict[str, Any]:
    return {
        "theta_o_deg": math.degrees(t.cells.theta_o[cell]),
        "parameters": t.cells.parameters[cell],
        "tail_index": float(t.index[cell]),
        "thresholds": t.thresholds[:, cell],
        "probability_step": 1 / KEPT,
        "u": t.u[cell],
    }


def check_tail(probe: Probe, t: Tails) -> Outcome:
    """The weight has a variance: its tail falls faster than W^-2."""
    power = (
        f"{len(t.cells)} settings and views, P(w > W) followed down to {KEPT ** -float(len(t.thresholds)):.0e}; "
        f"an index up to {INFINITE_VARIANCE:g} counts as infinite variance"
    )
    worst = int(np.argmin(t.index))
    if t.index[worst] >= INFINITE_VARIANCE:
        return passed("tail", "the weight has a finite variance", power, **_evidence(t, worst))
    return failed(
        "tail",
        f"the weight has no variance: P(w > W) falls like W^-{t.index[worst]:.3g}, in "
        f"{int((t.index < INFINITE_VARIANCE).sum())} of {len(t.index)} settings and views",
        power,
        replay(probe, t.cells.wo[worst], t.cells.parameters[worst], u=t.u[worst]),
        **_evidence(t, worst),
    )


def check_supremum(probe: Probe, t: Tails) -> Outcome:
    """For a fixed view the weight has an upper bound."""
    power = (
        f"{len(t.cells)} settings and views; growth as a power of 1/probability, index up to {UNBOUNDED:g}, down to a "
        f"probability of {KEPT ** -float(len(t.thresholds)):.0e}; slower growth, as of a logarithm, is not told from a "
        "bound"
    )
    worst = int(np.argmin(t.index))
    exceeded = t.thresholds[6 - 1]  # by one sample in 4^6
    if t.index[worst] >= UNBOUNDED:
        top = int(np.argmax(t.largest))
        return passed(
            "supremum",
            f"the weight is bounded; the largest one found by search is {t.largest[top]:.5g}",
            power,
            supremum=float(t.largest[top]),
            exceeded_once_in_4096=float(exceeded[top]),
            **_evidence(t, top),
        )
    return failed(
        "supremum",
        f"the weight has no upper bound, or one beyond the search: {t.largest[worst]:.3g} found, still growing; one "
        f"sample in 4,096 exceeds {exceeded[worst]:.3g}",
        power,
        replay(probe, t.cells.wo[worst], t.cells.parameters[worst], u=t.u[worst]),
        largest_found=float(t.largest[worst]),
        exceeded_once_in_4096=float(exceeded[worst]),
        **_evidence(t, worst),
    )
