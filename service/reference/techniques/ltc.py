"""Linearly transformed cosine with the fit of the EON paper (listing 2); part of it lies below the horizon."""

from service.reference.entry import Array, Kinks, Parameters
from service.reference.transformed_cosine import Lobe, eon_lobe, lobe_density, lobe_edge, sample_lobe


def _lobe(wo: Array, parameters: Parameters) -> Lobe:
    return eon_lobe(wo, parameters["roughness"])


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), for views `wo` that broadcast; positive below the horizon too."""
    return lobe_density(_lobe(wo, parameters), wo, wi)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    return sample_lobe(_lobe(wo, parameters), wo, u1, u2)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """The edge of the lobe: directions beyond it are never drawn."""
    return Kinks(edge=lobe_edge(_lobe(wo, parameters)))


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Directions below the horizon are drawn and weigh zero."""
    return float(_lobe(wo, parameters).below)
