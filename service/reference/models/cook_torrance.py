"""Cook and Torrance 1982 with the V cavity, Beckmann facets and the factor 1 / (4 cos_i cos_o)."""

import numpy as np

from service.reference.directions import both_above, elevation
from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import beckmann, half_vector, schlick


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    cos_i, cos_o = wi[..., 2], wo[..., 2]
    above = both_above(wi, wo)
    h = half_vector(wi, wo)
    shadowing = np.minimum(1.0, 2.0 * h.cosine * np.minimum(cos_i, cos_o) / np.where(above, h.to_view, 1.0))
    lobe = schlick(parameters["f0"], h.to_view) * beckmann(h, parameters["mx"], parameters["my"]) * shadowing
    return np.where(above, lobe / np.where(above, 4.0 * cos_i * cos_o, 1.0), 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """Where shadowing, or masking, sets in. Where they change places both are below one only at grazing."""

    def shadowed(wi: Array) -> Array:
        h = half_vector(wi, wo)
        return np.asarray(2.0 * h.cosine * wi[..., 2] - h.to_view)

    def masked(wi: Array) -> Array:
        h = half_vector(wi, wo)
        return np.asarray(2.0 * h.cosine * wo[2] - h.to_view)

    return Kinks(elevations=(elevation(wo),), surfaces=(shadowed, masked))


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return ((parameters["mx"], parameters["my"]),)
