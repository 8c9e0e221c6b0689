"""Adaptive Gauss-Legendre quadrature of moments of the weight over (u1, u2), for many cells at once.

The square is cut into rectangles with 8 x 8 nodes. Those whose estimated error matters are cut again, in the direction
in which the integrand is rough, until every cell reaches its tolerance or its budget. Kinks and jumps of the mapping
and of the BRDF are so enclosed in ever smaller panels wherever they are; u1 is graded towards 0, where the mapping of
most techniques has a root and the weight its tail.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SIDE = 8
NODES = SIDE * SIDE
GRADING = 16.0  # neighbouring ends of u1 panels differ by this factor
GRADED_PANELS = 4
ROUNDS = 40
LEAST_STEPS = 6  # before a growing variance is called infinite
NARROWEST = 2.0**-20  # of its place: float32 would not tell the nodes of a narrower panel apart
SMALLEST = 2.0**-100  # at 0, where float32 is fine, panels may be this small

COHERENCE = 4.0
AVERAGED = 1.0
DAMPING = 3.0  # with these three, no cell of the catalogue has an error above the one stated; see the tests

_points, _weights = np.polynomial.legendre.leggauss(SIDE)
POINTS = 0.5 * (_points + 1.0)
"""Nodes in [0, 1], shape (8,)."""
_RULE = 0.5 * _weights
_LEGENDRE = (
    np.polynomial.legendre.legvander(_points, SIDE - 1).T * np.sqrt(2.0 * np.arange(SIDE) + 1.0)[:, None] * _RULE
)
"""From node values to coefficients of orthonormal Legendre polynomials, shape (8, 8)."""


@dataclass(frozen=True)
class Panels:
    """Rectangles: the cell, the part of u1 (1 above the technique's split), and low t, low u2, both widths (n, 4)."""

    cell: Integers
    part: Integers
    corner: Array

    def __len__(self) -> int:
        return len(self.cell)

    def pick(self, chosen: NDArray[np.bool_]) -> Panels:
        """The chosen ones."""
        return Panels(self.cell[chosen], self.part[chosen], self.corner[chosen])

    def joined(self, other: Panels) -> Panels:
        """These and the others."""
        return Panels(
            np.concatenate([self.cell, other.cell]),
            np.concatenate([self.part, other.part]),
            np.concatenate([self.corner, other.corner]),
        )


@dataclass(frozen=True)
class Values:
    """What a round of evaluation gives: weights at the nodes (n, 64), and the split of u1 of every cell."""

    weights: Array
    splits: Array


@dataclass(frozen=True)
class Goal:
    """What every cell must reach: relative error of mean and variance, and whether the variance counts, (cells,)."""

    tolerance: float
    least: float  # a variance below it is to be right absolutely
    variance: NDArray[np.bool_]
    nodes: int  # for each cell, at the most


@dataclass(frozen=True)
class Integrals:
    """Moments about `shift`, shape (4, cells), their error bounds as estimated, and what was seen at the nodes."""

    shift: Array
    powers: Array
    mean_error: Array
    variance_error: Array
    zero: Array  # measure of the part of the square with weight 0
    largest: Array
    nonfinite: Integers
    negative: Integers
    bad_panel: Panels  # of the first node with a weight that is not finite, a panel a cell; width 0 where none is
    nodes: Integers  # evaluated, for each cell
    converged: NDArray[np.bool_]
    growing: NDArray[np.bool_]  # the variance still rose, by no smaller steps, when the budget ended


@dataclass
class _Sums:
    """Integrals over each panel, a column a panel, and the roughness of the integrands."""

    rows: Array  # 4 powers, zero measure; errors of w and of its square along u1 and u2: shape (9, n)

    def joined(self, other: _Sums) -> _Sums:
        return _Sums(np.concatenate([self.rows, other.rows], axis=1))


def first_panels(cells: int, split: bool) -> Panels:
    """The first cut: u2 at its quarters, where s changes sign for a view in the plane of u2 = 0; u1 graded."""
    ends = [0.0, *(GRADING**-k for k in range(GRADED_PANELS, 0, -1)), 0.25, 0.5, 1.0]
    rows = [
        (part, low, quarter / 4, high - low, 0.25)
        for part in ((0, 1) if split else (1,))
        for low, high in pairwise(ends)
        for quarter in range(4)
    ]
    table = np.tile(np.array(rows), (cells, 1))
    return Panels(np.repeat(np.arange(cells), len(rows)), table[:, 0].astype(np.int64), table[:, 1:].copy())


def integrate(cells: int, split: bool, goal: Goal, evaluate: Callable[[Panels], Values]) -> Integrals:
    """Integrate the first four powers of (weight - shift) for every cell; `evaluate` gives weights at nodes."""
    fresh = first_panels(cells, split)
    values = evaluate(fresh)
    seen = _Seen(cells)
    weights = seen.add(fresh, values.weights)
    shift = _cell_sums(fresh.cell, _measure(fresh, values.splits) * _integral(weights), cells)
    panels, sums = fresh, _panel_sums(fresh, values.splits, weights, shift)
    history: list[Array] = []
    active: list[NDArray[np.bool_]] = []
    for _ in range(ROUNDS):
        error = _errors(panels, sums, cells)
        variance = error.powers[1] - error.powers[0] ** 2
        history.append(variance)
        target = np.where(goal.variance, goal.tolerance * np.maximum(variance, goal.least / goal.tolerance), np.inf)
        mean_target = goal.tolerance * np.maximum(np.abs(shift + error.powers[0]), goal.least)
        done = (error.variance <= target) & (error.mean <= mean_target)
        spent = seen.nodes >= goal.nodes
        if np.all(done | spent):
            break
        cut = _worst(panels, error, target, mean_target) & ~(done | spent)[panels.cell]
        cut &= _divisible(panels)
        active.append(np.bincount(panels.cell[cut], minlength=cells) > 0)
        if not cut.any():
            break
        along_1, along_2 = error.direction(cut)
        fresh = _children(panels.pick(cut), along_1, along_2)
        weights = seen.add(fresh, evaluate(fresh).weights)
        kept = ~cut
        panels = panels.pick(kept).joined(fresh)
        sums = _Sums(sums.rows[:, kept]).joined(_panel_sums(fresh, values.splits, weights, shift))
    return Integrals(
        shift=shift,
        powers=error.powers,
        mean_error=error.mean,
        variance_error=error.variance,
        zero=_cell_sums(panels.cell, sums.rows[4], cells),
        largest=seen.largest,
        nonfinite=seen.nonfinite,
        negative=seen.negative,
        bad_panel=seen.bad_panel,
        nodes=seen.nodes,
        converged=done,
        growing=~done & _growing(history, active),
    )


def _measure(panels: Panels, splits: Array) -> Array:
    """Area of each panel in the (u1, u2) square."""
    part = np.where(panels.part == 1, 1.0 - splits[panels.cell], splits[panels.cell])
    return np.asarray(part * panels.corner[:, 2] * panels.corner[:, 3])


def _integral(values: Array) -> Array:
    """Mean over each panel of values at its nodes, (n, 64) to (n,)."""
    return values @ np.outer(_RULE, _RULE).ravel()


def _cell_sums(cell: Integers, values: Array, cells: int) -> Array:
    return np.bincount(cell, weights=values, minlength=cells).astype(np.float64)


def _panel_sums(panels: Panels, splits: Array, weights: Array, shift: Array) -> _Sums:
    area = _measure(panels, splits)
    deviation = weights - shift[panels.cell, None]
    square = deviation * deviation
    rows = [_integral(power) for power in (deviation, square, deviation * square, square * square)]
    rows.append(_integral((weights == 0.0).astype(np.float64)))
    rows += [*_roughness(deviation), *_roughness(square)]
    return _Sums(np.stack(rows) * area)


def _roughness(values: Array) -> tuple[Array, Array]:
    """Error bounds of a panel's mean along u1 and u2, from how its highest Legendre coefficients decay.

    The eight-point rule is exact to degree 15; the coefficients of degree 5 to 7, damped where they are much smaller
    than those of degree 2 to 4, stand for all that it misses. For a kink that is about right, for a smooth integrand
    far too much. Three degrees, because for some places of a kink one or two of them vanish.
    """
    coefficients = _LEGENDRE @ values.reshape(-1, SIDE, SIDE) @ _LEGENDRE.T
    out = []
    for modes in (coefficients, coefficients.swapaxes(1, 2)):
        # The rest of each row has errors of any sign, which the other rows average.
        along = np.abs(modes[:, :, 0]) + AVERAGED * np.sqrt(np.sum(modes[:, :, 1:] ** 2, axis=2))
        high, low = along[:, 5:].sum(axis=1), along[:, 2:5].sum(axis=1)
        out.append(high * np.minimum(1.0, DAMPING * high / np.maximum(low, 1e-300)))
    return out[0], out[1]


@dataclass(frozen=True)
class _Errors:
    powers: Array
    mean: Array
    variance: Array
    panel_mean: Array
    panel_variance: Array
    along: Array  # (2, n): error of the second moment and the first, together, along u1 and u2

    def direction(self, cut: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Along which axes each cut panel is to be halved: both, where neither is much the rougher."""
        one, two = self.along[:, cut]
        return one >= 0.25 * two, two > 0.25 * one


def _errors(panels: Panels, sums: _Sums, cells: int) -> _Errors:
    powers = np.stack([_cell_sums(panels.cell, row, cells) for row in sums.rows[:4]])
    first, second = sums.rows[5:7], sums.rows[7:9]
    mean, square = first.sum(axis=0), second.sum(axis=0)
    # variance = second moment - (first moment)^2, both about the shift, which is the mean of the first round.
    variance = square + 2.0 * np.abs(powers[0])[panels.cell] * mean
    scale = np.maximum(np.abs(powers[0]), np.sqrt(np.maximum(powers[1], 1e-300)))[panels.cell]
    return _Errors(
        powers=powers,
        mean=_combined(_cell_sums(panels.cell, mean, cells), _cell_sums(panels.cell, mean**2, cells)),
        variance=_combined(_cell_sums(panels.cell, variance, cells), _cell_sums(panels.cell, variance**2, cells)),
        panel_mean=mean,
        panel_variance=variance,
        along=second + scale * first,
    )


def _combined(total: Array, squares: Array) -> Array:
    """The error bound of many panels: their sum, or COHERENCE times the root of the sum of squares, if less.

    Along a kink that lies aslant, errors of panels differ in sign; along one that is parallel to an axis they do not,
    but those are few.
    """
    return np.asarray(np.minimum(total, COHERENCE * np.sqrt(squares)))


def _worst(panels: Panels, error: _Errors, target: Array, mean_target: Array) -> NDArray[np.bool_]:
    """The panels to cut: those whose errors, the smallest left out, sum to more than half of the cell's target."""
    cut = np.zeros(len(panels), bool)
    for one, limit in ((error.panel_variance, target), (error.panel_mean, mean_target)):
        order = np.lexsort((one, panels.cell))
        cell = panels.cell[order]
        starts = np.searchsorted(cell, np.arange(len(limit)))
        left = _combined(_running(one[order], starts, cell), _running(one[order] ** 2, starts, cell))
        cut[order] |= left > 0.5 * limit[cell]
    return cut


def _running(values: Array, starts: Integers, cell: Integers) -> Array:
    """Running sums of values sorted by cell, each cell's beginning anew at its start."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray(np.maximum(sums[1:] - sums[starts][cell], 0.0))


def _divisible(panels: Panels) -> NDArray[np.bool_]:
    low, width = panels.corner[:, :2], panels.corner[:, 2:]
    return np.asarray(np.all(width > np.where(low > 0.0, NARROWEST * (low + width), SMALLEST), axis=1))


def _children(panels: Panels, along_1: NDArray[np.bool_], along_2: NDArray[np.bool_]) -> Panels:
    """Each panel cut in two along the directions asked for. A panel that begins at t = 0 is cut close to it."""
    for axis, chosen in ((0, along_1), (1, along_2)):
        chosen = chosen if axis == 0 else np.concatenate([along_2, along_2[along_1]])
        low, width = panels.corner[chosen, axis], panels.corner[chosen, 2 + axis]
        first = width * 0.5
        if axis == 0:
            graded = np.where(low > 0.0, np.sqrt(np.maximum(low, 1e-300) * (low + width)) - low, width / GRADING)
            first = np.where((low == 0.0) | (low + width > 3.0 * low), graded, first)
        lower, upper = panels.corner.copy(), panels.corner[chosen].copy()
        lower[chosen, 2 + axis] = first
        upper[:, axis], upper[:, 2 + axis] = low + first, width - first
        panels = Panels(panels.cell, panels.part, lower).joined(Panels(panels.cell[chosen], panels.part[chosen], upper))
    return panels


def _growing(history: list[Array], active: list[NDArray[np.bool_]]) -> NDArray[np.bool_]:
    """Whether the variance rose in every step by about as much, which is what a logarithmic divergence does.

    Steps count where the cell was still being cut. A convergent integral's steps shrink by a factor each.
    """
    out = np.zeros(len(history[0]), bool)
    steps = np.diff(np.stack(history), axis=0)
    for cell in range(len(out)):
        mine = steps[np.stack(active)[: len(steps), cell], cell] if len(steps) else steps
        if len(mine) >= LEAST_STEPS:
            early, late = np.median(mine[: len(mine) // 2]), np.median(mine[len(mine) // 2 :])
            out[cell] = early > 0.0 and late > 0.5 * early
    return out


class _Seen:
    """Extremes and counts over all nodes evaluated so far."""

    def __init__(self, cells: int) -> None:
        self.nodes = np.zeros(cells, np.int64)
        self.nonfinite = np.zeros(cells, np.int64)
        self.negative = np.zeros(cells, np.int64)
        self.largest = np.full(cells, -np.inf)
        self.bad_panel = Panels(np.arange(cells), np.zeros(cells, np.int64), np.zeros((cells, 4)))

    def add(self, panels: Panels, weights: Array) -> Array:
        """Count and return the weights with 0 in place of what is not finite."""
        bad = ~np.isfinite(weights)
        clean = np.where(bad, 0.0, weights)
        np.add.at(self.nodes, panels.cell, NODES)
        np.add.at(self.negative, panels.cell, (clean < 0.0).sum(axis=1))
        np.maximum.at(self.largest, panels.cell, np.where(bad, -np.inf, weights).max(axis=1))
        for index in np.flatnonzero(bad.any(axis=1))[::-1]:
            cell, node = panels.cell[index], int(np.argmax(bad[index]))
            self.nonfinite[cell] += int(bad[index].sum())
            low, width = panels.corner[index, :2], panels.corner[index, 2:]
            point = low + width * np.array([POINTS[node // SIDE], POINTS[node % SIDE]])
            self.bad_panel.corner[cell] = [*point, *width]
            self.bad_panel.part[cell] = panels.part[index]
        return clean
