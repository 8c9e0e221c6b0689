"""The microfacet models and their techniques: identities, limits and the quadrature that finds narrow lobes."""

import math

import numpy as np
import pytest

from service.catalogue import load_catalogue
from service.reference import cell_reference, load_model, load_technique

MODELS = (
    *("kurt-plausible", "kurt", "kurt-coupled", "kurt-multilobe", "ward", "ward-duer"),
    *("ashikhmin-shirley", "cook-torrance", "blinn-phong"),
)
OWN = dict.fromkeys(MODELS, "beckmann-half-vector")
OWN |= {name: name for name in ("kurt-multilobe", "ashikhmin-shirley", "blinn-phong")}
KURT = {"kd": 0.0, "ks": 1.0, "f0": 1.0, "mx": 0.3, "my": 0.3, "alpha": 0.0}


def defaults(model, **given):
    declared = load_catalogue().models[model].head.parameters
    return {name: parameter.default for name, parameter in declared.items()} | given


def view(theta_deg, phi=0.0):
    theta = math.radians(theta_deg)
    return np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])


def cell(model, technique, parameters, theta_deg, phi=0.0):
    return cell_reference(model, technique, parameters, math.radians(theta_deg), phi)


@pytest.mark.parametrize("name", MODELS)
def test_it_is_reciprocal_and_dark_below_the_horizon(name):
    rng = np.random.default_rng(1)
    wi, wo = rng.normal(size=(2, 400, 3))
    wi, wo = (w / np.linalg.norm(w, axis=1)[:, None] for w in (wi, wo))
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    parameters = defaults(name)
    there, back = (load_model(name).brdf(a, b, parameters) for a, b in ((wi, wo), (wo, wi)))
    np.testing.assert_allclose(there, back, rtol=1e-12)
    assert np.all(there[above] > 0)
    assert np.all(there[~above] == 0)


@pytest.mark.parametrize("alpha", [0.0, 0.25, 0.5, 1.0, 1.5])
def test_the_own_weight_of_kurt_is_a_product_of_cosines(alpha):
    """f cos / p = ks F ci^(1 - alpha) / (ch co^alpha): the distribution cancels."""
    parameters = KURT | {"alpha": alpha, "ks": 0.7, "f0": 0.2, "my": 0.1}
    wo, u = view(70.0, 0.6), np.random.default_rng(2).random((2, 1000))
    wi, pdf = load_technique("beckmann-half-vector").sample(wo, *u, parameters)
    wi, pdf = wi[wi[:, 2] > 0], pdf[wi[:, 2] > 0]
    weight = load_model("kurt").brdf(wi, wo, parameters) * wi[:, 2] / pdf
    h = (wi + wo) / np.linalg.norm(wi + wo, axis=1)[:, None]
    fresnel = 0.2 + 0.8 * (1 - np.sum(h * wo, axis=1)) ** 5
    expected = 0.7 * fresnel * wi[:, 2] ** (1 - alpha) / (h[:, 2] * wo[2] ** alpha)
    np.testing.assert_allclose(weight, expected, rtol=1e-9)


@pytest.mark.parametrize("theta", [0.0, 45.0, 80.0, 85.0])
def test_the_largest_own_weight_of_kurt_at_alpha_a_half_is_one_over_the_view_cosine(theta):
    """At alpha = 1/2 and F = 1 it is sqrt(ci/co)/ch, at most 1/co, which the normal direction of wi reaches."""
    top = cell("kurt", "beckmann-half-vector", KURT | {"alpha": 0.5}, theta).max_weight
    cosine = math.cos(math.radians(theta))
    light = np.linspace(-math.pi / 2, math.pi / 2, 200_001)[1:-1]
    wi = np.stack([np.sin(light), 0 * light, np.cos(light)], axis=1)
    h_cosine = (wi[:, 2] + cosine) / np.linalg.norm(wi + view(theta), axis=1)
    dense = np.max(np.sqrt(wi[:, 2] / cosine) / h_cosine)
    assert top == pytest.approx(dense, rel=1e-8)
    assert top <= 1 / cosine * (1 + 1e-9)


@pytest.mark.parametrize(("model", "theta"), [("ashikhmin-shirley", t) for t in (0.0, 60.0, 85.0)])
def test_the_own_weight_of_ashikhmin_shirley_is_at_most_one(model, theta):
    assert cell(model, model, defaults(model, nu=10.0, nv=1000.0), theta, 0.7).max_weight == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("n", [0.0, 1.0, 10.0, 1e3, 1e5])
