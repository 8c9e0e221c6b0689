"""FON, the Oren-Nayar variant of Fujii with no albedo above one (the EON paper, eq. 10 to 15).

f = albedo / pi * A * (1 + r s / t), with s = wi.wo - cos_i cos_o, and t = 1 where s <= 0, else max(cos_i, cos_o).
"""

import numpy as np

from service.reference.directions import both_above, equal_elevations, larger_cosine, tangential_dot
from service.reference.entry import Array, Kinks, Parameters

C1 = 1 / 2 - 2 / (3 * np.pi)  # A = 1 / (1 + C1 r)
C2 = 2 / 3 - 28 / (15 * np.pi)  # average albedo A (1 + C2 r)


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    roughness = parameters["roughness"]
    scale = parameters["albedo"] / np.pi * peak_factor(roughness)
    s = tangential_dot(wi, wo)
    t = np.where(s > 0.0, larger_cosine(wi, wo), 1.0)
    return np.where(both_above(wi, wo), scale * (1.0 + roughness * s / t), 0.0)


def peak_factor(roughness: float) -> float:
    """The coefficient A of eq. 10, the albedo at normal incidence for a white surface."""
    return float(1.0 / (1.0 + C1 * roughness))


def missing_albedo(mu: Array | float, sine: Array | float) -> Array:
    """D in 1 - E = A r D / pi, where E is the albedo of white FON for a view of cosine `mu` (eq. 12, 13).

    Algebra takes the 1/mu out of the printed G, so neither end of the range cancels.
    """
    mu, sine = np.asarray(mu), np.asarray(sine)
    inner = np.arctan2(mu, sine) + sine * mu - (2 / 3) * mu * (1 + sine + sine * sine) / (1 + sine)
    return np.asarray((np.pi / 2 - 2 / 3) * mu * mu / (1 + sine) + sine * inner)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine `mu` (eq. 12)."""
    mu, roughness = np.asarray(mu), parameters["roughness"]
    missing = missing_albedo(mu, np.sqrt((1 - mu) * (1 + mu))) * peak_factor(roughness) * roughness / np.pi
    return np.asarray(parameters["albedo"] * (1.0 - missing))


def white_average(roughness: float) -> float:
    """Albedo of white FON averaged over views, A (1 + C2 r) (eq. 15)."""
    return float(peak_factor(roughness) * (1.0 + C2 * roughness))


def average_albedo(parameters: Parameters) -> float:
    """Albedo averaged over views by their cosine."""
    return parameters["albedo"] * white_average(parameters["roughness"])


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """For s > 0, t changes where the elevations are equal; s changes sign a quarter turn from wo."""
    return equal_elevations(wo)
