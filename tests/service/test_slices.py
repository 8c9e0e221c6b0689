"""Slices are the formulas in the plane of the view: closed forms, symmetries, and every format holds them."""

import csv
import io
import json
import math

import numpy as np
import pytest

from service.formats import encode
from service.scene import parse_scene, resolve
from service.slices import LIGHTS, compute_slices

FLOAT32 = 3e-7
"""Some roundings of float32, relative to values of about 1."""


@pytest.fixture
def slices(engine):
    def run(**scene):
        return compute_slices(resolve(parse_scene(scene), engine.catalogue), engine)

    return run


def test_lambert_with_cosine_and_uniform_has_its_closed_forms(slices):
    result = slices(model="lambert", parameters={"albedo": 0.5}, techniques=["cosine", "uniform"], theta_o_deg=[0, 70])
    assert [(one["technique"], one["theta_o_deg"]) for one in result["series"]] == [
        *(("cosine", 0.0), ("cosine", 70.0)),
        *(("uniform", 0.0), ("uniform", 70.0)),
    ]
    for one in result["series"]:
        cosines = np.cos(np.radians(one["theta_i_deg"]))
        assert one["value"] == pytest.approx(0.5 * cosines / math.pi, abs=FLOAT32)
        exact = cosines / math.pi if one["technique"] == "cosine" else np.full(LIGHTS, 0.5 / math.pi)
        assert one["pdf"] == pytest.approx(exact, abs=FLOAT32)


def test_every_value_of_a_sweep_is_a_series_of_its_own(slices):
    result = slices(model="eon", parameters={"roughness": [0.0, 1.0]}, techniques=["cosine"], theta_o_deg=[60])
    flat, rough = result["series"]
    assert [one["parameters"]["roughness"] for one in (flat, rough)] == [0.0, 1.0]
    # At roughness 0 the model is Lambert; at 1 more light comes back to the view's side than away from it.
    assert flat["value"] == pytest.approx(np.cos(np.radians(flat["theta_i_deg"])) / math.pi, abs=FLOAT32)
    assert sum(rough["value"][LIGHTS // 2 :]) > 1.2 * sum(rough["value"][: LIGHTS // 2 + 1])


def test_the_plane_turns_with_the_azimuth_of_the_view(slices):
    """A quarter turn of the view is the same as an exchange of the slopes along x and y."""
    common = {"model": "ward", "techniques": ["beckmann-half-vector"], "theta_o_deg": [50]}
    turned = slices(**common, parameters={"mx": 0.2, "my": 0.5}, phi_o_deg=[90])["series"][0]
    exchanged = slices(**common, parameters={"mx": 0.5, "my": 0.2}, phi_o_deg=[0])["series"][0]
    assert turned["phi_o_deg"] == 90.0
    for name in ("value", "pdf"):
        # float32 knows a direction at azimuth 90 degrees to 1e-7, which steep lobes enlarge.
        assert turned[name] == pytest.approx(exchanged[name], rel=1e-4, abs=1e-5)


def test_all_formats_hold_the_same_numbers(slices):
    result = slices(model="eon", techniques=["cosine", "cltc"], theta_o_deg=[30])
    assert json.loads(encode(result, "json"))["series"] == result["series"]
    rows = list(csv.DictReader(io.StringIO(encode(result, "csv").decode())))
    assert [float(row["pdf"]) for row in rows] == [pdf for one in result["series"] for pdf in one["pdf"]]
    assert {row["technique"] for row in rows} == {"cosine", "cltc"}
    arrays = np.load(io.BytesIO(encode(result, "npz")))
    assert arrays["pdf"].shape == (2, LIGHTS)
    assert arrays["value"].tolist() == [one["value"] for one in result["series"]]
    text = encode(result, "table").decode()
    assert "f cos(theta_i)" in text
    assert "cltc" in text
