"""Rays of the half-vector plane of a pair: a coordinate along them, and the kinks that lie on them.

For zeta in [0, 1] a ray runs half way to the rim, rho growing like sinh from the scale of the narrowest lobe on. Beyond
1 the distance to the rim falls like exp(1 - zeta), since weights and densities are powers of it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from service.reference.entry import Array, half_vector_lobes
from service.reference.half_vector_plane import HalfVectorPlane, plane_of
from service.reference.moments import Pair

INNER_PANEL = 1.4  # in the logarithm of rho
OUTER_ENDS = (2.0, 6.0, 16.0, 36.0, 60.0)  # the last leaves e^-60 of the way to the rim
SCAN = 24  # points of a ray among which a change of sign is looked for
STEPS = 10  # to 1e-9 or better; a kink misplaced by 1e-9 costs the square of that

Surface = Callable[[Array], Array]


@dataclass(frozen=True)
class Rays:
    """Coordinates (zeta, psi) of directions above the horizon, for a pair with half-vector lobes."""

    pair: Pair
    plane: HalfVectorPlane
    scale: float  # rho at which the narrowest lobe begins to fall

    @classmethod
    def of(cls, pair: Pair) -> "Rays":
        """For a pair of which one part at least has half-vector lobes."""
        lobes = [lobe for part in (pair.model, pair.technique) for lobe in half_vector_lobes(part, pair.parameters)]
        plane, narrowest = plane_of(pair.wo, lobes)
        return cls(pair, plane, 0.5 * narrowest)

    def at(self, zeta: Array, psi: Array) -> tuple[Array, Array]:
        """wi, shape (..., 3), and the solid angle per unit of zeta and psi."""
        rim = self.plane.rim(psi)
        half, outer = 0.5 * rim, zeta > 1.0
        stretch = np.arcsinh(half / self.scale)
        inner = np.minimum(zeta, 1.0) * stretch
        beyond = half * np.exp(np.minimum(1.0 - zeta, 0.0))
        rho = np.where(outer, rim - beyond, self.scale * np.sinh(inner))
        gap = np.where(outer, beyond, rim - rho)
        wi, area = self.plane.directions(rho, gap, psi)
        return wi, area * np.where(outer, beyond, self.scale * stretch * np.cosh(inner))

    @cached_property
    def fixed_ends(self) -> Array:
        """Ends of the panels along zeta that all rays share, shape (panels + 1,)."""
        longest = np.arcsinh(0.5 * float(np.max(self.plane.rim(self.plane.turns))) / self.scale)
        count = max(2, int(np.ceil(longest / INNER_PANEL)))
        return np.array([*(k / count for k in range(count + 1)), *(1.0 + end for end in OUTER_ENDS)])

    @cached_property
    def surfaces(self) -> list[Surface]:
        """Functions of wi that change sign where the pair is not smooth, besides certain elevations."""
        wo = self.pair.wo
        found: list[Surface] = []
        for part in (self.pair.model, self.pair.technique):
            kinks = part.kinks(wo, self.pair.parameters)
            found += kinks.surfaces
            if kinks.edge is not None:
                found.append(_side(wo, kinks.edge.normal_x, kinks.edge.normal_z))
        if not half_vector_lobes(self.pair.model, self.pair.parameters):
            found.append(_side(wo, 1.0, 0.0))
        return found

    @cached_property
    def heights(self) -> set[float]:
        """Values of cos_i at which the pair is not smooth."""
        parts = (self.pair.model, self.pair.technique)
        elevations = (e for part in parts for e in part.kinks(self.pair.wo, self.pair.parameters).elevations)
        return {float(np.sin(elevation)) for elevation in elevations}

    @property
    def has_kinks(self) -> bool:
        """Whether panel ends differ from ray to ray."""
        return bool(self.surfaces or self.heights)

    def ends(self, psi: Array) -> Array:
        """Panel ends along zeta at angles psi, shape (..., panels + 1): the fixed ones and, among them, the kinks."""
        fixed = np.broadcast_to(self.fixed_ends, (*psi.shape, len(self.fixed_ends)))
        roots = [self._at_height(height, psi) for height in self.heights]
        roots += [self._roots(surface, psi) for surface in self.surfaces]
        return np.sort(np.concatenate([fixed, *roots], axis=-1), axis=-1)

    def _at_height(self, height: float, psi: Array) -> Array:
        """Where cos_i has a value on every ray, shape (..., 2).

        Where it has not, the nearest place: panels must not jump from ray to ray.
        """
        lean, squared = self.plane.lean(psi), self.plane.stretch(psi)
        cos_o, rim = float(self.plane.wo[2]), self.plane.rim(psi)
        a, b, c = (height + cos_o) * squared, cos_o * lean, height - cos_o
        spread = np.sqrt(np.maximum(b * b - a * c, 0.0))
        rho = np.clip(np.stack([(b - spread) / a, (b + spread) / a], axis=-1), 0.0, rim[..., None])
        half = 0.5 * rim[..., None]
        inner = np.arcsinh(rho / self.scale) / np.arcsinh(half / self.scale)
        outer = 1.0 - np.log(np.maximum((rim[..., None] - rho) / half, 1e-300))
        return np.asarray(np.minimum(np.where(rho < half, inner, outer), self.fixed_ends[-1]))

    def _roots(self, surface: Surface, psi: Array) -> Array:
        """The first and the last change of sign on every ray, shape (..., 2); the nearest place where there is none."""
        grid = np.concatenate([np.linspace(1e-3, 1.0, SCAN), 1.0 + np.geomspace(0.1, OUTER_ENDS[-1], SCAN // 2)])
        value = surface(self.at(grid, psi[..., None])[0])
        sign = value > 0.0
        change = sign[..., 1:] != sign[..., :-1]
        first = np.argmax(change, axis=-1)
        last = change.shape[-1] - 1 - np.argmax(change[..., ::-1], axis=-1)
        index = np.stack([first, last], axis=-1)
        low, high = grid[index], grid[index + 1]
        start = np.take_along_axis(sign, index, axis=-1)
        at_low, at_high = (np.take_along_axis(value, at, axis=-1) for at in (index, index + 1))
        root, before = low, np.zeros_like(start)
        for step in range(STEPS):
            # The false position, the value at an end that stays for a second time halved (Illinois).
            root = np.clip(low + (high - low) * at_low / (at_low - at_high), low, high)
            found = surface(self.at(root, psi[..., None])[0])
            same = (found > 0.0) == start
            again = (same == before) if step else np.zeros_like(same)
            at_low, at_high = (
                np.where(same, found, np.where(again, 0.5 * at_low, at_low)),
                np.where(same, np.where(again, 0.5 * at_high, at_high), found),
            )
            low, high, before = np.where(same, root, low), np.where(same, high, root), same
        return np.asarray(
            np.where(change.any(axis=-1)[..., None], root, grid[np.argmin(np.abs(value), axis=-1)][..., None])
        )


def _side(wo: Array, normal_x: float, normal_z: float) -> Surface:
    """Which side of a plane that holds the horizontal across wo a direction lies on."""
    length = float(np.hypot(wo[0], wo[1]))
    x, y = (wo[0] / length, wo[1] / length) if length > 0.0 else (1.0, 0.0)
    return lambda wi: np.asarray(normal_x * (x * wi[..., 0] + y * wi[..., 1]) + normal_z * wi[..., 2])
