"""FON, the Oren-Nayar variant of Fujii with energy below one: d'Eon, Portsmouth and others 2024, eq. 10 to 13.

f = albedo / pi * A * (1 + r s / t), with s = wi.wo - cos_i cos_o, and t = 1 where s <= 0, else max(cos_i, cos_o).
"""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters

C1 = 1 / 2 - 2 / (3 * np.pi)  # A = 1 / (1 + C1 r)
C2 = 2 / 3 - 28 / (15 * np.pi)  # average albedo A (1 + C2 r)


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    cos_i, cos_o = wi[..., 2], wo[..., 2]
    roughness = parameters.get("roughness", 1.0)
    scale = parameters.get("albedo", 1.0) / np.pi * peak_factor(roughness)
    # The horizontal part of the dot product is s itself: no subtraction, so nothing cancels at grazing angles.
    s = wi[..., 0] * wo[..., 0] + wi[..., 1] * wo[..., 1]
    above = (cos_i > 0.0) & (cos_o > 0.0)
    t = np.where((s > 0.0) & above, np.maximum(cos_i, cos_o), 1.0)
    return np.where(above, scale * (1.0 + roughness * s / t), 0.0)


def peak_factor(roughness: float) -> float:
    """The coefficient A of eq. 11, the albedo at normal incidence for a white surface."""
    return float(1.0 / (1.0 + C1 * roughness))


def missing_albedo(mu: Array | float, sine: Array | float) -> Array:
    """D in 1 - E = A r D / pi, where E is the albedo of white FON for a view of cosine ``mu`` (eq. 13).

    Algebra takes the 1/mu out of the printed G, so neither end of the range cancels.
    """
    mu, sine = np.asarray(mu), np.asarray(sine)
    inner = np.arctan2(mu, sine) + sine * mu - (2 / 3) * mu * (1 + sine + sine * sine) / (1 + sine)
    return np.asarray((np.pi / 2 - 2 / 3) * mu * mu / (1 + sine) + sine * inner)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine ``mu`` (eq. 13)."""
    mu, roughness = np.asarray(mu), parameters.get("roughness", 1.0)
    missing = missing_albedo(mu, np.sqrt((1 - mu) * (1 + mu))) * peak_factor(roughness) * roughness / np.pi
    return np.asarray(parameters.get("albedo", 1.0) * (1.0 - missing))


def white_average(roughness: float) -> float:
    """Albedo of white FON averaged over views, A (1 + C2 r) (eq. 15)."""
    return float(peak_factor(roughness) * (1.0 + C2 * roughness))


def average_albedo(parameters: Parameters) -> float:
    """Albedo averaged over views by their cosine."""
    return parameters.get("albedo", 1.0) * white_average(parameters.get("roughness", 1.0))


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """For s > 0, t changes where the elevations are equal; s changes sign a quarter turn from wo."""
    elevation = float(np.arctan2(wo[2], np.hypot(wo[0], wo[1])))
    return Kinks(elevations=(elevation,))
