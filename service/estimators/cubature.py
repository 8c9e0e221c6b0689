"""Adaptive quadrature of the moments of the weight over (u1, u2), for many cells at once.

Panels whose estimated error matters are cut, in the direction in which the integrand is rough, until every cell reaches
its tolerance or its budget. Kinks and jumps of the mapping and of the BRDF are so enclosed in ever smaller panels
wherever they are; u1 is graded towards 0, where the mapping of most techniques has a root and the weight its tail.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.estimators.panels import (
    ABSCISSAE,
    GAUSS_WEIGHTS,
    NARROWEST,
    NODES,
    POINTS,
    SIDE,
    Array,
    Integers,
    Panels,
    children,
    divisible,
    first_panels,
    measure,
)

ROUNDS = 40
LEAST_STEPS = 6  # before a growing variance is called infinite

COHERENCE = 4.0
DAMPING = 3.0
"""With these two no cell of the catalogue has an error above the one stated: tests/service/estimators."""

_RULE = 0.5 * GAUSS_WEIGHTS
_NORMS = np.sqrt(2.0 * np.arange(SIDE) + 1.0)
_LEGENDRE = np.polynomial.legendre.legvander(ABSCISSAE, SIDE - 1).T * _NORMS[:, None] * _RULE
"""From node values to coefficients of orthonormal Legendre polynomials, shape (8, 8)."""


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
    narrowest: float = NARROWEST  # width of a panel, as a share of its place

    def targets(self, mean: Array, variance: Array) -> tuple[Array, Array]:
        """The errors of variance and mean that are good enough, shape (cells,) each."""
        enough = np.maximum(self.tolerance * variance, self.least)
        return np.where(self.variance, enough, np.inf), self.tolerance * np.maximum(np.abs(mean), self.least)


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
    panels: Panels  # the last ones
    highest: Array  # largest weight at the nodes of each of them


@dataclass
class _Sums:
    """Integrals over each panel, a column a panel, and the roughness of the integrands."""

    rows: Array  # 4 powers, zero measure; errors of w and of its square along u1 and u2; largest w: shape (10, n)

    def joined(self, other: _Sums) -> _Sums:
        return _Sums(np.concatenate([self.rows, other.rows], axis=1))


def integrate(
    cells: int, split: bool, goal: Goal, evaluate: Callable[[Panels], Values], first: Panels | None = None
) -> Integrals:
    """Integrate the first four powers of (weight - shift) for every cell; `evaluate` gives weights at nodes.

    split: whether the technique splits u1. first: panels to begin with, which cover the square of every cell, in place
    of the usual ones.
    """
    fresh = first_panels(cells, split) if first is None else first
    values = evaluate(fresh)
    seen = _Seen(cells)
    weights = seen.add(fresh, values.weights)
    shift = _cell_sums(fresh.cell, measure(fresh, values.splits) * _integral(weights), cells)
    panels, sums = fresh, _panel_sums(fresh, values.splits, weights, shift)
    history: list[Array] = []
    active: list[NDArray[np.bool_]] = []
    for _ in range(ROUNDS):
        error = _errors(panels, sums, cells)
        variance = error.powers[1] - error.powers[0] ** 2
        history.append(variance)
        target, mean_target = goal.targets(shift + error.powers[0], variance)
        done = (error.variance <= target) & (error.mean <= mean_target)
        spent = seen.nodes >= goal.nodes
        if np.all(done | spent):
            break
        cut = _worst(panels, error, target, mean_target) & ~(done | spent)[panels.cell]
        cut &= divisible(panels, goal.narrowest)
        active.append(np.bincount(panels.cell[cut], minlength=cells) > 0)
        if not cut.any():
            break
        along_1, along_2 = error.direction(cut)
        fresh = children(panels.pick(cut), along_1, along_2)
        weights = seen.add(fresh, evaluate(fresh).weights)
        panels = panels.pick(~cut).joined(fresh)
        sums = _Sums(sums.rows[:, ~cut]).joined(_panel_sums(fresh, values.splits, weights, shift))
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
        panels=panels,
        highest=sums.rows[9],
    )


def _integral(values: Array) -> Array:
    """Mean over each panel of values at its nodes, (n, 64) to (n,)."""
    return values @ np.outer(_RULE, _RULE).ravel()


def _cell_sums(cell: Integers, values: Array, cells: int) -> Array:
    return np.bincount(cell, weights=values, minlength=cells).astype(np.float64)


def _panel_sums(panels: Panels, splits: Array, weights: Array, shift: Array) -> _Sums:
    area = measure(panels, splits)
    deviation = weights - shift[panels.cell, None]
    square = deviation * deviation
    rows = [_integral(power) for power in (deviation, square, deviation * square, square * square)]
    rows.append(_integral((weights == 0.0).astype(np.float64)))
    rows += [*_roughness(deviation), *_roughness(square)]
    return _Sums(np.concatenate([np.stack(rows) * area, weights.max(axis=1)[None]]))


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
        along = np.abs(modes[:, :, 0]) + np.sqrt(np.sum(modes[:, :, 1:] ** 2, axis=2))
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
