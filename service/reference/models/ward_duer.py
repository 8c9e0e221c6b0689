"""Ward-Duer 2005: ks q / (4 pi mx my cos_i cos_o)."""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import beckmann_exponential, half_vector


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    cos_i, cos_o = wi[..., 2], wo[..., 2]
    above = both_above(wi, wo)
    mx, my = parameters["mx"], parameters["my"]
    q = beckmann_exponential(half_vector(wi, wo), mx, my)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = parameters["ks"] * q / (4.0 * np.pi * mx * my * (cos_i * cos_o))
    return np.where(above, value, 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return ((parameters["mx"], parameters["my"]),)
