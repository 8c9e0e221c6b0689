"""The shaders of all models and techniques against the float64 reference, on the device."""

import math

import numpy as np
import pytest

from service.catalogue import load_catalogue
from service.reference.entry import exact_albedo, load_model
from tests.service.conftest import view

THETA_O = (0.0, 30.0, 60.0, 85.0)
MODELS = sorted(load_catalogue().models)
BAD = {"biased", "nonfinite", "negative-weight", "uncovered"}
SAMPLES = 2**18


def defaults(model, **given):
    declared = load_catalogue().models[model].head.parameters
    return {name: parameter.default for name, parameter in declared.items()} | given


@pytest.mark.parametrize("name", MODELS)
def test_a_brdf_and_its_albedo_are_those_of_the_reference(probe, name):
    """To 4e-6 of the value, and 1e-7: exp and pow of the driver are good to 5e-6 at worst, arc functions to 1e-7."""
    parameters, theta_i = defaults(name), np.radians(np.linspace(-89.5, 89.5, 121))
    for angle in THETA_O:
        wi, wo = view(theta_i).astype(np.float32), view(math.radians(angle)).astype(np.float32)
        found = probe(name, "cosine", wo, wi=wi, **parameters)
        rounded = {key: float(np.float32(value)) for key, value in parameters.items()}
        expected = load_model(name).brdf(wi.astype(float), wo.astype(float), rounded)
        visible = expected > 1e-6
        np.testing.assert_allclose(found["brdf"][visible], expected[visible], rtol=1e-5, atol=1e-7)
        exact = exact_albedo(load_model(name), float(wo[2]), rounded)
        if "directional_albedo" in load_catalogue().models[name].declared:
            assert found["albedo"][0] == pytest.approx(exact, abs=1e-6)


@pytest.mark.parametrize("name", MODELS)
def test_sampled_statistics_agree_with_the_reference(compute, name):
    """At 4 standard errors one value in 16,000 lies outside by chance; a model has at most 48."""
    made_for = {"cltc", "ltc"}  # their densities leave light out by design
    techniques = [t for t in load_catalogue().techniques_for(name) if t not in made_for]
    scene = {"model": name, "techniques": techniques, "theta_o_deg": list(THETA_O)}
    for series in compute(**scene, estimator={"samples": SAMPLES, "seed": 11})["series"]:
        found = {finding["name"]: finding["evidence"]["theta_o_deg"] for finding in series["verdict"]["findings"]}
        assert not BAD & set(found), series["technique"]
        trusted = [angle not in found.get("heavy-tail", []) + found.get("infinite-variance", []) for angle in THETA_O]
        for statistic in ("mean", "variance"):
            value, expected = np.array(series[statistic])[trusted], series["reference"][statistic]
            expected = np.array(expected, float)[trusted]
            spread = series["reference"]["variance_stderr"] if statistic == "variance" else series["mean_stderr"]
            spread = np.array(spread, float)[trusted]
            known = np.isfinite(spread)
            assert np.all(np.abs(value - expected)[known] < 4 * spread[known] + 2e-6), series["technique"]
        top = np.array(series["reference"]["max_weight"], float)
        bounded = np.isfinite(top)
        assert np.all(np.array(series["max_weight"])[bounded] <= top[bounded] * (1 + 2e-5)), series["technique"]


@pytest.mark.parametrize("slope", [0.001, 0.01, 10.0])
@pytest.mark.parametrize("phi", [0.0, 40.0])
def test_extreme_slopes_stay_finite_and_right(compute, slope, phi):
    scene = {"model": "kurt", "parameters": {"mx": slope, "alpha": 0.5}, "phi_o_deg": phi}
    scene |= {"techniques": ["beckmann-half-vector", "half-vector-cosine"], "theta_o_deg": [0, 85, 89.9]}
    for series in compute(**scene, estimator={"samples": SAMPLES})["series"]:
        assert series["phi_o_deg"] == phi
        assert not BAD & {finding["name"] for finding in series["verdict"]["findings"]}
        off = np.abs(np.array(series["mean"]) - np.array(series["reference"]["mean"]))
        assert np.all(off < 5 * np.array(series["mean_stderr"]) + 1e-5)


def test_exponents_up_to_a_million_stay_finite_and_right(compute):
    scene = {"model": "ashikhmin-shirley", "parameters": {"nu": [0, 1e6], "nv": [1e6]}, "theta_o_deg": [0, 45, 89]}
    for series in compute(**scene, techniques="ashikhmin-shirley", estimator={"samples": SAMPLES})["series"]:
        assert not BAD & {finding["name"] for finding in series["verdict"]["findings"]}
        off = np.abs(np.array(series["mean"]) - np.array(series["reference"]["mean"]))
        assert np.all(off < 5 * np.array(series["mean_stderr"]) + 1e-5)


@pytest.mark.parametrize(("model", "given"), [("ward-duer", {}), ("oren-nayar-tutorial", {}), ("kurt", {"alpha": 1.0})])
def test_models_that_gain_energy_are_named(compute, model, given):
    scene = {"model": model, "parameters": given, "techniques": "uniform", "theta_o_deg": [89]}
    (series,) = compute(**scene, estimator={"samples": 1000})["series"]
    assert "energy-gain" in [finding["name"] for finding in series["verdict"]["findings"]]


def test_a_mixture_makes_the_diffuse_part_bounded(compute):
    scene = {"model": "kurt", "parameters": {"kd": 0.5, "ks": 0.5}, "theta_o_deg": [45]}
    scene |= {"techniques": ["beckmann-half-vector", "half-vector-cosine"], "estimator": {"samples": SAMPLES}}
    alone, mixed = compute(**scene)["series"]
    assert alone["reference"]["variance"][0] > 1e6
    assert mixed["reference"]["max_weight"][0] < 2
    assert mixed["verdict"]["status"] == "ok"
