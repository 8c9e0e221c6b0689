"""Adaptive quadrature over the sphere, in boxes of equal-area coordinates.

A direction is (t, phi): t = 1 - z in [0, 2] and the azimuth in [0, 2 pi); area on the sphere is dt dphi (Archimedes).
The
horizon is t = 1. Directions are formed from t without cancellation, so that lobes of any width about the normal
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
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1.0 - t], axis=-1)


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


def _integrate_once(boxes: Boxes, integrands: Integrands, order: int) -> Array:
    """Integrals over each box by one tensor Gauss-Legendre rule, shape (k, n)."""
    a, b, w = _rule(order)
    height, width = boxes.t1 - boxes.t0, boxes.p1 - boxes.p0
    t = boxes.t0[:, None] + height[:, None] * a
    phi = boxes.p0[:, None] + width[:, None] * b
    values = integrands(directions(t.ravel(), phi.ravel()), np.repeat(boxes.cell, len(w)))
    return np.asarray(values.reshape(len(values), len(boxes), len(w)) @ w * (height * width))


def _add_at(sums: Array, columns: Array, values: Array) -> None:
    """Add values (k, n) to the columns of sums (k, m), which may occur more than once."""
    for row, added in zip(sums, values, strict=True):
        row += np.bincount(columns, added, minlength=len(row))


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


def integrate(
    boxes: Boxes, integrands: Integrands, shape: tuple[int, int], goal: float, points: int, order: int = 5
) -> Integrals:
    """Integrate over all bins, splitting boxes into quarters until two levels agree.

    shape: (cells, bins). goal: difference of two levels, as a share of the cell's total, at which a box is done.
    points:
    evaluations to spend at the most; what is left open then counts in the error.
    """
    values = _integrate_once(boxes, integrands, order)
    cells, bins = shape
    by_bin = np.zeros((len(values), cells * bins))
    error = np.zeros((len(values), cells * bins))
    spent, scale = 0, None
    while len(boxes):
        children = boxes.quarters()
        spent += len(children) * order * order
        fine = _integrate_once(children, integrands, order)
        summed = fine.reshape(len(fine), len(boxes), 4).sum(axis=-1)
        difference = np.abs(summed - values)
        if scale is None:
            scale = np.zeros((len(values), cells))
            _add_at(scale, boxes.cell, np.abs(summed))
            scale = np.maximum(scale, 1e-300)
        excess = (difference / (goal * scale[:, boxes.cell])).max(axis=0)
        is_open = excess > 1.0
        affordable = max(0, points - spent) // (16 * order * order)
        if is_open.sum() > affordable:
            is_open[np.argsort(-excess)[affordable:]] = False
        done = ~is_open
        flat = boxes.cell * bins + boxes.bin
        _add_at(by_bin, flat[done], summed[:, done])
        _add_at(error, flat[done], difference[:, done])
        kept = np.repeat(is_open, 4)
        boxes, values = children[kept], fine[:, kept]
    return Integrals(*(sums.reshape(len(sums), cells, bins) for sums in (by_bin, error)))
