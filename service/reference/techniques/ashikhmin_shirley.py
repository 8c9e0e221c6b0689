"""Reflection at a half vector of the anisotropic Phong distribution (Ashikhmin and Shirley 2000)."""

from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import (
    half_vector,
    phong,
    phong_below,
    phong_lobe,
    phong_slope,
    reflect,
    reflected_density,
)


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), above the horizon and below."""
    h = half_vector(wi, wo)
    return reflected_density(phong(h, parameters["nu"], parameters["nv"]), h)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    wi = reflect(wo, *phong_slope(u1, u2, parameters["nu"], parameters["nv"]))
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return phong_below(wo, parameters["nu"], parameters["nv"])


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return (phong_lobe(parameters["nu"], parameters["nv"]),)
