"""Lambert's model, f = albedo / pi."""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array, Kinks, Parameters


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    return np.where(both_above(wi, wo), parameters["albedo"] / np.pi, 0.0)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine `mu`: the parameter itself."""
    return np.full(np.shape(mu), parameters["albedo"])


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None: the value is constant."""
    return Kinks()
