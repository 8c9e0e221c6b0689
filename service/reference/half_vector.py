"""Half vectors in float64: distributions, Fresnel, sampling. Kurt et al. 2010 (eq. 4, 5, 12, 16 to 20) for Beckmann's
distribution, Ashikhmin and Shirley 2000 for Phong's.

The slope tan(theta_h) (cos phi_h, sin phi_h) stands for h, since 1 - cos_h^2 cancels for narrow lobes.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from service.reference.entry import Array
from service.reference.half_vector_plane import plane_of

DEEPEST = 700.0
"""-log of the smallest value of a distribution: below it a density is held and not 0, so that it counts as drawn."""


class Half(NamedTuple):
    """The half vector of directions: slope along x and y, tan^2, cos_h and wo.h, each of shape (...)."""

    x: Array
    y: Array
    tan2: Array
    cosine: Array
    to_view: Array


def half_vector(wi: Array, wo: Array) -> Half:
    """Of directions whose sum points up; where it does not, of the opposite sum."""
    height = wi[..., 2] + wo[..., 2]
    divisor = np.where(height == 0.0, 1e-300, height)
    x, y = (wi[..., 0] + wo[..., 0]) / divisor, (wi[..., 1] + wo[..., 1]) / divisor
    tan2 = x * x + y * y
    secant = np.sqrt(1.0 + tan2)
    return Half(x, y, tan2, 1.0 / secant, 0.5 * np.abs(height) * secant)


def schlick(f0: float, to_view: Array) -> Array:
    """Fresnel reflectance (eq. 12)."""
    return np.asarray(f0 + (1.0 - f0) * np.maximum(1.0 - to_view, 0.0) ** 5)


def beckmann_exponential(h: Half, mx: float, my: float) -> Array:
    """Q of eq. 4."""
    return np.asarray(np.exp(-np.minimum((h.x / mx) ** 2 + (h.y / my) ** 2, DEEPEST)))


def beckmann(h: Half, mx: float, my: float) -> Array:
    """D of eq. 5."""
    return np.asarray(beckmann_exponential(h, mx, my) * (1.0 + h.tan2) ** 2 / (np.pi * mx * my))


def phong_power(h: Half, nu: float, nv: float) -> Array:
    """cos_h to the exponent of h's azimuth."""
    at_zero = h.tan2 == 0.0
    exponent = np.where(at_zero, 0.0, (nu * h.x**2 + nv * h.y**2) / np.where(at_zero, 1.0, h.tan2))
    return np.asarray(np.exp(-np.minimum(0.5 * exponent * np.log1p(h.tan2), DEEPEST)))


def phong(h: Half, nu: float, nv: float) -> Array:
    """Density of h in 1/sr."""
    return np.asarray(np.sqrt((nu + 1.0) * (nv + 1.0)) / (2.0 * np.pi) * phong_power(h, nu, nv))


def reflected_density(density: Array, h: Half) -> Array:
    """Density of wi from that of h; 0 at wi = -wo, which has no half vector."""
    seen = h.to_view > 0.0
    return np.where(seen, density / (4.0 * np.where(seen, h.to_view, 1.0)), 0.0)


def reflect(wo: Array, x: Array, y: Array) -> Array:
    """Mirror images of `wo` about half vectors of these slopes, shape (..., 3)."""
    h = np.stack([x, y, np.ones_like(x)], axis=-1) / np.sqrt(1.0 + x * x + y * y)[..., None]
    return np.asarray(2.0 * np.sum(wo * h, axis=-1)[..., None] * h - wo)


def beckmann_slope(u1: Array, u2: Array, mx: float, my: float) -> tuple[Array, Array]:
    """Slopes with density D cos_h (eq. 16, 17), by the angles of the printed form with its quadrant put right."""
    phi = np.arctan2(my * np.sin(2.0 * np.pi * u2), mx * np.cos(2.0 * np.pi * u2))
    tan = np.sqrt(-np.log1p(-u1) / ((np.cos(phi) / mx) ** 2 + (np.sin(phi) / my) ** 2))
    return tan * np.cos(phi), tan * np.sin(phi)


def phong_slope(u1: Array, u2: Array, nu: float, nv: float) -> tuple[Array, Array]:
    """Slopes whose half vectors have the density `phong`."""
    phi = np.arctan2(np.sqrt(nu + 1.0) * np.sin(2.0 * np.pi * u2), np.sqrt(nv + 1.0) * np.cos(2.0 * np.pi * u2))
    exponent = nu * np.cos(phi) ** 2 + nv * np.sin(phi) ** 2
    tan = np.sqrt(np.expm1(-2.0 * np.log1p(-u1) / (1.0 + exponent)))
    return tan * np.cos(phi), tan * np.sin(phi)


def phong_lobe(nu: float, nv: float) -> tuple[float, float]:
    """Slopes along x and y at which a Phong lobe has fallen to about 1/e."""
    return float(np.sqrt(2.0 / (nu + 1.0))), float(np.sqrt(2.0 / (nv + 1.0)))


def mass_beyond_rim(wo: Array, lobe: tuple[float, float], survival: Callable[[Array, Array], Array]) -> float:
    """Probability that a half vector gives a direction below the horizon.

    `survival(rho, psi)` is the probability that a half vector drawn at angle psi of the plane stretched by `lobe`
    lies beyond rho; psi itself is uniform.
    """
    plane, _ = plane_of(wo, [lobe])
    psi, weights = plane.turn_rule()
    return float(np.sum(weights * survival(plane.rim(psi), psi)) / (2.0 * np.pi))


def beckmann_below(wo: Array, mx: float, my: float) -> float:
    """Probability that reflection at a Beckmann half vector goes below the horizon."""
    return mass_beyond_rim(wo, (mx, my), lambda rho, psi: np.exp(-rho * rho))


def phong_below(wo: Array, nu: float, nv: float) -> float:
    """The same for a Phong half vector: beyond a slope, (1 + slope^2)^(-(e + 1)/2) of those at its azimuth."""
    mx, my = phong_lobe(nu, nv)

    def survival(rho: Array, psi: Array) -> Array:
        x2, y2 = (mx * np.cos(psi)) ** 2, (my * np.sin(psi)) ** 2
        exponent = (nu * x2 + nv * y2) / (x2 + y2)
        return np.asarray(np.exp(-0.5 * (exponent + 1.0) * np.log1p(rho * rho * (x2 + y2))))

    return mass_beyond_rim(wo, (mx, my), survival)
