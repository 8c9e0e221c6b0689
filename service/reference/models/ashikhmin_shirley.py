"""Ashikhmin and Shirley 2000, specular lobe: F p_h / (4 wo.h max(cos_i, cos_o))."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import half_vector, phong, phong_lobe, schlick


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    cos_i, cos_o = wi[..., 2], wo[..., 2]
    above = (cos_i > 0.0) & (cos_o > 0.0)
    h = half_vector(wi, wo)
    lobe = schlick(parameters["f0"], h.to_view) * phong(h, parameters["nu"], parameters["nv"])
    return np.where(above, lobe / np.where(above, 4.0 * h.to_view * np.maximum(cos_i, cos_o), 1.0), 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """The larger cosine changes sides where the elevations are equal."""
    return Kinks(elevations=(float(np.arctan2(wo[2], np.hypot(wo[0], wo[1]))),))


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return (phong_lobe(parameters["nu"], parameters["nv"]),)
