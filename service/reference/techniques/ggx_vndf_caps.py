"""The density of visible GGX normals by spherical caps (Dupuy and Benyoub 2023)."""

from service.reference.entry import Array, Parameters
from service.reference.ggx import alpha_of, cap_sample
from service.reference.techniques.ggx_vndf import below_horizon, density, half_vector_lobes, kinks

__all__ = ["below_horizon", "density", "half_vector_lobes", "kinks", "sample"]


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    wi = cap_sample(wo, u1, u2, alpha_of(parameters))
    return wi, density(wo, wi, parameters)
