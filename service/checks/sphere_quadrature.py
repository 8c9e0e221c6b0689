"""Adaptive quadrature over the sphere, in boxes of equal-area coordinates.

A direction is (t, phi): t = 1 - z in [0, 2] and the azimuth in [0, 2 pi); area on the sphere is dt dphi (Archimedes).
The horizon is t = 1. Directions are formed from t without cancellation, so that lobes of any width about the normal
resolve.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Integrands = Callable[[Array, Array], Array]
"""Called with directions (n, 3) and the cell of each (n,): the values of k integrands, (k, n)."""

TURN = 2 * np.pi
CHUNK = 1 << 17
"""Directions evaluated at a time: few enough that the arrays between stay in the processor's caches."""

HIDDEN = 2.0
"""A value known inside a box that exceeds all values at the rule's nodes by this factor: the rule has missed a lobe."""

WIDEST = np.pi / 12
"""Azimuths that a first box spans at the most: a lobe at the edge of a wide and flat box would be missed."""


@dataclass(frozen=True)
class Boxes:
    """Boxes [t0, t1] x [p0, p1], each of one cell and one bin of that cell; arrays of shape (n,)."""

    t0: Array
    t1: Array
    p0: Array
    p1: Array
    cell: Array
    bin: Array

    def __len__(self) -> int:
        return len(self.t0)

    def __getitem__(self, where: Any) -> Boxes:
        return Boxes(*(getattr(self, name)[where] for name in self.__dataclass_fields__))

    def quarters(self) -> Boxes:
        """Four boxes for each, the children of box i at 4 i ... 4 i + 3."""
        tm, pm = 0.5 * (self.t0 + self.t1), 0.5 * (self.p0 + self.p1)
        t0, t1 = _weave(self.t0, tm, self.t0, tm), _weave(tm, self.t1, tm, self.t1)
        p0, p1 = _weave(self.p0, self.p0, pm, pm), _weave(pm, pm, self.p1, self.p1)
        return Boxes(t0, t1, p0, p1, np.repeat(self.cell, 4), np.repeat(self.bin, 4))


def cut(boxes: Boxes, area: float) -> Boxes:
    """The same boxes in pieces of at most this area and width, finer towards the horizon, so that nothing is missed."""
    for edge in ("t0", "t1"):
        touching = getattr(boxes, edge) == 1.0
        boxes = _concatenate([boxes[~touching], *_graded(boxes[touching], edge)])
    while (wide := boxes.p1 - boxes.p0 > WIDEST).any():
        boxes = _concatenate([boxes[~wide], *_halves(boxes[wide])])
    while (large := (boxes.t1 - boxes.t0) * (boxes.p1 - boxes.p0) > area).any():
        boxes = _concatenate([boxes[~large], boxes[large].quarters()])
    return boxes


def _halves(boxes: Boxes) -> list[Boxes]:
    middle = 0.5 * (boxes.p0 + boxes.p1)
    return [replace(boxes, p1=middle), replace(boxes, p0=middle)]


def _graded(boxes: Boxes, edge: str) -> list[Boxes]:
    height = boxes.t1 - boxes.t0
    shares = (0.0, 1e-3, 1e-2, 1e-1, 1.0)
    out = []
    for low, high in itertools.pairwise(shares):
        if edge == "t0":
            ends = boxes.t0 + low * height, boxes.t0 + high * height
        else:
            ends = boxes.t1 - high * height, boxes.t1 - low * height
        out.append(Boxes(*ends, boxes.p0, boxes.p1, boxes.cell, boxes.bin))
    return out


def _concatenate(parts: list[Boxes]) -> Boxes:
    return Boxes(*(np.concatenate([getattr(part, name) for part in parts]) for name in Boxes.__dataclass_fields__))


def _weave(*columns: Array) -> Array:
    return np.stack(columns, axis=1).ravel()


def directions(t: Array, phi: Array) -> Array:
    """Unit vectors (n, 3) in double precision."""
    sine = np.sqrt(t * (2.0 - t))
    out = np.empty((*t.shape, 3))
    np.multiply(sine, np.cos(phi), out=out[..., 0])
    np.multiply(sine, np.sin(phi), out=out[..., 1])
    np.subtract(1.0, t, out=out[..., 2])
    return out


