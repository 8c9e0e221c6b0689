"""Clipped lobe and uniform hemisphere as one-sample multiple importance sampling (the EON paper, listing 4)."""

import numpy as np

from service.reference.entry import Array, Kinks, Parameters
from service.reference.techniques import uniform
from service.reference.transformed_cosine import Lobe, eon_lobe, lobe_density, lobe_edge, sample_lobe


def uniform_probability(mu: Array, roughness: float) -> Array:
    """Probability of the uniform hemisphere for views of cosine `mu`; 0 at roughness 0."""
    fit = 0.162925 + mu * (-0.372058 + (0.538233 - 0.290822 * mu) * mu)
    return np.asarray(roughness**0.1 * fit)


def _parts(wo: Array, parameters: Parameters) -> tuple[Lobe, Array]:
    roughness = parameters["roughness"]
    return eon_lobe(wo, roughness, clipped=True), uniform_probability(wo[..., 2], roughness)


def density(wo: Array, wi: Array, parameters: Parameters) -> Array:
    """Density in 1/sr of `wi`, shape (..., 3), for views `wo` that broadcast."""
    lobe, probability = _parts(wo, parameters)
    spread = uniform.density(wo, wi, parameters)
    return np.asarray(probability * spread + (1.0 - probability) * lobe_density(lobe, wo, wi))


def sample(wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
    """Directions of shape (..., 3) and their density; u1 picks the part and is stretched to be used again."""
    lobe, probability = _parts(wo, parameters)
    pick = u1 < probability
    # Where the probability is 0 nothing is picked; the divisor only has to be a number.
    first = np.where(pick, u1 / np.where(probability > 0.0, probability, 1.0), (u1 - probability) / (1.0 - probability))
    spread, _ = uniform.sample(wo, first, u2, parameters)
    clipped, _ = sample_lobe(lobe, wo, first, u2)
    wi = np.where(pick[..., None], spread, clipped)
    return wi, density(wo, wi, parameters)


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """The edge of the lobe, and the elevation at which both parts are about equally dense."""
    lobe, probability = _parts(wo, parameters)
    floor = float(probability) / (2.0 * np.pi)
    return Kinks(elevations=(np.pi * floor,), edge=lobe_edge(lobe, floor))


def below_horizon(wo: Array, parameters: Parameters) -> float:
    """No direction falls below the horizon."""
    return 0.0
