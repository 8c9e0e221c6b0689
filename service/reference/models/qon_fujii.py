"""Fujii's qualitative Oren-Nayar model: interreflection in A, and s / t with t = 1 where s <= 0."""

import numpy as np

from service.reference.directions import both_above, equal_elevations, larger_cosine, tangential_dot
from service.reference.entry import Array, Kinks, Parameters
from service.reference.models.fon import C2
from service.reference.models.qon import slope
from service.reference.oren_nayar import qualitative_shape, ratio


def amplitude(sigma: float, albedo: float) -> float:
    """A, with the light that is reflected twice."""
    return 1.0 - 0.5 * ratio(sigma, 0.33) + 0.17 * albedo * ratio(sigma, 0.13)


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    s = tangential_dot(wi, wo)
    shape = np.where(s > 0.0, s / larger_cosine(wi, wo), s)
    value = amplitude(parameters["sigma"], parameters["albedo"]) + slope(parameters["sigma"]) * shape
    return np.where(both_above(wi, wo), parameters["albedo"] / np.pi * value, 0.0)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine `mu`: rho (A + B (Gq - 2/3 sin) / pi)."""
    mu, sigma, albedo = np.asarray(mu), parameters["sigma"], parameters["albedo"]
    shape = (qualitative_shape(mu) - 2 / 3 * np.sqrt((1.0 - mu) * (1.0 + mu))) / np.pi
    return np.asarray(albedo * (amplitude(sigma, albedo) + slope(sigma) * shape))


def average_albedo(parameters: Parameters) -> float:
    """Albedo averaged over views by their cosine: rho (A + (2/3 - 28/(15 pi)) B), with G less 2/3 sin(theta)."""
    sigma, albedo = parameters["sigma"], parameters["albedo"]
    return albedo * (amplitude(sigma, albedo) + C2 * slope(sigma))


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """Where the elevations are equal."""
    return equal_elevations(wo)