def coordinates(wi: Array) -> tuple[Array, Array]:
    """(t, phi) of directions; t keeps its relative accuracy at the normal."""
    w = np.asarray(wi, np.float64)
    squared = w[:, 0] ** 2 + w[:, 1] ** 2
    t = np.where(w[:, 2] > 0.0, squared / (1.0 + np.abs(w[:, 2])), 1.0 - w[:, 2])
    # A direction above the horizon stays on its side whatever the rounding of its length.
    t = np.where(w[:, 2] >= 0.0, np.minimum(t, 1.0), np.clip(t, np.nextafter(1.0, 2.0), 2.0))
    return t, np.mod(np.arctan2(w[:, 1], w[:, 0]), TURN)


def grid(cells: int, rows: int, columns: int, sphere: bool) -> Boxes:
    """A regular grid on the upper hemisphere of every cell, and on the lower one where asked; one bin a box."""
    top = np.linspace(0, 1, rows + 1)
    edges = np.concatenate([top, 1 + top[1:]]) if sphere else top
    around = np.linspace(0, TURN, columns + 1)
    t0, p0 = (a.ravel() for a in np.meshgrid(edges[:-1], around[:-1], indexing="ij"))
    t1, p1 = (a.ravel() for a in np.meshgrid(edges[1:], around[1:], indexing="ij"))
    count = len(t0)
    t0, t1, p0, p1 = (np.tile(a, cells) for a in (t0, t1, p0, p1))
    return Boxes(t0, t1, p0, p1, np.repeat(np.arange(cells), count), np.tile(np.arange(count), cells))


@cache
def _rule(order: int) -> tuple[Array, Array, Array]:
    nodes, weights = np.polynomial.legendre.leggauss(order)
    x, w = 0.5 * (nodes + 1.0), 0.5 * weights
    a, b = (c.ravel() for c in np.meshgrid(x, x, indexing="ij"))
    return a, b, np.outer(w, w).ravel()


