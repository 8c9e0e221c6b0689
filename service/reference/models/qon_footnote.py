"""The qualitative Oren-Nayar model with the constant 0.57 of its footnote, which stands for interreflection."""

from service.reference.directions import equal_elevations
from service.reference.entry import Array, Kinks, Parameters
from service.reference.models.qon import slope
from service.reference.oren_nayar import qualitative_albedo, qualitative_average, qualitative_brdf, ratio


def amplitude(sigma: float) -> float:
    """A with 0.57 in place of 0.33."""
    return 1.0 - 0.5 * ratio(sigma, 0.57)


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    sigma = parameters["sigma"]
    return qualitative_brdf(wi, wo, parameters["albedo"], amplitude(sigma), slope(sigma))


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine `mu`."""
    sigma = parameters["sigma"]
    return qualitative_albedo(mu, parameters["albedo"], amplitude(sigma), slope(sigma))


def average_albedo(parameters: Parameters) -> float:
    """Albedo averaged over views by their cosine."""
    sigma = parameters["sigma"]
    return qualitative_average(parameters["albedo"], amplitude(sigma), slope(sigma))


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """Where the elevations are equal."""
    return equal_elevations(wo)
