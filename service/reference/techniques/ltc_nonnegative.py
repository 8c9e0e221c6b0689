"""Linearly transformed cosine with d = 0, so that no direction falls below the horizon (the EON paper, 3.1)."""

from service.reference.entry import Array, Kinks, Parameters
from service.reference.transformed_cosine import Lobe, eon_lobe, lobe_density, sample_lobe


def _lobe(wo: Array, parameters: Parameters) -> Lobe:
    return eon_lobe(wo, parameters["roughness"], shear_z=False)


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), for views `wo` that broadcast."""
    return lobe_density(_lobe(wo, parameters), wo, wi)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    return sample_lobe(_lobe(wo, parameters), wo, u1, u2)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None: with d = 0 the edge of the lobe is the horizon."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """No direction falls below the horizon."""
    return 0.0
