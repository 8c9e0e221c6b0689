"""Kurt et al. 2010, eq. 9: ks F D / (4 wo.h max(cos_i, cos_o))."""

import numpy as np

from service.reference.directions import both_above, equal_elevations, larger_cosine
from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import beckmann, half_vector, schlick


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    above = both_above(wi, wo)
    h = half_vector(wi, wo)
    lobe = parameters["ks"] * schlick(parameters["f0"], h.to_view) * beckmann(h, parameters["mx"], parameters["my"])
    return np.where(above, lobe / np.where(above, 4.0 * h.to_view * larger_cosine(wi, wo), 1.0), 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """The larger cosine changes sides where the elevations are equal."""
    return equal_elevations(wo)


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return ((parameters["mx"], parameters["my"]),)
