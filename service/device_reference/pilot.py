"""First panels that follow what a few thousand points have seen, so that the quadrature misses no narrow lobe."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from service.estimators.panels import GRADED_PANELS, GRADING, Array, Integers, Panels

COLUMNS = 96
EVEN_ROWS, FINE_ROWS = 64, 16
"""Strata of the pilot, with one point each: columns in u2; rows in u1, the first and the last halved many times."""

EIGHTHS = 8
HEAVY = 1.0 / 48.0
"""A panel with a larger share of the pilot's sum is cut in four."""

FEW = 8
"""Points in a panel that are too few to cut it: the nodes of the rule then resolve what they have seen."""

ROUNDS = 16


@dataclass(frozen=True)
class Points:
    """Points of the square, all of one length: their cell, part of u1 (see `Panels`), t, u2, and their importance.

    The importance of a cell's points sums to about 1: its share of the integral that a point stands for.
    """

    cell: Integers
    part: Integers
    t: Array
    u2: Array
    importance: Array

    def joined(self, other: Points) -> Points:
        """These and the others."""
        pairs = ((getattr(self, name), getattr(other, name)) for name in self.__dataclass_fields__)
        return Points(*(np.concatenate(pair) for pair in pairs))


def stratified() -> tuple[Array, Array]:
    """The pilot's points of the square, (n, 2), one at random in each stratum, and the area of that stratum, (n,).

    Rows are narrow at both ends of u1: there lie the horizon and the tails of most techniques.
    """
    halves = 0.5 ** np.arange(FINE_ROWS, 0, -1) / EVEN_ROWS
    ends = np.concatenate([[0.0], halves, np.arange(1, EVEN_ROWS) / EVEN_ROWS, 1.0 - halves[::-1], [1.0]])
    row, column = np.divmod(np.arange((len(ends) - 1) * COLUMNS), COLUMNS)
    height = np.diff(ends)[row]
    jitter = np.random.default_rng(1).random((len(row), 2))
    return np.stack([ends[row] + height * jitter[:, 0], (column + jitter[:, 1]) / COLUMNS], axis=1), height / COLUMNS


def shares(values: Array) -> Array:
    """Importance of non-negative values, (cells, n): each as a share of its cell's sum, 0 where that is 0."""
    total = values.sum(axis=1, keepdims=True)
    return np.asarray(values / np.where(total > 0.0, total, 1.0))


_GRADED = tuple(GRADING**-k for k in range(GRADED_PANELS, 0, -1))
GRADED_AT_0 = (0.0, *_GRADED, 0.25, 0.5, 0.75, 1.0)
GRADED_AT_BOTH = (*GRADED_AT_0[:-1], *(1.0 - x for x in reversed(_GRADED)), 1.0)
"""Ends of the first panels in u1."""


def piloted_panels(cells: int, parts: tuple[int, ...], points: Points, graded: tuple[float, ...]) -> Panels:
    """Panels of every cell with these ends in u1, cut wherever the points carry much."""
    ends = np.array(graded)
    rows = [
        (part, low, k / EIGHTHS, high - low, 1.0 / EIGHTHS)
        for part in parts
        for low, high in pairwise(ends)
        for k in range(EIGHTHS)
    ]
    table = np.tile(np.array(rows), (cells, 1))
    panels = Panels(np.repeat(np.arange(cells), len(rows)), table[:, 0].astype(np.int64), table[:, 1:].copy())
    band = np.clip(np.searchsorted(ends, points.t, side="right") - 1, 0, len(ends) - 2)
    eighth = np.minimum((points.u2 * EIGHTHS).astype(np.int64), EIGHTHS - 1)
    first = np.searchsorted(parts, points.part) * (len(ends) - 1) + band
    at = points.cell * len(rows) + first * EIGHTHS + eighth
    for _ in range(ROUNDS):
        carried = np.bincount(at, points.importance, minlength=len(panels))
        cut = (carried > HEAVY) & (np.bincount(at, minlength=len(panels)) >= FEW)
        if not cut.any():
            break
        panels, at = _quartered(panels, at, cut, points)
    return panels


def _quartered(panels: Panels, at: Integers, cut: NDArray[np.bool_], points: Points) -> tuple[Panels, Integers]:
    """The panels with the chosen ones in quarters, and the panel of each point among them."""
    whole, halved = panels.pick(~cut), panels.pick(cut)
    low, half = halved.corner[:, :2], 0.5 * halved.corner[:, 2:]
    for i in (0, 1):
        for k in (0, 1):
            corner = np.concatenate([low + half * np.array([i, k]), half], axis=1)
            whole = whole.joined(Panels(halved.cell, halved.part, corner))
    number = np.where(cut, np.cumsum(cut) - 1, np.cumsum(~cut) - 1)
    middle = panels.corner[:, :2] + 0.5 * panels.corner[:, 2:]
    quarter = 2 * (points.t >= middle[at, 0]) + (points.u2 >= middle[at, 1])
    moved = int((~cut).sum()) + quarter * int(cut.sum()) + number[at]
    return whole, np.where(cut[at], moved, number[at])
