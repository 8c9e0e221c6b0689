"""Reflection at a normal of the GGX distribution that the view sees (Heitz 2018)."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters
from service.reference.ggx import alpha_of, below_of_visible, reflect_at_stretched, stretched, visible_density


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of ``wi``, shape (..., 3), above the horizon and below."""
    return visible_density(wo, wi, alpha_of(parameters))


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density: a point of the visible hemisphere's projection (section 4)."""
    alpha = alpha_of(parameters)
    v = stretched(wo, alpha)
    across = np.hypot(v[..., 0], v[..., 1])
    x = np.where(across > 0.0, v[..., 0] / np.where(across > 0.0, across, 1.0), 1.0)
    y = np.where(across > 0.0, v[..., 1] / np.where(across > 0.0, across, 1.0), 0.0)
    first = np.stack([-y, x, np.zeros_like(x)], axis=-1)
    t1, t2 = np.sqrt(u1) * np.cos(2.0 * np.pi * u2), np.sqrt(u1) * np.sin(2.0 * np.pi * u2)
    share = 0.5 * (1.0 + v[..., 2])
    t2 = (1.0 - share) * np.sqrt(np.maximum(1.0 - t1**2, 0.0)) + share * t2
    t3 = np.sqrt(np.maximum(1.0 - t1**2 - t2**2, 0.0))
    n = t1[..., None] * first + t2[..., None] * np.cross(v, first) + t3[..., None] * v
    wi = reflect_at_stretched(wo, n, alpha)
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None above the horizon."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return below_of_visible(wo, alpha_of(parameters))


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return (alpha_of(parameters),)
