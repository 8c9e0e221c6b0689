"""Blinn-Phong with the exact normalization ks (n + 2)(n + 4) / (8 pi (2^(-n/2) + n))."""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import half_vector, phong_lobe, phong_power


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    n = parameters["n"]
    above = both_above(wi, wo)
    scale = parameters["ks"] * (n + 2.0) * (n + 4.0) / (8.0 * np.pi * (2.0 ** (-n / 2.0) + n))
    return np.where(above, scale * phong_power(half_vector(wi, wo), n, n), 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Its one lobe."""
    return (phong_lobe(parameters["n"], parameters["n"]),)