def test_blinn_phong_is_normalized_at_normal_incidence(n):
    """Its factor makes the albedo 1 there exactly."""
    for technique in ("blinn-phong", "cosine"):
        assert cell("blinn-phong", technique, {"ks": 1.0, "n": n}, 0).albedo == pytest.approx(1, abs=1e-8)


@pytest.mark.parametrize("slopes", [(0.01, 0.01), (0.01, 0.5), (0.3, 0.3), (2.0, 5.0)])
@pytest.mark.parametrize("theta", [0.0, 45.0, 85.0, 89.9])
def test_what_is_drawn_below_the_horizon_is_what_the_density_lacks_above(slopes, theta):
    """Two integrals that share no node: over the rim, and over the hemisphere as an albedo of a model with w = 1."""
    wo, parameters = view(theta, 0.4), {"mx": slopes[0], "my": slopes[1]}
    below = load_technique("beckmann-half-vector").below_horizon(wo, parameters)
    rng = np.random.default_rng(3)
    wi, _ = load_technique("beckmann-half-vector").sample(wo, *rng.random((2, 200_000)), parameters)
    spread = math.sqrt(max(below * (1 - below), 1e-12) / 200_000)
    assert np.mean(wi[:, 2] <= 0) == pytest.approx(below, abs=5 * spread + 1e-5)


@pytest.mark.parametrize(
    ("model", "technique", "given", "infinite", "unbounded"),
    [
        ("kurt", "beckmann-half-vector", {"alpha": 1.0}, False, False),
        ("kurt", "beckmann-half-vector", {"alpha": 1.01}, False, True),
        ("kurt", "beckmann-half-vector", {"alpha": 1.49}, False, True),
        ("kurt", "beckmann-half-vector", {"alpha": 1.5}, True, True),
        ("kurt", "cosine", {"alpha": 0.0}, False, False),
        ("kurt", "cosine", {"alpha": 0.01}, False, True),
        ("kurt", "cosine", {"alpha": 0.99}, False, True),
        ("kurt", "cosine", {"alpha": 1.0}, True, True),
        ("kurt", "uniform", {"alpha": 1.0}, False, False),
        ("kurt", "uniform", {"alpha": 1.49}, False, True),
        ("kurt", "uniform", {"alpha": 1.5}, True, True),
        ("ward", "cosine", {}, False, True),
        ("ward-duer", "cosine", {}, True, True),
        ("ward-duer", "beckmann-half-vector", {}, False, False),
    ],
)
def test_which_weights_are_unbounded_and_which_variances_infinite(model, technique, given, infinite, unbounded):
    found = cell(model, technique, defaults(model, **given), 45.0)
    assert math.isinf(found.variance) == infinite
    assert math.isinf(found.max_weight) == unbounded


@pytest.mark.parametrize("model", MODELS)
def test_every_technique_finds_the_same_albedo_of_a_narrow_lobe_at_grazing(model):
    """m = 0.01 at 85 degrees and azimuth 30: the densities that share nothing agree to 1e-7."""
    narrow = {name: 0.01 for name in defaults(model) if name[:2] in ("mx", "my")}
    narrow |= {name: 2e4 for name in defaults(model) if name in ("nu", "nv", "n")}
    parameters = defaults(model, **narrow)
    albedos = [cell(model, technique, parameters, 85.0, math.pi / 6) for technique in (OWN[model], "cosine", "uniform")]
    for found in albedos[1:]:
        assert found.albedo == pytest.approx(albedos[0].albedo, rel=1e-7)
        assert found.mean_uncertainty < 1e-6 * found.mean


def test_the_plausible_model_gains_energy_at_grazing_above_slope_1_881():
    for slope, gains in ((1.87, False), (1.89, True)):
        parameters = {"ks": 1.0, "f0": 1.0, "mx": slope, "my": slope}
        assert (cell("kurt-plausible", "beckmann-half-vector", parameters, 89.999).albedo > 1) == gains


@pytest.mark.parametrize(
    ("model", "given", "power"),
    [("kurt", {"alpha": 0.25}, 0.25), ("kurt", {"alpha": 1.0}, 1.0), ("ward", {}, 0.5), ("ward-duer", {}, 1.0)],
)
def test_albedos_that_grow_without_limit_at_grazing(model, given, power):
    near, nearer = (
        cell(model, "beckmann-half-vector", defaults(model, **given), 90 - angle).albedo for angle in (1e-4, 1e-6)
    )
    assert math.log(nearer / near) / math.log(100) == pytest.approx(power, abs=2e-3)


