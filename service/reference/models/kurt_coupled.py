"""Kurt et al. 2010, eq. 13: what Fresnel reflectance leaves is diffuse."""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import half_vector, schlick
from service.reference.kurt_lobe import kurt_lobe


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    h = half_vector(wi, wo)
    fresnel = schlick(parameters["f0"], h.to_view)
    above = both_above(wi, wo)
    lobe = kurt_lobe(h, wi, wo, fresnel, parameters["mx"], parameters["my"], parameters["alpha"])
    return np.where(above, parameters["kd"] * (1.0 - fresnel) / np.pi, 0.0) + parameters["ks"] * lobe


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return ((parameters["mx"], parameters["my"]),)
