"""One-sample mixtures of a lobe and of cosine sampling, the lobe with the probability `lobe_probability`."""

import numpy as np

from service.reference.entry import Array, Parameters, Technique
from service.reference.techniques import cosine


def density(lobe: Technique, wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), above the horizon and below."""
    share = parameters["lobe_probability"]
    return share * lobe.density(wo, wi, parameters) + (1.0 - share) * cosine.density(wo, wi, parameters)


def sample(lobe: Technique, wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density; u1 picks the part and is stretched to be used again."""
    share = parameters["lobe_probability"]
    pick = u1 < share
    stretched = np.where(pick, u1 / max(share, 1e-300), (u1 - share) / max(1.0 - share, 1e-300))
    first = np.clip(stretched, 0.0, 1.0 - 2**-53)
    wi = np.where(
        pick[..., None], lobe.sample(wo, first, u2, parameters)[0], cosine.sample(wo, first, u2, parameters)[0]
    )
    return wi, density(lobe, wo, wi, parameters)


def below_horizon(lobe: Technique, wo: Array, parameters: Parameters) -> float:
    """Exact probability that a direction falls below the horizon."""
    return parameters["lobe_probability"] * lobe.below_horizon(wo, parameters)
