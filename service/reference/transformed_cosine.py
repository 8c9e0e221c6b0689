"""The linearly transformed cosine lobe fitted to EON (the EON paper, eq. 22 to 28, listings 2 and 3).

The matrix is M = [a 0 b; 0 c 0; d 0 1], in the frame whose x axis is the azimuth of wo.
"""

from dataclasses import dataclass

import numpy as np

from service.reference.entry import Array, Edge

FLAT = 1e-32  # shear below which the edge is the horizon: it would give tails of a strength below 1e-64


@dataclass(frozen=True)
class Lobe:
    """Matrix of the lobe, one for each view (shape (...)), and whether its part below the horizon is cut away."""

    a: Array
    b: Array
    c: Array
    d: Array
    clipped: bool

    @property
    def stretch(self) -> Array:
        """a - b d; the determinant of M is c (a - b d)."""
        return self.a - self.b * self.d

    @property
    def above(self) -> Array:
        """Part of the cosine hemisphere that maps above the horizon: half disk and half ellipse (eq. 28)."""
        return np.asarray(0.5 + 0.5 / np.hypot(1.0, self.d))

    @property
    def below(self) -> Array:
        """1 - above, without the subtraction."""
        root = np.hypot(1.0, self.d)
        return np.asarray(0.5 * self.d**2 / (root * (1.0 + root)))


def eon_lobe(wo: Array, roughness: float, *, shear_z: bool = True, clipped: bool = False) -> Lobe:
    """Lobe of listing 2 for views `wo`, shape (..., 3); `shear_z` False sets d = 0.

    Numerator and denominator of d are written in e = 1 - mu: as printed both nearly cancel at normal incidence. The
    sign of d changes at 0.7755 degrees: d is positive for steeper views.
    """
    mu, r = wo[..., 2], roughness
    e = (wo[..., 0] ** 2 + wo[..., 1] ** 2) / (1.0 + mu)
    a = 1.0 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r)
    b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu**3 - 1.43545)
    c = 1.0 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r
    d = r * (-6e-6 + (0.065466 + 0.475392 * e) * e) / (-0.0017372 + (-2.0725628 + e) * e)
    return Lobe(np.asarray(a), np.asarray(b), np.asarray(c), np.asarray(d) if shear_z else np.zeros_like(d), clipped)


def _tangent(wo: Array) -> tuple[Array, Array]:
    """Azimuth of wo as a unit vector, component by component; x where wo is the normal."""
    length = np.hypot(wo[..., 0], wo[..., 1])
    divisor = np.where(length > 0.0, length, 1.0)
    return np.where(length > 0.0, wo[..., 0] / divisor, 1.0), wo[..., 1] / divisor


def lobe_density(lobe: Lobe, wo: Array, wi: Array) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3): eq. 23, with the adjugate of M in place of its inverse."""
    x_axis, y_axis = _tangent(wo)
    x, z = x_axis * wi[..., 0] + y_axis * wi[..., 1], wi[..., 2]
    y = x_axis * wi[..., 1] - y_axis * wi[..., 0]
    back_z = lobe.c * (lobe.a * z - lobe.d * x)
    squared = (lobe.c * (x - lobe.b * z)) ** 2 + (lobe.stretch * y) ** 2 + back_z**2
    value = (lobe.c * lobe.stretch / squared) ** 2 * np.maximum(back_z, 0.0) / np.pi
    return np.where(z > 0.0, value / lobe.above, 0.0) if lobe.clipped else value


def transform(lobe: Lobe, wo: Array, untransformed: Array) -> Array:
    """Unit directions M wh / |M wh| in the frame of the surface, shape (..., 3) (eq. 22)."""
    x, y, z = (untransformed[..., k] for k in range(3))
    u, v, w = lobe.a * x + lobe.b * z, lobe.c * y, lobe.d * x + z
    length = np.sqrt(u * u + v * v + w * w)
    x_axis, y_axis = _tangent(wo)
    return np.stack([x_axis * u - y_axis * v, y_axis * u + x_axis * v, w], axis=-1) / length[..., None]


def sample_lobe(lobe: Lobe, wo: Array, u1: Array, u2: Array) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density; a clipped lobe squeezes the disk as in listing 3.

    The listing assumes d < 0; for d > 0 it is the other side of the disk that maps below the horizon.
    """
    radius, azimuth = np.sqrt(u1), 2.0 * np.pi * u2
    x, y = radius * np.cos(azimuth), radius * np.sin(azimuth)
    if lobe.clipped:
        half_width = np.sqrt(np.maximum(1.0 - y * y, 0.0))
        x = half_width * lobe.below + x * lobe.above
        x = np.where(lobe.d > 0.0, x, -x)
    wi = transform(lobe, wo, np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1))
    return wi, lobe_density(lobe, wo, wi)


def lobe_edge(lobe: Lobe, floor: float = 0.0) -> Edge | None:
    """Edge of the lobe for one view, the image of the untransformed horizon; None where the two are as good as one."""
    if abs(lobe.d) < FLAT:
        return None
    normal = np.hypot(lobe.a, lobe.d)
    scale = (lobe.c * lobe.stretch) ** 2 * lobe.c * normal / np.pi / (lobe.above if lobe.clipped else 1.0)

    def slope(wi: Array) -> Array:
        x, y, z = (wi[..., k] for k in range(3))
        squared = (lobe.c * (x - lobe.b * z)) ** 2 + (lobe.stretch * y) ** 2 + (lobe.c * (lobe.a * z - lobe.d * x)) ** 2
        return np.asarray(scale / squared**2)

    return Edge(float(-lobe.d / normal), float(lobe.a / normal), floor, slope)
