"""The variant of a GLSL tutorial, with the difference of the polar angles where that of the azimuths belongs."""

import numpy as np

from service.reference.directions import both_above, equal_elevations, larger_cosine
from service.reference.entry import Array, Kinks, Parameters
from service.reference.models.qon import slope
from service.reference.models.qon_footnote import amplitude


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    cos_i, cos_o = wi[..., 2], wo[..., 2]
    sin_i, sin_o = np.hypot(wi[..., 0], wi[..., 1]), np.hypot(wo[..., 0], wo[..., 1])
    shape = np.maximum(cos_i * cos_o + sin_i * sin_o, 0.0) * sin_i * sin_o / larger_cosine(wi, wo)
    value = amplitude(parameters["sigma"]) + slope(parameters["sigma"]) * shape
    return np.where(both_above(wi, wo), parameters["albedo"] / np.pi * value, 0.0)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine `mu`, integrated over polar angles of wi below and above that of wo."""
    cos, sigma = np.asarray(mu), parameters["sigma"]
    sin = np.sqrt((1.0 - cos) * (1.0 + cos))
    theta = np.arctan2(sin, cos)
    below = sin * (cos * sin**3 / 3 + sin * (2 / 3 - cos + cos**3 / 3))
    beyond = sin * (np.pi / 16 - theta / 8 + np.sin(4 * theta) / 32) + sin**2 * cos * (1 + sin**2) / 4
    return np.asarray(parameters["albedo"] * (amplitude(sigma) + 2 * slope(sigma) * (below + beyond)))


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """Where the elevations are equal."""
    return equal_elevations(wo)
