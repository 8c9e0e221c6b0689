"""GGX with Smith's masking and shadowing, correlated by height: F D G2 / (4 cos_i cos_o)."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters
from service.reference.ggx import alpha_of, auxiliary, distribution
from service.reference.half_vector import half_vector, schlick


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    alpha, cosines = alpha_of(parameters), wi[..., 2] * wo[..., 2]
    above = (wi[..., 2] > 0.0) & (wo[..., 2] > 0.0)
    h = half_vector(wi, wo)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        seen = 1.0 / (1.0 + auxiliary(wi, alpha) + auxiliary(wo, alpha))  # Heitz 2014, eq. 99
        value = schlick(parameters["f0"], h.to_view) * distribution(h, alpha) * seen / (4.0 * cosines)
    return np.where(above, value, 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return (alpha_of(parameters),)
