"""Rectangles of the (u1, u2) square with 8 x 8 Gauss-Legendre nodes, for many cells at once."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SIDE = 8
NODES = SIDE * SIDE
GRADING = 16.0  # neighbouring ends of u1 panels differ by this factor
GRADED_PANELS = 4
NARROWEST = 2.0**-20  # of its place: float32 would not tell the nodes of a narrower panel apart
NARROWEST_DOUBLE = 2.0**-46  # the same for double precision
SMALLEST = 2.0**-100  # at 0, where float32 is fine, panels may be this small

ABSCISSAE, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(SIDE)
"""The rule on [-1, 1], shape (8,) each."""
POINTS = 0.5 * (ABSCISSAE + 1.0)
"""Nodes in [0, 1], shape (8,)."""


@dataclass(frozen=True)
class Panels:
    """Rectangles: the cell, the part of u1 (1 above the technique's split), and low t, low u2, both widths (n, 4)."""

    cell: Integers
    part: Integers
    corner: Array

    def __len__(self) -> int:
        return len(self.cell)

    def pick(self, chosen: NDArray[np.bool_] | NDArray[np.integer[Any]]) -> Panels:
        """The chosen ones, or those of these numbers in their order."""
        return Panels(self.cell[chosen], self.part[chosen], self.corner[chosen])

    def joined(self, other: Panels) -> Panels:
        """These and the others."""
        return Panels(
            np.concatenate([self.cell, other.cell]),
            np.concatenate([self.part, other.part]),
            np.concatenate([self.corner, other.corner]),
        )


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


def measure(panels: Panels, splits: Array) -> Array:
    """Area of each panel in the (u1, u2) square."""
    part = np.where(panels.part == 1, 1.0 - splits[panels.cell], splits[panels.cell])
    return np.asarray(part * panels.corner[:, 2] * panels.corner[:, 3])


def divisible(panels: Panels, narrowest: float) -> NDArray[np.bool_]:
    """Which panels the arithmetic lets one cut: those wider than this share of their place."""
    low, width = panels.corner[:, :2], panels.corner[:, 2:]
    return np.asarray(np.all(width > np.where(low > 0.0, narrowest * (low + width), SMALLEST), axis=1))


def children(panels: Panels, along_1: NDArray[np.bool_], along_2: NDArray[np.bool_]) -> Panels:
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