@pytest.mark.parametrize("model", ["cook-torrance", "ashikhmin-shirley", "blinn-phong"])
def test_models_that_never_gain_energy(model):
    for width in (0.05, 0.5, 3.0):
        given = dict.fromkeys(("mx", "my"), width) if model == "cook-torrance" else {}
        given |= {name: 2 / width**2 for name in defaults(model) if name in ("nu", "nv", "n")}
        for theta in (0.0, 60.0, 85.0, 89.9):
            assert cell(model, OWN[model], defaults(model, **given), theta).albedo <= 1 + 1e-8


def test_the_coupled_model_gains_energy_even_without_alpha():
    """kd = ks = 1 and f0 = 0 reach 1.046: Schlick's term counts the grazing light twice."""
    largest = max(
        cell("kurt-coupled", "half-vector-cosine",
             KURT | {"kd": 1.0, "f0": 0.0, "mx": m, "my": m, "lobe_probability": 0.5}, theta).albedo
        for m in (0.2, 0.4, 0.6, 0.8, 1.0)
        for theta in np.linspace(60, 89.9, 20)
    )  # fmt: skip
    assert 1.02 < largest < 1.05


@pytest.mark.parametrize(
    ("alpha", "angle"),
    [(0.0, None), (0.25, 88.8), (0.5, 79.6), (0.7, 0.0)],
)
def test_up_to_which_angle_cosine_has_less_variance_than_the_own_technique_at_slope_one(alpha, angle):
    def cosine_wins(theta):
        parameters = KURT | {"mx": 1.0, "my": 1.0, "alpha": alpha}
        own, other = (cell("kurt", name, parameters, theta).variance for name in ("beckmann-half-vector", "cosine"))
        return other < own

    before, after = (89.9, None) if angle is None else (angle - 0.1, angle + 0.1)
    assert angle == 0.0 or cosine_wins(before)
    assert after is None or not cosine_wins(after)


def test_half_vectors_fill_all_four_quadrants_evenly():
    """What eq. 17 says once its arc tangent has a quadrant."""
    u = np.random.default_rng(5).random((2, 100_000))
    wi, _ = load_technique("beckmann-half-vector").sample(view(0.0), *u, {"mx": 0.2, "my": 0.6})
    quadrants = np.bincount(2 * (wi[:, 0] > 0) + (wi[:, 1] > 0), minlength=4)
    np.testing.assert_allclose(quadrants / 1e5, 0.25, atol=5 * math.sqrt(0.1875 / 1e5))


def test_the_tangent_from_the_cosine_loses_its_digits_for_narrow_lobes():
    """In float32 at slopes about m = 0.001: from 1 - n.h^2 it is off by 6 percent, from the components by 1e-6."""
    slope = np.geomspace(0.5e-3, 2e-3, 2001)
    exact = slope.astype(np.float32).astype(np.float64)
    h = (np.stack([exact, 0.0 * exact, 0.0 * exact + 1.0]) / np.sqrt(1.0 + exact**2)).astype(np.float32)
    from_cosine = (np.float32(1) - h[2] * h[2]) / (h[2] * h[2])
    from_components = (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2])
    near = np.abs(exact / 1e-3 - 1.0) < 0.1
    assert 0.05 < np.max(np.abs(from_cosine / exact**2 - 1.0)[near]) < 0.08
    assert np.max(np.abs(from_components / exact**2 - 1.0)) < 1e-6


def test_wo_h_as_a_dot_product_cancels_at_grazing():
    """In float32, view and light 1e-4 above the horizon on opposite sides: the sum of the cosines does not cancel.

    Rounding of the components, 6e-8, is 3e-4 of a sum as long as 2e-4: more than the dot product, of 1e-4.
    """
    rng = np.random.default_rng(3)
    slope, turn = 1e-4 * rng.uniform(0.5, 2.0, (2, 500)), rng.uniform(0.0, 2e-4, 500)
    wo = np.stack([np.cos(slope[0]), 0.0 * turn, np.sin(slope[0])])
    wi = np.stack([-np.cos(slope[1]) * np.cos(turn), np.cos(slope[1]) * np.sin(turn), np.sin(slope[1])])
    exact = np.sum((wi + wo) * wo, axis=0) / np.linalg.norm(wi + wo, axis=0)
    wi, wo = wi.astype(np.float32), wo.astype(np.float32)
    h = (wi + wo) / np.sqrt(np.sum((wi + wo) ** 2, axis=0, dtype=np.float32))
    dot = np.sum(wo * h, axis=0, dtype=np.float32)
    ratio = (wi[2] + wo[2]) / (np.float32(2) * h[2])
    assert np.max(np.abs(dot / exact - 1.0)) > 0.1
    assert np.max(np.abs(ratio / exact - 1.0)) < 1e-3
