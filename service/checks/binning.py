"""Bins of directions that follow the directions themselves, and the chi-square test over them.

Boxes are split at the median of a pilot sample, alternately by elevation and by azimuth, so that a lobe of any width
gets bins of equal weight without anyone telling where it is.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.checks.sphere_quadrature import TURN, Boxes

Array = NDArray[Any]
EXPECTED_AT_LEAST = 20.0
"""Bins with fewer expected hits are pooled; above it the statistic follows its limit out to probabilities of 1e-7."""

CERTAIN = 0.5
"""A bin takes part where its expectation is known within so many standard deviations of its hits."""


@dataclass(frozen=True)
class Tree:
    """The leaves of one cell.

    boxes: (leaves, 4) as t0, t1, p0, p1. extents: of the directions in each, likewise. hits: of the counted sample,
    (leaves,). leaf: number of each sample's leaf.
    """

    boxes: Array
    extents: Array
    hits: Array
    leaf: Array


def partition(t: Array, phi: Array, pilot: int, depth: int) -> Tree:
    """Split by the first `pilot` directions, count the others. The horizon is always a border."""
    boxes: list[tuple[float, float, float, float]] = []
    extents: list[tuple[float, float, float, float]] = []
    hits: list[int] = []
    leaf = np.full(len(t), -1, np.int64)

    def split(rows: Array, box: tuple[float, float, float, float], level: int) -> None:
        first = rows[rows < pilot]
        t0, t1, p0, p1 = box
        by_t = level % 2 == 0
        low, high = (t0, t1) if by_t else (p0, p1)
        middle = _median((t if by_t else phi)[first]) if len(first) >= 8 else low
        if level >= depth or len(first) < 8 or not low < middle < high:
            leaf[rows] = len(boxes)
            boxes.append(box)
            held = len(rows) > 1
            extents.append((*_extent(t[rows]), *_extent(phi[rows])) if held else box)
            hits.append(int(np.count_nonzero(rows >= pilot)))
            return
        below = (t if by_t else phi)[rows] < middle
        lower, upper = (
            ((t0, middle, p0, p1), (middle, t1, p0, p1)) if by_t else ((t0, t1, p0, middle), (t0, t1, middle, p1))
        )
        split(rows[below], lower, level + 1)
        split(rows[~below], upper, level + 1)

    above = t <= 1.0
    split(np.flatnonzero(above), (0.0, 1.0, 0.0, TURN), 0)
    split(np.flatnonzero(~above), (1.0, 2.0, 0.0, TURN), 0)
    return Tree(np.array(boxes), np.array(extents), np.array(hits, float), leaf)


def _median(values: Array) -> float:
    """As np.median, whose care for NaN costs more than the rest here."""
    k = len(values) // 2
    low, high = np.partition(values, (k - 1, k))[k - 1 : k + 1]
    return float(high if len(values) % 2 else 0.5 * (low + high))


def _extent(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def boxes_of(trees: list[Tree]) -> Boxes:
    """The leaves of all cells in boxes for quadrature; the bin is the leaf's number.

    A leaf at the rim of a narrow lobe is large, and its density lies in a corner. So it is cut at the extent of the
    directions in it, and from there in pieces that double in size up to its border.
    """
    columns: list[tuple[float, float, float, float, int, int]] = []
    for cell, tree in enumerate(trees):
        for number, (box, extent) in enumerate(zip(tree.boxes.tolist(), tree.extents.tolist(), strict=True)):
            heights = _graded(box[0], extent[0], extent[1], box[1])
            widths = _graded(box[2], extent[2], extent[3], box[3])
            columns += [
                (t0, t1, p0, p1, cell, number)
                for t0, t1 in itertools.pairwise(heights)
                for p0, p1 in itertools.pairwise(widths)
            ]
    t0, t1, p0, p1, cells, numbers = np.array(columns).T
    return Boxes(t0, t1, p0, p1, cells.astype(np.int64), numbers.astype(np.int64))


def _graded(low: float, first: float, last: float, high: float) -> list[float]:
    """Borders from low to high: first and last, and steps that double from there outwards."""
    step = max(last - first, 1e-9 * (high - low))
    # Slivers are not worth a box: the extent ends at the border then.
    first = low if first - low < 0.5 * step else first
    last = high if high - last < 0.5 * step else last
    below, above = [first], [last]
    while below[-1] > low:
        below.append(max(low, first - step * (2.0 ** len(below) - 1.0)))
        if below[-1] - low < 0.5 * step:
            below[-1] = low
    while above[-1] < high:
        above.append(min(high, last + step * (2.0 ** len(above) - 1.0)))
        if high - above[-1] < 0.5 * step:
            above[-1] = high
    borders = [*reversed(below), *above]
    return list(dict.fromkeys(borders))


@dataclass(frozen=True)
class ChiSquare:
    """Pearson's statistic over pooled bins, its degrees of freedom, and the probability of a larger one.

    left_out: the share of all counts in bins that took no part.
    """

    statistic: float
    freedom: int
    probability: float
    left_out: float


def chi_square(observed: Array, expected: Array, uncertainty: Array) -> ChiSquare:
    """Test counts against expectations known to an uncertainty, all (bins,); nothing is fitted.

    A bin whose expectation is not certain takes no part, and the power is lost: its count would tell of the quadrature.
    Of the others, a difference within the uncertainty counts as none. Bins with a low expectation are pooled, in the
    order of their expectations. The statistic of some bins alone stays below chi-square with as many degrees of freedom
    as there are bins (the covariance of hits over expectations has no eigenvalue above 1), with one less for all bins.
    """
    expected = np.maximum(expected, 0.0)
    certain = is_certain(expected, uncertainty)
    left_out = 1.0 - float(observed[certain].sum()) / max(float(observed.sum()), 1.0)
    e, o, s = _pooled(expected[certain], observed[certain], uncertainty[certain])
    freedom = len(e) - int(certain.all())
    if len(e) < 2:
        return ChiSquare(0.0, 0, 1.0, left_out)
    statistic = float(np.sum(np.maximum(np.abs(o - e) - s, 0.0) ** 2 / np.maximum(e, 1e-300)))
    return ChiSquare(statistic, freedom, upper_tail(statistic, freedom), left_out)


def is_certain(expected: Array, uncertainty: Array) -> Array:
    """Which bins take part, (bins,)."""
    return np.asarray(uncertainty <= CERTAIN * np.sqrt(np.maximum(expected, 1.0)))


def _pooled(expected: Array, *others: Array) -> list[Array]:
    """All columns (bins,) summed over pools whose expectations reach EXPECTED_AT_LEAST; large bins stay alone."""
    order = np.argsort(expected)
    sums = np.cumsum(expected[order])
    # Pools close where the running sum passes the next multiple of the least expectation.
    large = expected[order] >= EXPECTED_AT_LEAST
    pool = np.floor(sums / EXPECTED_AT_LEAST).astype(np.int64)
    small_pools = int(pool[~large][-1]) if (~large).any() else 0
    group = np.where(large, 0, np.minimum(pool, max(small_pools - 1, 0)))
    group[large] = np.arange(int(large.sum())) + (max(small_pools, 1) if (~large).any() else 0)
    columns = [np.bincount(group, column[order]) for column in (expected, *others)]
    if len(columns[0]) > 1 and columns[0][0] < EXPECTED_AT_LEAST:
        # What is left of all small bins joins the smallest large one.
        columns = [np.concatenate([[column[0] + column[1]], column[2:]]) for column in columns]
    return columns


def upper_tail(statistic: float, freedom: int) -> float:
    """Probability that chi-square with `freedom` degrees exceeds the statistic: the regularised incomplete gamma Q.

    Series below the mean, Lentz's continued fraction above (Abramowitz and Stegun, 6.5.29 and 6.5.31).
    """
    a, x = 0.5 * freedom, 0.5 * statistic
    if x <= 0.0:
        return 1.0
    front = math.exp(max(-745.0, a * math.log(x) - x - math.lgamma(a)))
    if x < a + 1.0:
        term = total = 1.0 / a
        n = a
        while term > total * 1e-16:
            n += 1.0
            term *= x / n
            total += term
        return max(0.0, 1.0 - front * total)
    b = x + 1.0 - a
    c, d = 1e300, 1.0 / b
    h = d
    for i in range(1, 10_000):
        an = -i * (i - a)
        b += 2.0
        d = 1.0 / (an * d + b)
        c = b + an / c
        h *= d * c
        if abs(d * c - 1.0) < 1e-15:
            break
    return front * h
