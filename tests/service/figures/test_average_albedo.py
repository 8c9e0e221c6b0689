"""Average albedos: the integral over views, the closed form beside it, and the panel that shows both."""

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from service.average_albedo import integrate_over_views, with_average_albedo
from service.figures import albedo_chart
from service.formats import encode
from service.reference.entry import exact_albedo, load_model

ANGLES = np.linspace(0.0, 89.91, 64)


@pytest.mark.parametrize(("albedo", "average"), [(lambda t: 0.7 + 0 * t, 0.7), (lambda t: t, math.pi / 4)])
def test_linear_albedos_are_integrated_exactly(albedo, average):
    """Integrals of sin(2 t) and of t sin(2 t) to pi/2; the last piece is held constant, which costs 1e-6 at most."""
    theta = np.radians(np.append(ANGLES, 89.9999))
    assert integrate_over_views(theta, albedo(theta)) == pytest.approx(average, abs=1e-9)


def sweep(model, name, values):
    """A statistics result whose sampled means are exact."""
    series = [
        {
            "model": model,
            "technique": "cosine",
            "parameters": {name: value, "albedo": 0.9},
            "theta_o_deg": ANGLES.tolist(),
            "mean": [
                exact_albedo(load_model(model), math.cos(math.radians(angle)), {name: value, "albedo": 0.9})
                for angle in ANGLES
            ],
            "samples": 1000,
        }
        for value in values
    ]
    return {"kind": "statistics", "scene": {"estimator": {"seed": 0}}, "series": series, "run": {"device": "none"}}


@pytest.mark.parametrize(("model", "name"), [("qon", "sigma"), ("fon", "roughness"), ("eon", "roughness")])
def test_the_integral_of_exact_albedos_is_the_closed_form(model, name):
    """A piecewise linear albedo over 64 angles is off by E'' h^2 / 12, 5e-5 times a curvature below 1."""
    block = with_average_albedo(sweep(model, name, [0.0, 0.5, 1.0]), name)["average_albedo"]
    at = np.searchsorted(block["closed_form"]["value"], [0.0, 0.5, 1.0])
    assert np.allclose(np.array(block["closed_form"]["average"])[at], block["integrated"]["average"], atol=5e-5)


def test_a_model_without_a_closed_form_has_points_only():
    block = with_average_albedo(sweep("oren-nayar-tutorial", "sigma", [0.2, 0.4]), "sigma")["average_albedo"]
    assert block["closed_form"] == {"value": [], "average": []}
    assert len(block["integrated"]["average"]) == 2


def test_the_panel_is_drawn_beside_the_albedos():
    result = with_average_albedo(sweep("qon", "sigma", [0.0, 0.5, 1.0]), "sigma")
    root = ET.fromstring(encode(result, "svg", albedo_chart))
    words = {"".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {"average albedo", "directional albedo", "sigma"} <= words
