"""Reflection at a half vector drawn from the GGX distribution (Walter et al. 2007, eq. 35, 36)."""

from service.reference.entry import Array, Kinks, Parameters
from service.reference.ggx import alpha_of, below_of_half_vectors, distribution, slope
from service.reference.half_vector import half_vector, reflect, reflected_density


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of ``wi``, shape (..., 3), above the horizon and below."""
    h = half_vector(wi, wo)
    return reflected_density(distribution(h, alpha_of(parameters)) * h.cosine, h)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    wi = reflect(wo, *slope(u1, u2, alpha_of(parameters)))
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return below_of_half_vectors(wo, alpha_of(parameters))


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return (alpha_of(parameters),)
