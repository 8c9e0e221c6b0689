"""The qualitative Oren-Nayar model (the EON paper, eq. 1 to 9): rho / pi (A + B max(0, s) / max(cos_i, cos_o))."""

from service.reference.directions import equal_elevations
from service.reference.entry import Array, Kinks, Parameters
from service.reference.oren_nayar import qualitative_albedo, qualitative_average, qualitative_brdf, ratio


def amplitude(sigma: float) -> float:
    """A, the albedo at normal incidence of a white surface."""
    return 1.0 - 0.5 * ratio(sigma, 0.33)


def slope(sigma: float) -> float:
    """The coefficient B."""
    return 0.45 * ratio(sigma, 0.09)


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
