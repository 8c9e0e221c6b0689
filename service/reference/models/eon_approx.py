"""EON with the polynomial fit of the FON albedo in its multiple-scattering lobe (the EON paper, eq. 14, listing 1).

The fit exceeds one near the horizon, where the clamp of listing 1 takes over: a kink about 0.08 degrees above it.
"""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array, Kinks, Parameters
from service.reference.models import fon
from service.reference.models.eon import multiple_albedo
from service.reference.models.fon import C1, C2, peak_factor

CLAMP = 1e-7
FIT = (0.0571085289, 0.491881867, -0.332181442, 0.0714429953)  # of (1 - mu)^1 ... (1 - mu)^4


def _unclamped(mu: Array | float, roughness: float) -> Array:
    x = 1.0 - np.asarray(mu)
    fit = x * (FIT[0] + x * (FIT[1] + x * (FIT[2] + x * FIT[3])))
    return np.asarray(peak_factor(roughness) * roughness * (C1 - fit))


def _missing(mu: Array | float, roughness: float) -> Array:
    return np.maximum(_unclamped(mu, roughness), CLAMP)


def _lobe_scale(parameters: Parameters) -> float:
    roughness = parameters["roughness"]
    average_missing = peak_factor(roughness) * roughness * (C1 - C2)
    return multiple_albedo(parameters) / max(average_missing, CLAMP)


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    roughness = parameters["roughness"]
    missing = _missing(wi[..., 2], roughness) * _missing(wo[..., 2], roughness)
    above = both_above(wi, wo)
    lobe = np.where(above, _lobe_scale(parameters) / np.pi * missing, 0.0)
    return fon.brdf(wi, wo, parameters) + lobe


def clamp_cosine(roughness: float) -> float:
    """Cosine at which the clamp sets in; 0 where it never does, 1 where it always does."""
    if _unclamped(1.0, roughness) <= CLAMP:
        return 1.0
    if _unclamped(0.0, roughness) >= CLAMP:
        return 0.0
    low, high = 0.0, 1.0  # the fit rises with 1 - mu over the whole range, so there is one crossing
    while (middle := 0.5 * (low + high)) not in (low, high):
        low, high = (middle, high) if _unclamped(middle, roughness) < CLAMP else (low, middle)
    return high


def _average_missing(roughness: float) -> float:
    """Cosine average of the clamped 1 - E: integral of 2 mu max(1 - E, clamp) over mu, exactly."""
    x = 1.0 - clamp_cosine(roughness)
    constant = C1 * (2 * x - x**2)
    powers = sum(g * (x ** (k + 1) / (k + 1) - x ** (k + 2) / (k + 2)) for k, g in enumerate(FIT, start=1))
    fitted = peak_factor(roughness) * roughness * (constant - 2 * powers)
    return float(fitted + CLAMP * (1.0 - x) ** 2)


def directional_albedo(mu: Array | float, parameters: Parameters) -> Array:
    """Albedo for views of cosine `mu`: exact in the FON part, the fit's own average in the lobe."""
    roughness = parameters["roughness"]
    lobe = _lobe_scale(parameters) * _missing(mu, roughness) * _average_missing(roughness)
    return np.asarray(fon.directional_albedo(mu, parameters) + lobe)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """Those of FON, and the elevation at which the clamp sets in."""
    clamp = float(np.arcsin(clamp_cosine(parameters["roughness"])))
    return Kinks(elevations=(*fon.kinks(wo, parameters).elevations, clamp))
