"""One-sample mixture of a Beckmann half vector (`lobe_probability`) and of cosine sampling."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters
from service.reference.techniques import beckmann_half_vector as lobe
from service.reference.techniques import cosine
from service.reference.techniques.beckmann_half_vector import half_vector_lobes

__all__ = ["below_horizon", "density", "half_vector_lobes", "kinks", "sample"]


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of ``wi``, shape (..., 3), above the horizon and below."""
    share = parameters["lobe_probability"]
    return share * lobe.density(wo, wi, parameters) + (1.0 - share) * cosine.density(wo, wi, parameters)


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density."""
    share = parameters["lobe_probability"]
    pick = u1 < share
    stretched = np.where(pick, u1 / max(share, 1e-300), (u1 - share) / max(1.0 - share, 1e-300))
    drawn = [part.sample(wo, np.clip(stretched, 0.0, 1.0 - 2**-53), u2, parameters)[0] for part in (lobe, cosine)]
    wi = np.where(pick[..., None], *drawn)
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return parameters["lobe_probability"] * lobe.below_horizon(wo, parameters)
