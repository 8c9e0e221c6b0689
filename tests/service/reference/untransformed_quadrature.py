"""Moments of the weight by a second route, which shares no quadrature with service.reference.

It integrates over the untransformed sphere of the technique's own lobe (the sphere itself for cosine and uniform), in
spherical coordinates whose pole is the y axis. There the horizon, the edge of the lobe and s = 0 are planes through
the pole, that is limits of one coordinate; cos_i = cos_o is a curve in closed form. The rule is tanh-sinh, which does
not care how an integrand behaves at the ends of an interval.
"""

import itertools
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from service.reference import load_model, load_technique
from service.reference.entry import Array
from service.reference.transformed_cosine import Lobe, eon_lobe

STEP = 0.08  # tanh-sinh step; halving it changes no moment below by more than the tolerances of the tests
SPAN = 3.3  # outermost node: the weight there is below 1e-17 of the largest

IDENTITY = Lobe(*(np.asarray(v) for v in (1.0, 0.0, 1.0, 0.0)), clipped=False)


def tanh_sinh(step: float = STEP) -> tuple[Array, Array]:
    """Nodes and weights on [0, 1]."""
    t = np.arange(-SPAN, SPAN + step / 2, step)
    inner = np.pi / 2 * np.sinh(t)
    return 1 / (1 + np.exp(-2 * inner)), step * np.pi / 4 * np.cosh(t) / np.cosh(inner) ** 2


def matrix(technique: str, wo: Array, parameters: Mapping[str, float]) -> Lobe:
    if technique in ("cosine", "uniform"):
        return IDENTITY
    return eon_lobe(wo, parameters["roughness"], shear_z=technique != "ltc-nonnegative")


@lru_cache(maxsize=2)
def lobe_rule(technique: str, roughness: float, theta_o: float) -> tuple[Array, Array, Array, Array]:
    """View, directions, solid angles and probabilities, which all models share."""
    wo = np.array([np.sin(theta_o), 0.0, np.cos(theta_o)])
    wi, solid_angle = nodes(matrix(technique, wo, {"roughness": roughness}), wo)
    the_technique = load_technique(technique)
    assert the_technique is not None
    return wo, wi, solid_angle, the_technique.density(wo, wi, {"roughness": roughness}) * solid_angle


def moments(model: str, technique: str, roughness: float, theta_o: float) -> dict[str, float]:
    """Mean, variance, fourth central moment and uncovered part; the last moments only mean something where finite."""
    wo, wi, solid_angle, mass = lobe_rule(technique, roughness, theta_o)
    the_model = load_model(model)
    assert the_model is not None
    reflected = the_model.brdf(wi, wo, {"roughness": roughness, "albedo": 1.0}) * wi[:, 2] * solid_angle
    covered = mass > 0
    mean = float(np.sum(reflected[covered]))
    deviation = reflected[covered] / mass[covered] - mean
    below = 1.0 - float(np.sum(mass)) if technique == "ltc" else 0.0
    return {
        "mean": mean,
        "variance": float(np.sum(mass[covered] * deviation**2)) + below * mean**2,
        "fourth_moment": float(np.sum(mass[covered] * deviation**4)) + below * mean**4,
        "uncovered": float(np.sum(reflected[~covered])),
        "zero_probability": below,
    }


def nodes(lobe: Lobe, wo: Array) -> tuple[Array, Array]:
    """Directions above the horizon, shape (N, 3), and their solid angles; y > 0 only, counted twice."""
    a, b, c, d = (float(v) for v in (lobe.a, lobe.b, lobe.c, lobe.d))
    sine, mu = float(wo[0]), float(wo[2])
    start = -np.arctan(d)  # horizon: d cos + sin = 0
    level = np.arctan2(a * mu - d * sine, sine - b * mu)  # cos_i = cos_o reaches y = 0
    side = np.arctan2(a, -b)  # s = 0
    breaks = sorted({start, level, side, start + np.pi, *(x for x in (0.0, np.pi) if start < x < start + np.pi)})
    x, w = tanh_sinh()
    parts = []
    for low, high in itertools.pairwise(breaks):
        alpha = (low + (high - low) * x)[:, None]
        toward, height = a * np.cos(alpha) + b * np.sin(alpha), d * np.cos(alpha) + np.sin(alpha)
        top = np.full_like(alpha, np.pi / 2)
        if level <= low and high <= side:
            square = height**2 * (sine / mu) ** 2 - toward**2
            top = np.arctan(np.sqrt(np.maximum(square, 0.0)) / c)
        for bottom, ceiling in ((np.zeros_like(top), top), (top, np.full_like(top, np.pi / 2))):
            psi = bottom + (ceiling - bottom) * x
            vector = np.stack(np.broadcast_arrays(np.cos(psi) * toward, c * np.sin(psi), np.cos(psi) * height), axis=-1)
            length = np.linalg.norm(vector, axis=-1)
            area = 2 * np.cos(psi) * (ceiling - bottom) * w * (high - low) * w[:, None]
            keep = (area > 0) & (vector[..., 2] > 0)
            parts.append(((vector / length[..., None])[keep], (area * c * (a - b * d) / length**3)[keep]))
    # Contiguous components, as everything after this is arithmetic on them.
    return np.asfortranarray(np.concatenate([p[0] for p in parts])), np.concatenate([p[1] for p in parts])
