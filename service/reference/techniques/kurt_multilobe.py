"""One of two Beckmann half vectors, by its share of the specular reflectance (Kurt et al. 2010, eq. 14)."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters
from service.reference.techniques import beckmann_half_vector as single


def _lobes(parameters: Parameters) -> list[tuple[float, Parameters]]:
    """Probability, by its share of the reflectance, and slopes of each lobe."""
    both = parameters["ks1"] + parameters["ks2"]
    shares = [parameters[f"ks{k}"] / both if both > 0.0 else 0.5 for k in (1, 2)]
    slopes = [{"mx": parameters[f"mx{k}"], "my": parameters[f"my{k}"]} for k in (1, 2)]
    return list(zip(shares, slopes, strict=True))


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), above the horizon and below."""
    return np.asarray(sum(share * single.density(wo, wi, lobe) for share, lobe in _lobes(parameters)))


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    (share, first), (_, second) = _lobes(parameters)
    pick = u1 < share
    stretched = np.where(pick, u1 / max(share, 1e-300), (u1 - share) / max(1.0 - share, 1e-300))
    drawn = [single.sample(wo, np.clip(stretched, 0.0, 1.0 - 2**-53), u2, lobe)[0] for lobe in (first, second)]
    wi = np.where(pick[..., None], *drawn)
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return float(sum(share * single.below_horizon(wo, lobe) for share, lobe in _lobes(parameters)))


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Both lobes, or the one that is drawn."""
    return tuple((lobe["mx"], lobe["my"]) for share, lobe in _lobes(parameters) if share > 0.0)
