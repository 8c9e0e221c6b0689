"""Visible GGX normals without most of those that reflect below the horizon (Eto and Tokuyoshi 2023)."""

from service.reference.entry import Array, Parameters
from service.reference.ggx import alpha_of, below_of_visible, cap_sample, spared, visible_density
from service.reference.techniques.ggx_vndf import half_vector_lobes, kinks

__all__ = ["below_horizon", "density", "half_vector_lobes", "kinks", "sample"]


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of ``wi``, shape (..., 3), above the horizon and below."""
    alpha = alpha_of(parameters)
    return visible_density(wo, wi, alpha, spared(wo, alpha))


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    alpha = alpha_of(parameters)
    wi = cap_sample(wo, u1, u2, alpha, spared(wo, alpha))
    return wi, density(wo, wi, parameters)


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    alpha = alpha_of(parameters)
    return below_of_visible(wo, alpha, float(spared(wo, alpha)))
