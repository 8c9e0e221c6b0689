"""The half vectors that put wi above the horizon, as a region of the plane of their slopes.

A narrow lobe is a bump at the origin of that plane, at every view; the hemisphere of wi is the disk of radius
1/cos_o about the point tan(theta_o) in the azimuth of wo. Slopes are divided by the lobe's own (mx, my) and taken in
polar coordinates (rho, psi), which every ray from the origin to the disk's rim crosses once.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from service.reference.entry import Array

TURN_NODES = 24
GRADING = 4.0


@dataclass(frozen=True)
class HalfVectorPlane:
    """Slopes divided by (mx, my), for one view `wo` of shape (3,)."""

    wo: Array
    mx: float
    my: float
    mirrored: bool = False  # whether what is integrated is equal on both sides of the plane of wo

    @property
    def _lean(self) -> tuple[float, float]:
        """Length and angle of wo's tangential part, stretched: the disk leans that way."""
        x, y = self.mx * self.wo[0], self.my * self.wo[1]
        return float(np.hypot(x, y)), float(np.arctan2(y, x))

    def stretch(self, psi: Array) -> Array:
        """Squared slope at rho = 1."""
        return np.asarray((self.mx * np.cos(psi)) ** 2 + (self.my * np.sin(psi)) ** 2)

    def lean(self, psi: Array) -> Array:
        """Slope at rho = 1 along the azimuth of wo, times tan(theta_o)."""
        length, angle = self._lean
        return np.asarray(length / self.wo[2] * np.cos(psi - angle))

    def rim(self, psi: Array) -> Array:
        """rho at which wi reaches the horizon."""
        lean, squared = self.lean(psi), self.stretch(psi)
        root = np.hypot(lean, np.sqrt(squared))
        return np.asarray(np.where(lean > 0.0, (root + np.abs(lean)) / squared, 1.0 / (root + np.abs(lean))))

    def directions(self, rho: Array, gap: Array, psi: Array) -> tuple[Array, Array]:
        """wi, shape (..., 3), and the solid angle per unit of rho and psi. `gap` is rim - rho.

        cos_i comes from the gap, so that it keeps its relative accuracy at the horizon.
        """
        squared, cos_o = self.stretch(psi), self.wo[2]
        x, y = self.mx * rho * np.cos(psi), self.my * rho * np.sin(psi)
        secant2 = 1.0 + squared * rho * rho
        cos_i = cos_o * gap * (squared * rho + 1.0 / (rho + gap)) / secant2
        both = cos_i + cos_o
        wi = np.moveaxis(np.stack([both * x - self.wo[0], both * y - self.wo[1], cos_i]), 0, -1)
        # d wi = 4 (wo.h) d h, with wo.h = (cos_i + cos_o)/(2 cos_h), and d h = cos_h^3 d slope.
        return wi, 2.0 * both / secant2 * self.mx * self.my * rho

    @cached_property
    def turns(self) -> Array:
        """Angles psi at which the region is cut: graded towards where the rim, or the stretch, changes fast.

        They span half a turn from the stretched azimuth of wo where both halves are equal, else a whole turn.
        """
        length, angle = self._lean
        narrow, wide = sorted((self.mx, self.my))
        span = np.pi if self.mirrored else 2.0 * np.pi
        marks = {0.0, span}
        for quarter in (0.5 * np.pi, 1.5 * np.pi):
            width = np.sqrt(self.stretch(np.asarray(angle + quarter))) * self.wo[2] / max(length, 1e-300)
            marks |= _around(quarter, float(width))
        if narrow < wide:
            axis = 0.0 if self.mx < self.my else 0.5 * np.pi
            for quarter in range(-4, 9):
                width = narrow / wide if quarter % 2 == 0 else 1.0
                marks |= _around(axis - angle + 0.5 * np.pi * quarter, width)
        return angle + np.array(sorted(mark for mark in marks if 0.0 <= mark <= span))

    @property
    def copies(self) -> float:
        """How often the part between the ends of `turns` fits into a whole turn."""
        return 2.0 * np.pi / float(self.turns[-1] - self.turns[0])

    def turn_rule(self) -> tuple[Array, Array]:
        """Nodes and weights in psi over the cuts of `turns`; the weights add up to a whole turn."""
        nodes, weights = legendre_rule(TURN_NODES)
        start, width = self.turns[:-1, None], np.diff(self.turns)[:, None]
        return (start + width * nodes).ravel(), (self.copies * width * weights).ravel()


def _around(centre: float, width: float) -> set[float]:
    """The centre, and points on both sides at distances from `width` up to an eighth turn."""
    count = max(0, int(np.ceil(np.log(np.pi / 4 / max(width, 1e-12)) / np.log(GRADING))))
    steps = [width * GRADING**k for k in range(count)]
    return {centre, *(centre + step for step in steps), *(centre - step for step in steps)}


@cache
def legendre_rule(order: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return 0.5 * (nodes + 1.0), 0.5 * weights


def plane_of(wo: Array, lobes: Sequence[tuple[float, float]]) -> tuple[HalfVectorPlane, float]:
    """The plane stretched by the narrowest of the lobes, and rho of the narrowest scale there."""
    mx, my = min(lobes, key=lambda lobe: lobe[0] * lobe[1])
    straight = min(abs(wo[0]), abs(wo[1])) < 1e-15
    mirrored = straight or all(x == y for x, y in lobes)
    return HalfVectorPlane(wo, mx, my, mirrored), min(min(x / mx, y / my) for x, y in lobes)
