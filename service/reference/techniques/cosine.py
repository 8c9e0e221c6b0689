"""Cosine-weighted hemisphere, p = cos_i / pi (the EON paper, eq. 21)."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3)."""
    return np.maximum(wi[..., 2], 0.0) / np.pi


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density: a disk of radius sqrt(u1), projected up."""
    radius, azimuth = np.sqrt(u1), 2.0 * np.pi * u2
    wi = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), np.sqrt(1.0 - u1)], axis=-1)
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """No direction falls below the horizon."""
    return 0.0
