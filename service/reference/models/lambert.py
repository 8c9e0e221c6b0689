"""Lambert's model, f = albedo / pi."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    above = (wi[..., 2] > 0.0) & (wo[..., 2] > 0.0)
    return np.where(above, parameters.get("albedo", 1.0) / np.pi, 0.0)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine ``mu``: the parameter itself."""
    return np.full(np.shape(mu), parameters.get("albedo", 1.0))


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None: the value is constant."""
    return Kinks()
