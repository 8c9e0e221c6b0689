"""Parts of the Oren-Nayar family. sigma is in radians."""

import numpy as np

from service.reference.entry import Array, Kinks

QUALITATIVE_AVERAGE = 2 / 3 - 64 / (45 * np.pi)
"""Gq / pi averaged over views by their cosine."""


def ratio(sigma: float, c: float) -> float:
    """S(c) = sigma^2 / (sigma^2 + c)."""
    return sigma * sigma / (sigma * sigma + c)


def above(wi: Array, wo: Array) -> Array:
    """Whether both directions are above the horizon."""
    return np.asarray((wi[..., 2] > 0.0) & (wo[..., 2] > 0.0))


def tangential_dot(wi: Array, wo: Array) -> Array:
    """s = wi.wo - cos_i cos_o, without the subtraction."""
    return np.asarray(wi[..., 0] * wo[..., 0] + wi[..., 1] * wo[..., 1])


def larger_cosine(wi: Array, wo: Array) -> Array:
    """max(cos_i, cos_o); 1 where either direction is not above the horizon."""
    return np.where(above(wi, wo), np.maximum(wi[..., 2], wo[..., 2]), 1.0)


def qualitative_shape(mu: Array | float) -> Array:
    """Gq of the EON paper's eq. 6: sin t (t - sin t cos t) + 2/3 tan t (1 - sin^3 t); pi/2 at grazing."""
    mu = np.asarray(mu)
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    theta = np.arctan2(sine, mu)
    return np.asarray(sine * (theta - sine * mu) + 2 / 3 * sine * mu * (1.0 + sine + sine * sine) / (1.0 + sine))


def equal_elevations(wo: Array) -> Kinks:
    """The larger of the polar angles changes sides where the elevations are equal."""
    return Kinks(elevations=(float(np.arctan2(wo[2], np.hypot(wo[0], wo[1]))),))
