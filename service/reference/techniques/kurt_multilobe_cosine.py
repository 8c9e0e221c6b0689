"""One-sample mixture of two Beckmann half vectors (`lobe_probability`) and of cosine sampling."""

from service.reference import cosine_mixture
from service.reference.entry import Array, Kinks, Parameters
from service.reference.techniques import kurt_multilobe as lobe
from service.reference.techniques.kurt_multilobe import half_vector_lobes

__all__ = ["below_horizon", "density", "half_vector_lobes", "kinks", "sample"]


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), above the horizon and below."""
    return cosine_mixture.density(lobe, wo, wi, parameters)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    return cosine_mixture.sample(lobe, wo, u1, u2, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return cosine_mixture.below_horizon(lobe, wo, parameters)
