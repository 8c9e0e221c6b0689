"""The models' closed forms against each other, against quadrature and against the facts known of them."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from service.reference.entry import Array, Model, load_model
from service.reference.models import eon_approx, fon

MODELS = ("lambert", "fon", "eon", "eon-approx")


def model(name: str) -> Model:
    found = load_model(name)
    assert found is not None
    return found


def directions(count: int, seed: int) -> Array:
    """Directions over the hemisphere, half of them close to the horizon."""
    rng = np.random.default_rng(seed)
    z = np.where(np.arange(count) % 2 == 0, rng.random(count), 10.0 ** rng.uniform(-8, 0, count))
    azimuth = rng.uniform(0, 2 * np.pi, count)
    sine = np.sqrt((1 - z) * (1 + z))
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), z], axis=-1)


@pytest.mark.parametrize("name", MODELS)
def test_models_are_reciprocal(name: str) -> None:
    wi, wo = directions(4000, 1), directions(4000, 2)
    for roughness in (0.0, 0.3, 1.0):
        parameters = {"roughness": roughness, "albedo": 0.6}
        forward, back = model(name).brdf(wi, wo, parameters), model(name).brdf(wo, wi, parameters)
        # Rounding only; 1 + r s cancels at forward grazing, hence the absolute part.
        np.testing.assert_allclose(forward, back, rtol=1e-13, atol=1e-16)
        assert np.all(forward >= 0)


@pytest.mark.parametrize("name", MODELS)
def test_models_are_zero_where_a_direction_is_not_above_the_horizon(name: str) -> None:
    up, down = np.array([0.6, 0.0, 0.8]), np.array([0.6, 0.0, -0.8])
    level = np.array([1.0, 0.0, 0.0])
    for wi, wo in ((up, down), (down, up), (down, down), (level, up), (level, level)):
        assert model(name).brdf(wi, wo, {"roughness": 1.0, "albedo": 1.0}) == 0.0


@pytest.mark.parametrize("name", ["fon", "eon"])
def test_without_roughness_the_value_is_lambert_to_the_bit(name: str) -> None:
    wi, wo = directions(1000, 5), directions(1000, 6)
    parameters = {"roughness": 0.0, "albedo": 0.37}
    np.testing.assert_array_equal(model(name).brdf(wi, wo, parameters), 0.37 / np.pi)


def test_eon_at_albedo_one_reflects_everything() -> None:
    mu = np.concatenate([[1e-300, 1e-12, 1 - 1e-12, 1.0], np.linspace(1e-3, 1, 200)])
    for roughness in (0.0, 0.1, 1.0):
        found = model("eon").directional_albedo(mu, {"roughness": roughness, "albedo": 1.0})
        np.testing.assert_allclose(found, 1.0, rtol=4e-16)  # rho_ms is 1 for albedo 1 up to two roundings


@pytest.mark.parametrize("name", ["fon", "eon", "eon-approx"])
def test_values_are_the_printed_ones_in_polar_angles(name: str) -> None:
    rng = np.random.default_rng(12)
    theta_i, theta_o = rng.uniform(0.05, 1.5, (2, 500))
    between, phi_o, roughness, albedo = rng.uniform(0, 2 * np.pi, 500), 0.7, 0.8, 0.6
    wi, wo = (
        np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)
        for t, p in ((theta_i, phi_o + between), (theta_o, np.full(500, phi_o)))
    )
    # Eq. 7 to 19 as printed; s/t = cos(phi) sin(larger) tan(smaller) where cos(phi) > 0.
    larger, smaller = np.maximum(theta_i, theta_o), np.minimum(theta_i, theta_o)
    toward = np.where(np.cos(between) > 0, np.tan(smaller), np.sin(smaller)) * np.sin(larger) * np.cos(between)
    peak = 1 / (1 + (0.5 - 2 / (3 * np.pi)) * roughness)
    average = peak * (1 + (2 / 3 - 28 / (15 * np.pi)) * roughness)

    def single(theta: Array) -> Array:
        sine, cosine, x = np.sin(theta), np.cos(theta), 1 - np.cos(theta)
        printed = (sine * (theta - sine * cosine) + 2 / 3 * (sine / cosine * (1 - sine**3) - sine)) / np.pi
        fitted = 0.0571085289 * x + 0.491881867 * x**2 - 0.332181442 * x**3 + 0.0714429953 * x**4
        return np.asarray(peak * (1 + roughness * (fitted if name == "eon-approx" else printed)))

    colour = albedo**2 * average / (1 - albedo * (1 - average)) / np.pi
    several = colour * (1 - single(theta_i)) * (1 - single(theta_o)) / (1 - average)
    expected = albedo / np.pi * peak * (1 + roughness * toward) + (several if name != "fon" else 0.0)
    found = model(name).brdf(wi, wo, {"roughness": roughness, "albedo": albedo})
    # The printed 1 - E cancels to a few 1e-16.
    np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_missing_albedo_is_the_printed_form() -> None:
    theta = np.linspace(0.05, 1.5, 100)
    mu, sine = np.cos(theta), np.sin(theta)
    printed = sine * (theta - sine * mu) + 2 / 3 * (sine / mu * (1 - sine**3) - sine)
    # Away from both ends, where the printed G cancels.
    np.testing.assert_allclose(fon.missing_albedo(mu, sine), math.pi / 2 - 2 / 3 - printed, rtol=0, atol=2e-15)


def test_missing_albedo_keeps_its_digits_at_both_ends() -> None:
    # G is 0 at the normal; at the horizon every term is of second order but for S (asin mu + S mu - S mu) -> mu.
    assert fon.missing_albedo(1.0, 0.0) == pytest.approx((math.pi / 2 - 2 / 3), rel=1e-15)
    ratio = [float(fon.missing_albedo(mu, math.sqrt((1 - mu) * (1 + mu)))) / mu for mu in (1e-4, 1e-8, 1e-16)]
    assert ratio[1] == pytest.approx(1.0, abs=1e-7)
    assert ratio[2] == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("roughness", [0.2, 1.0])
def test_average_albedos_are_the_papers(roughness: float) -> None:
    def weighted(mu: float) -> float:
        return 2 * mu * float(fon.directional_albedo(mu, {"roughness": roughness, "albedo": 1.0}))

    average, _ = quad(weighted, 0, 1, epsabs=1e-13, epsrel=1e-13)
    expected = fon.peak_factor(roughness) * (1 + fon.C2 * roughness)
    assert average == pytest.approx(expected, rel=1e-12)


def test_approximate_eon_gains_and_loses_energy_where_it_is_known_to() -> None:
    albedo = eon_approx.directional_albedo(np.cos(np.radians([82.5, 17.0])), {"roughness": 1.0, "albedo": 1.0})
    np.testing.assert_allclose(albedo, [1.00015, 0.99946], atol=5e-6)  # known to five decimals


def test_clamp_of_the_fit_sets_in_close_to_the_horizon() -> None:
    assert eon_approx.clamp_cosine(1.0) == pytest.approx(0.0014, abs=1e-4)
    assert eon_approx.clamp_cosine(1e-8) == 1.0
