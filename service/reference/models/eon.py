"""EON: FON plus a lobe for the light scattered more than once (the EON paper, eq. 16 to 20)."""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array, Parameters
from service.reference.models import fon
from service.reference.models.fon import C1, C2, kinks, missing_albedo, peak_factor, white_average

__all__ = ["average_albedo", "brdf", "directional_albedo", "kinks", "multiple_albedo"]


def multiple_albedo(parameters: Parameters) -> float:
    """rho_ms of eq. 19: the colour of the multiple-scattering lobe, quadratic in the albedo."""
    albedo = parameters["albedo"]
    average = white_average(parameters["roughness"])
    return float(albedo * albedo * average / (1.0 - albedo * (1.0 - average)))


def average_albedo(parameters: Parameters) -> float:
    """Albedo averaged over views: that of FON and, of what it misses, rho_ms."""
    average = white_average(parameters["roughness"])
    return float(parameters["albedo"] * average + multiple_albedo(parameters) * (1.0 - average))


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    roughness = parameters["roughness"]
    missing_i, missing_o = (missing_albedo(w[..., 2], np.hypot(w[..., 0], w[..., 1])) for w in (wi, wo))
    # (1 - E_i) (1 - E_o) / (1 - E_avg) with each factor's A r / pi taken out, so that r = 0 is Lambert to the bit.
    scale = multiple_albedo(parameters) * peak_factor(roughness) * roughness / (np.pi**3 * (C1 - C2))
    above = both_above(wi, wo)
    return fon.brdf(wi, wo, parameters) + np.where(above, scale * missing_i * missing_o, 0.0)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine `mu`: albedo E + rho_ms (1 - E) (eq. 12, 20)."""
    mu, roughness = np.asarray(mu), parameters["roughness"]
    missing = missing_albedo(mu, np.sqrt((1 - mu) * (1 + mu))) * peak_factor(roughness) * roughness / np.pi
    return np.asarray(parameters["albedo"] * (1.0 - missing) + multiple_albedo(parameters) * missing)
