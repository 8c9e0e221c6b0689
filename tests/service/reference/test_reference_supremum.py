"""The supremum of the weight: nothing found is larger, and known limits are met."""

import math

import numpy as np
import pytest

from service.reference import cell_reference, load_model, load_technique
from service.reference.entry import Array

BOUNDED = ("cosine", "uniform", "ltc-nonnegative", "cltc-mis")
ANGLES = (0.0, 0.5, 10.0, 45.0, 70.0, 80.0, 89.0, 89.9)


def candidates(theta_o: float) -> Array:
    """Directions all over the hemisphere, close to the horizon, in the plane of wo and at the height of wo."""
    rng = np.random.default_rng(11)
    count = 15_000
    spread = rng.uniform(0, np.pi / 2, count)
    low = 10.0 ** rng.uniform(-12, 0, count)
    level = np.pi / 2 - theta_o + rng.normal(0, 1e-3, count)
    elevation = np.clip(np.concatenate([spread, low, level]), 1e-12, np.pi / 2)
    azimuth = rng.uniform(0, np.pi, elevation.size) * (rng.random(elevation.size) < 0.7)
    azimuth = np.where(rng.random(elevation.size) < 0.2, np.pi, azimuth)
    up = np.cos(elevation)
    return np.stack([up * np.cos(azimuth), up * np.sin(azimuth), np.sin(elevation)], axis=-1)


@pytest.mark.parametrize("name", BOUNDED)
@pytest.mark.parametrize("model_name", ["fon", "eon", "eon-approx"])
def test_no_sampled_weight_exceeds_the_supremum(model_name: str, name: str) -> None:
    model, technique = load_model(model_name), load_technique(name)
    assert model is not None
    assert technique is not None
    for theta in ANGLES:
        theta_o = math.radians(theta)
        wo, wi = np.array([math.sin(theta_o), 0.0, math.cos(theta_o)]), candidates(theta_o)
        for roughness in (0.05, 0.5, 1.0):
            parameters = {"roughness": roughness, "albedo": 1.0}
            weight = model.brdf(wi, wo, parameters) * wi[:, 2] / technique.density(wo, wi, parameters)
            found = cell_reference(model_name, name, parameters, theta_o)
            assert found is not None
            highest = float(weight.max())
            assert found.max_weight >= highest * (1 - 1e-12)  # rounding of one weight
            assert found.max_weight <= highest * (1 + 2e-2)  # as near as 45 000 random directions come


@pytest.mark.parametrize("theta", ANGLES)
def test_cosine_on_fon_tends_to_its_bound_at_the_horizon(theta: float) -> None:
    found = cell_reference("fon", "cosine", {"roughness": 0.8, "albedo": 0.5}, math.radians(theta))
    assert found is not None
    scale = 0.5 / (1 + (0.5 - 2 / (3 * math.pi)) * 0.8)
    # albedo (A + B tan theta_o), approached at theta_i = 90 degrees towards wo; the limit is taken 1e-18 above it.
    assert found.max_weight == pytest.approx(scale * (1 + 0.8 * math.tan(math.radians(theta))), rel=1e-12)


def test_uniform_on_lambert_is_heaviest_at_the_normal() -> None:
    found = cell_reference("lambert", "uniform", {"albedo": 0.5}, 1.0)
    assert found is not None
    assert found.max_weight == pytest.approx(1.0, rel=1e-14)  # 2 cos_i albedo at cos_i = 1
