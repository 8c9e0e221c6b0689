"""Half of the hemisphere cut into patches on which an integrand is smooth.

Coordinates are elevation above the horizon and azimuth from wo in [0, pi]; the other half mirrors it. Elevation
panels grow by a fixed ratio from the horizon, because weights vary like 1/cos_i there, and break at every kink. Where
the density has an edge (a great circle), the azimuth panels below its top follow it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from service.reference.entry import Array, Edge, Kinks

QUARTER = np.pi / 2
RATIO = 4.0  # a pole at the horizon is then 1.67 half-lengths from a panel's middle: Gauss error 3^(-2n)
FINEST = 1e-32  # below this elevation nothing is graded: what lies there is far below one rounding

Bound = tuple[float, float]  # base and follow of an azimuth bound, see Partition


@dataclass(frozen=True)
class Partition:
    """Patches of the half with azimuths in [0, pi].

    `patches` has shape (7, P, 1, 1): low and high end in elevation; 1 where the high end is the edge's top, whose
    azimuth starts there like a square root, else 0; base and follow of the low azimuth bound; the same of the high one.
    A bound lies at base + follow (azimuth of the edge - base).
    """

    patches: Array
    edge_ratio: float  # cos(azimuth of the edge) = edge_ratio tan(elevation)
    edge_top: float  # elevation below which there is an edge

    @property
    def lowest_panel(self) -> float:
        """Upper end of the panel at the horizon, radians."""
        return float(np.min(self.patches[1]))

    def select(self, indices: NDArray[np.intp]) -> "Partition":
        """The patches of the given indices, shape (Q,)."""
        return replace(self, patches=self.patches[:, indices])

    def angles(self, t: Array, u: Array) -> tuple[Array, Array, Array]:
        """Elevation (P, m, 1), azimuth (P, m, k) and Jacobian of both for t (., m, 1) and u (., 1, k) in [0, 1]."""
        bottom, top, rooted, low, follow_low, high, follow_high = self.patches
        span = top - bottom
        elevation = np.where(rooted > 0.0, top - span * t * t, bottom + span * t)
        stretch = np.where(rooted > 0.0, 2.0 * t, 1.0) * span
        edge = np.arccos(np.clip(self.edge_ratio * np.tan(np.minimum(elevation, self.edge_top)), -1.0, 1.0))
        start = low + follow_low * (edge - low)
        width = high + follow_high * (edge - high) - start
        return elevation, start + width * u, stretch * width


def partition_hemisphere(kinks: Iterable[Kinks], smoothing: float) -> Partition:
    """Patches for the kinks of a model and a technique.

    `smoothing` (radians) is the distance behind the edge at which the density, continued, would reach zero.
    """
    kinks = tuple(kinks)
    edge = next((k.edge for k in kinks if k.edge is not None), None)
    top = float(np.arctan2(abs(edge.normal_x), edge.normal_z)) if edge is not None else 0.0
    marks = {0.0, QUARTER, top, *(e for k in kinks for e in k.elevations)}
    if 0.0 < smoothing < top:
        marks |= {top + step for step in _powers(3.0 * smoothing, QUARTER - top)}
    ends = _graded(sorted(m for m in marks if 0.0 <= m <= QUARTER))
    rows: list[tuple[float, ...]] = []
    for low, high in pairwise(ends):
        bounds = _edge_bounds(edge, smoothing) if edge is not None and high <= top else _plain_bounds()
        rooted = float(high == top)
        rows += [(low, high, rooted, *a, *b) for a, b in pairwise(bounds)]
    ratio = -edge.normal_z / edge.normal_x if edge is not None else 0.0
    return Partition(np.array(rows).T[..., None, None], ratio, top)


def _powers(first: float, last: float) -> list[float]:
    count = int(np.ceil(np.log(last / first) / np.log(RATIO))) if last > first > 0.0 else 0
    return [first * RATIO**k for k in range(count)]


def _graded(marks: list[float]) -> list[float]:
    """Marks with more between them, so that neighbours above the lowest differ by no more than RATIO."""
    ends = marks[:2]
    for high in marks[2:]:
        low = ends[-1]
        if low < FINEST < high:
            ends.append(FINEST)
            low = FINEST
        count = int(np.ceil(np.log(high / low) / np.log(RATIO)))
        ends += [low * (high / low) ** (k / count) for k in range(1, count)]
        ends.append(high)
    return ends


def _plain_bounds() -> list[Bound]:
    return [(0.0, 0.0), (QUARTER, 0.0), (np.pi, 0.0)]


def _edge_bounds(edge: Edge, smoothing: float) -> list[Bound]:
    """Azimuth bounds below the top of the edge, finer towards it on the side of the lobe.

    At the horizon the edge stands a quarter turn from wo, so the quarter beyond feels it as well.
    """
    steps = _powers(3.0 * smoothing / abs(edge.normal_x), QUARTER)
    fixed = [(QUARTER - step, 0.0) for step in reversed(steps)]
    moving = [(QUARTER, 1.0 - step / QUARTER) for step in reversed(steps)]
    bounds = [(0.0, 0.0), *fixed, (QUARTER, 0.0), *moving, (QUARTER, 1.0), (np.pi, 0.0)]
    return bounds if edge.normal_x > 0.0 else [(np.pi - base, follow) for base, follow in reversed(bounds)]
