"""Uniform hemisphere, p = 1 / (2 pi), with cos_i = u1.

The paper's listing 4 takes u1 as the radius on the disk, which does not give this density; here the cosine is u1.
"""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3)."""
    return np.where(wi[..., 2] >= 0.0, 1.0 / (2.0 * np.pi), 0.0)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    sine, azimuth = np.sqrt((1.0 - u1) * (1.0 + u1)), 2.0 * np.pi * u2
    wi = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.broadcast_to(u1, sine.shape)], axis=-1)
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """No direction falls below the horizon."""
    return 0.0
