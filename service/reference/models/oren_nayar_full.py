"""The full model of Oren and Nayar 1994: three direct terms and interreflection, in polar angles."""

import numpy as np

from service.reference.directions import both_above, equal_elevations
from service.reference.entry import Array, Kinks, Parameters
from service.reference.oren_nayar import ratio


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    sigma, albedo = parameters["sigma"], parameters["albedo"]
    theta_i, theta_o = (np.arctan2(np.hypot(w[..., 0], w[..., 1]), w[..., 2]) for w in (wi, wo))
    a, b = np.maximum(theta_i, theta_o), np.minimum(theta_i, theta_o)
    cos_phi = np.cos(np.arctan2(wi[..., 1], wi[..., 0]) - np.arctan2(wo[..., 1], wo[..., 0]))
    shadow = np.where(cos_phi < 0.0, (2.0 * b / np.pi) ** 3, 0.0)
    c1 = 1.0 - 0.5 * ratio(sigma, 0.33)
    c2 = 0.45 * ratio(sigma, 0.09) * (np.sin(a) - shadow)
    c3 = 0.125 * ratio(sigma, 0.09) * (4.0 * a * b / np.pi**2) ** 2
    direct = c1 + cos_phi * c2 * np.tan(b) + (1.0 - np.abs(cos_phi)) * c3 * np.tan(0.5 * (a + b))
    again = 0.17 * albedo * ratio(sigma, 0.13) * (1.0 - cos_phi * (2.0 * b / np.pi) ** 2)
    return np.where(both_above(wi, wo), albedo / np.pi * (direct + again), 0.0)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """Where the elevations are equal."""
    return equal_elevations(wo)
