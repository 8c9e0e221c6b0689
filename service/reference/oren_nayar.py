"""Parts of the Oren-Nayar family (equations: the EON paper). sigma is in radians."""

import numpy as np

from service.reference.directions import both_above, larger_cosine, tangential_dot
from service.reference.entry import Array

QUALITATIVE_AVERAGE = 2 / 3 - 64 / (45 * np.pi)
"""Gq / pi averaged over views by their cosine."""


def ratio(sigma: float, c: float) -> float:
    """S(c) = sigma^2 / (sigma^2 + c)."""
    return sigma * sigma / (sigma * sigma + c)


def qualitative_shape(mu: Array | float) -> Array:
    """Gq of eq. 8: sin t (t - sin t cos t) + 2/3 tan t (1 - sin^3 t); pi/2 at grazing."""
    mu = np.asarray(mu)
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    theta = np.arctan2(sine, mu)
    return np.asarray(sine * (theta - sine * mu) + 2 / 3 * sine * mu * (1.0 + sine + sine * sine) / (1.0 + sine))


def qualitative_brdf(wi: Array, wo: Array, albedo: float, a: float, b: float) -> Array:
    """rho / pi (A + B max(0, s) / max(cos_i, cos_o)) (eq. 3); 0 where either direction is not above the horizon."""
    shape = np.maximum(tangential_dot(wi, wo), 0.0) / larger_cosine(wi, wo)
    return np.where(both_above(wi, wo), albedo / np.pi * (a + b * shape), 0.0)


def qualitative_albedo(mu: Array | float, albedo: float, a: float, b: float) -> Array:
    """Its albedo for views of cosine `mu`: rho (A + B Gq / pi) (eq. 5)."""
    return np.asarray(albedo * (a + b * qualitative_shape(mu) / np.pi))


def qualitative_average(albedo: float, a: float, b: float) -> float:
    """Its albedo averaged over views by their cosine: rho (A + (2/3 - 64/(45 pi)) B) (eq. 9)."""
    return albedo * (a + QUALITATIVE_AVERAGE * b)
