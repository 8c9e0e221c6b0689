"""The qualitative Oren-Nayar model with the constant 0.57 of its footnote, which stands for interreflection."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters
from service.reference.models.qon import slope
from service.reference.oren_nayar import (
    QUALITATIVE_AVERAGE,
    above,
    equal_elevations,
    larger_cosine,
    qualitative_shape,
    ratio,
    tangential_dot,
)


def amplitude(sigma: float) -> float:
    """A with 0.57 in place of 0.33."""
    return 1.0 - 0.5 * ratio(sigma, 0.57)


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    shape = np.maximum(tangential_dot(wi, wo), 0.0) / larger_cosine(wi, wo)
    value = amplitude(parameters["sigma"]) + slope(parameters["sigma"]) * shape
    return np.where(above(wi, wo), parameters["albedo"] / np.pi * value, 0.0)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine ``mu``: rho (A + B Gq / pi)."""
    sigma = parameters["sigma"]
    return np.asarray(parameters["albedo"] * (amplitude(sigma) + slope(sigma) * qualitative_shape(mu) / np.pi))


def average_albedo(parameters: Parameters) -> float:
    """Albedo averaged over views by their cosine: rho (A + (2/3 - 64/(45 pi)) B) (eq. 9)."""
    sigma = parameters["sigma"]
    return parameters["albedo"] * (amplitude(sigma) + QUALITATIVE_AVERAGE * slope(sigma))


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """Where the elevations are equal."""
    return equal_elevations(wo)
