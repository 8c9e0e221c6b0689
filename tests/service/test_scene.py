"""Scenes: defaults, sweeps, and one clear line for every wrong field."""

import math

import pytest

from service.catalogue import load_catalogue
from service.errors import BadInput
from service.scene import parse_scene, resolve


def problems(**scene):
    with pytest.raises(BadInput) as caught:
        resolve(parse_scene({"model": "eon", **scene}), load_catalogue())
    assert "\n" not in str(caught.value)
    return {problem.field: (problem.value, problem.allowed) for problem in caught.value.problems}


def series(**scene):
    return resolve(parse_scene({"model": "eon", **scene}), load_catalogue()).series


def test_defaults_are_every_technique_made_for_the_model_over_64_angles():
    scene = parse_scene({"model": "eon"})
    assert len(scene.angles_deg) == 64
    assert scene.angles_deg[-1] == pytest.approx(89.91, abs=1e-12)
    assert {plan.technique.name for plan in series()} == {
        *("cosine", "uniform", "ltc-nonnegative", "ltc", "cltc", "cltc-mis")
    }
    assert {plan.technique.name for plan in resolve(parse_scene({"model": "lambert"}), load_catalogue()).series} == {
        "cosine",
        "uniform",
    }


def test_sweeps_form_a_product_with_the_last_name_fastest():
    plans = series(techniques="cosine", parameters={"roughness": [0, 1], "albedo": [0.2, 0.5]})
    assert [(p.parameters["roughness"], p.parameters["albedo"]) for p in plans] == [
        (0, 0.2),
        (0, 0.5),
        (1, 0.2),
        (1, 0.5),
    ]


def test_zipped_sweeps_run_together():
    plans = series(
        techniques="cosine", parameters={"roughness": [0, 1], "albedo": [0.2, 0.5]}, zip=[["roughness", "albedo"]]
    )
    assert [(p.parameters["roughness"], p.parameters["albedo"]) for p in plans] == [(0, 0.2), (1, 0.5)]


@pytest.mark.parametrize("value", [1.5, -1e-9, math.nan, math.inf])
def test_a_parameter_out_of_range_is_named_with_its_range(value):
    (field, (_, allowed)), *rest = problems(parameters={"roughness": value}).items()
    assert (field, allowed, rest) == ("parameters.roughness", "0 to 1", [])


@pytest.mark.parametrize("angle", [90, 90.5, -1, math.nan, math.inf])
def test_view_angles_stop_short_of_the_horizon(angle):
    assert "0 <= theta_o_deg < 90" in problems(theta_o_deg=[10, angle])["theta_o_deg.1"][1]


def test_every_wrong_field_is_reported_at_once():
    found = problems(estimator={"samples": 0, "speed": 3}, theta_o_deg={"count": 0}, colour="red")
    assert set(found) == {"estimator.samples", "estimator.speed", "theta_o_deg.count", "colour"}
    assert found["estimator.samples"][0] == 0


def test_of_fields_whose_names_begin_alike_each_is_reported():
    angles = [95 if k in (1, 10) else 10 for k in range(11)]
    assert set(problems(theta_o_deg=angles, colour="red", colours="blue")) == {
        *("theta_o_deg.1", "theta_o_deg.10", "colour", "colours")
    }


@pytest.mark.parametrize(
    ("field", "value", "at"),
    [
        ("techniques", [1] * 100_000, "techniques"),
        ("statistics", ["x"] * 100_000, "statistics"),
        ("zip", [["a"]] * 100_000, "zip"),
        ("theta_o_deg", [99] * 100_000, "theta_o_deg"),
        ("phi_o_deg", ["x"] * 100_000, "phi_o_deg"),
        ("parameters", {"roughness": [*[0.5] * 100_000, "x", "y"]}, "parameters.roughness.100000"),
    ],
)
def test_a_list_of_any_length_is_one_problem(field, value, at):
    assert set(problems(**{field: value})) == {at}


@pytest.mark.parametrize(
    ("scene", "field", "names"),
    [
        ({"techniques": ["cosin"]}, "techniques", "cosine"),
        ({"model": "enon"}, "model", "eon"),
        ({"parameters": {"rough": 1}}, "parameters.rough", "roughness"),
        ({"statistics": ["men"]}, "statistics.0", "mean"),
        ({"techniques": ["cosine", "cosine"]}, "techniques", "once"),
        ({"zip": [["roughness", "albedo"]]}, "zip", "equal length"),
    ],
)
def test_unknown_names_are_answered_with_the_known_ones(scene, field, names):
    assert names in problems(**scene)[field][1]


def test_a_technique_runs_on_request_on_a_model_it_was_not_made_for():
    (plan,) = resolve(parse_scene({"model": "lambert", "techniques": ["cltc-mis"]}), load_catalogue()).series
    assert plan.parameters == {"albedo": 1.0, "roughness": 1.0}