def _integrate_once(boxes: Boxes, integrands: Integrands, order: int) -> tuple[Array, Array]:
    """Integrals over each box by a tensor Gauss-Legendre rule, (k, n), and the first integrand's largest value (n,)."""
    a, b, w = _rule(order)
    sums, largest = [], []
    step = max(1, CHUNK // len(w))
    for first in range(0, len(boxes), step):
        part = boxes[first : first + step]
        height, width = part.t1 - part.t0, part.p1 - part.p0
        t = part.t0[:, None] + height[:, None] * a
        phi = part.p0[:, None] + width[:, None] * b
        found = integrands(directions(t.ravel(), phi.ravel()), np.repeat(part.cell, len(w)))
        values = found.reshape(len(found), len(part), len(w))
        sums.append(values @ w * (height * width))
        largest.append(values[0].max(axis=1))
    return np.concatenate(sums, axis=1), np.concatenate(largest)


def _add_at(sums: Array, columns: Array, values: Array) -> None:
    """Add values (k, n) to the columns of sums (k, m), which may occur more than once."""
    for row, added in zip(sums, values, strict=True):
        row += np.bincount(columns, added, minlength=len(row))


@dataclass(frozen=True)
class Known:
    """Directions drawn with the first integrand for their density, (m,), and the values of all integrands there (m, k).

    They show the rule what lies between its nodes.
    """

    t: Array
    phi: Array
    cell: Array
    bin: Array
    values: Array

    def __getitem__(self, where: Any) -> Known:
        return Known(*(getattr(self, name)[where] for name in self.__dataclass_fields__))


@dataclass(frozen=True)
class Integrals:
    """Integrals by bin and error estimates of them, both (k, cells, bins)."""

    by_bin: Array
    error_by_bin: Array

    @property
    def total(self) -> Array:
        """Integrals over each cell, (k, cells)."""
        return np.asarray(self.by_bin.sum(axis=-1))

    @property
    def error(self) -> Array:
        """Error estimates of the totals, (k, cells)."""
        return np.asarray(self.error_by_bin.sum(axis=-1))


def _owners(known: Known, boxes: Boxes, bins: int) -> tuple[Known, Array]:
    """The known directions that lie in a box, and which; boxes of one bin do not overlap."""
    flat = boxes.cell * bins + boxes.bin
    order = np.argsort(flat, kind="stable")
    wanted = known.cell * bins + known.bin
    first = np.searchsorted(flat[order], wanted)
    count = np.searchsorted(flat[order], wanted, side="right") - first
    point = np.repeat(np.arange(len(wanted)), count)
    box = order[np.arange(len(point)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)]
    t, phi = known.t[point], known.phi[point]
    inside = (boxes.t0[box] <= t) & (t < boxes.t1[box]) & (boxes.p0[box] <= phi) & (phi < boxes.p1[box])
    return known[point[inside]], box[inside]


def _hidden(known: Known, owner: Array, boxes: Boxes, seen: Array, drawn: Array) -> tuple[Array, Array]:
    """What may hide in boxes from a rule that saw values up to `seen`, and in boxes like them; both (k, n).

    The first is the largest known value times the area of the box that holds it. The second comes from boxes that one
    direction alone shows: they are to boxes that none shows as species found once are to those not found (Good and
    Turing), so that direction's share of the integral, out of `drawn` in its cell, estimates what stays hidden.
    """
    above = known.values[:, 0] > HIDDEN * seen[owner]
    known, owner = known[above], owner[above]
    in_box, alike = np.zeros((2, known.values.shape[1], len(boxes)))
    alone = np.bincount(owner, minlength=len(boxes))[owner] == 1
    area = (boxes.t1 - boxes.t0) * (boxes.p1 - boxes.p0)
    for k, values in enumerate(known.values.T):
        np.maximum.at(in_box[k], owner, np.abs(values) * area[owner])
        share = np.abs(values) / (known.values[:, 0] * drawn[known.cell])
        alike[k] = np.bincount(owner[alone], share[alone], minlength=len(boxes))
    return in_box, alike


def integrate(
    boxes: Boxes,
    integrands: Integrands,
    shape: tuple[int, int],
    goal: float,
    points: int,
    order: int = 5,
    known: Known | None = None,
) -> Integrals:
    """Integrate over all bins, splitting boxes into quarters until two levels agree.

    shape: (cells, bins). goal: difference of two levels, as a share of the cell's total, at which a box is done.
    points: evaluations to spend at the most, shared fairly by the cells; what is left open then counts in the error.
    known: what is known of the integrands. Two levels that both miss a narrow lobe agree as well: where the first
    integrand's known value rises above all that they saw, the box stays open, and what may hide in it is its error.
    """
    cells, bins = shape
    values, _ = _integrate_once(boxes, integrands, order)
    by_bin, error = np.zeros((2, len(values), cells * bins))
    scale = np.zeros((len(values), cells))
    if known is not None:
        drawn = np.bincount(known.cell, minlength=cells)
        known, owner = _owners(known, boxes, bins)
    spent = 0
    while len(boxes):
        children = boxes.quarters()
        spent += len(children) * order * order
        fine, seen = _integrate_once(children, integrands, order)
        summed = fine.reshape(len(fine), len(boxes), 4).sum(axis=-1)
        difference = np.abs(summed - values)
        if not scale.any():
            _add_at(scale, boxes.cell, np.abs(summed))
            scale = np.maximum(scale, 1e-300)
        flat = boxes.cell * bins + boxes.bin
        if known is not None:
            hidden, alike = _hidden(known, owner, boxes, seen.reshape(-1, 4).max(axis=1), drawn)
            difference = np.maximum(difference, hidden)
            _add_at(error, flat, alike)
        is_open = _worth_splitting(difference, scale, goal, boxes.cell, max(0, points - spent) // (16 * order * order))
        done = ~is_open
        _add_at(by_bin, flat[done], summed[:, done])
        _add_at(error, flat[done], difference[:, done])
        if known is not None:
            known, owner = _handed_down(known, owner, boxes, is_open)
        kept = np.repeat(is_open, 4)
        boxes, values = children[kept], fine[:, kept]
    return Integrals(*(sums.reshape(len(sums), cells, bins) for sums in (by_bin, error)))


def _worth_splitting(difference: Array, scale: Array, goal: float, cell: Array, affordable: int) -> Array:
    """Boxes whose difference exceeds the goal, at most so many; cells take turns, each with its worst box first."""
    excess = np.max(difference / (goal * scale[:, cell]), axis=0)
    is_open: Array = excess > 1.0
    if is_open.sum() > affordable:
        order = np.lexsort((-excess, ~is_open, cell))
        first = np.searchsorted(cell[order], cell[order])
        turn = np.empty(len(cell), np.int64)
        turn[order] = np.arange(len(cell)) - first
        candidates = np.flatnonzero(is_open)
        is_open[candidates[np.argsort(turn[candidates], kind="stable")[affordable:]]] = False
    return is_open


def _handed_down(known: Known, owner: Array, boxes: Boxes, is_open: Array) -> tuple[Known, Array]:
    """The known directions of open boxes, and the quarter of an open box in which each lies."""
    kept = is_open[owner]
    known, owner = known[kept], owner[kept]
    far = known.t >= 0.5 * (boxes.t0 + boxes.t1)[owner]
    right = known.phi >= 0.5 * (boxes.p0 + boxes.p1)[owner]
    rank = np.cumsum(is_open) - 1
    return known, 4 * rank[owner] + 2 * right + far
