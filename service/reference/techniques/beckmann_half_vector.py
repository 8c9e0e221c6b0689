"""Reflection at a half vector drawn from the Beckmann distribution (Kurt et al. 2010, eq. 16 to 20)."""

from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import (
    beckmann,
    beckmann_below,
    beckmann_slope,
    half_vector,
    reflect,
    reflected_density,
)


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), above the horizon and below."""
    h = half_vector(wi, wo)
    return reflected_density(beckmann(h, parameters["mx"], parameters["my"]) * h.cosine, h)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    wi = reflect(wo, *beckmann_slope(u1, u2, parameters["mx"], parameters["my"]))
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return beckmann_below(wo, parameters["mx"], parameters["my"])


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return ((parameters["mx"], parameters["my"]),)
