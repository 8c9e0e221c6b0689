"""What many models ask of two directions: whether both are above the horizon, the larger cosine, equal elevations."""

import numpy as np

from service.reference.entry import Array, Kinks


def both_above(wi: Array, wo: Array) -> Array:
    """Whether both directions are above the horizon, shape (...)."""
    return np.asarray((wi[..., 2] > 0.0) & (wo[..., 2] > 0.0))


def tangential_dot(wi: Array, wo: Array) -> Array:
    """s = wi.wo - cos_i cos_o, without the subtraction: nothing cancels at grazing angles."""
    return np.asarray(wi[..., 0] * wo[..., 0] + wi[..., 1] * wo[..., 1])


def larger_cosine(wi: Array, wo: Array) -> Array:
    """max(cos_i, cos_o); 1 where either direction is not above the horizon."""
    return np.where(both_above(wi, wo), np.maximum(wi[..., 2], wo[..., 2]), 1.0)


def elevation(w: Array) -> float:
    """Angle of one direction above the horizon, radians."""
    return float(np.arctan2(w[2], np.hypot(w[0], w[1])))


def equal_elevations(wo: Array) -> Kinks:
    """The larger of two cosines, or of two polar angles, changes sides where the elevations are equal."""
    return Kinks(elevations=(elevation(wo),))
