"""Ashikhmin and Shirley 2000, specular lobe: F p_h / (4 wo.h max(cos_i, cos_o))."""

import numpy as np

from service.reference.directions import both_above, equal_elevations, larger_cosine
from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import half_vector, phong, phong_lobe, schlick


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    above = both_above(wi, wo)
    h = half_vector(wi, wo)
    lobe = schlick(parameters["f0"], h.to_view) * phong(h, parameters["nu"], parameters["nv"])
    return np.where(above, lobe / np.where(above, 4.0 * h.to_view * larger_cosine(wi, wo), 1.0), 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """The larger cosine changes sides where the elevations are equal."""
    return equal_elevations(wo)


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return (phong_lobe(parameters["nu"], parameters["nv"]),)
