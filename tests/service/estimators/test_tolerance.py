"""A tolerance picks estimator and count, says what it picked, and says so where it cannot be reached."""

import numpy as np
import pytest

from service.errors import BadInput
from service.estimators import choice
from service.scene import parse_scene


def test_a_tolerance_alone_picks_the_quadrature_and_says_so(compute):
    (series,) = compute(techniques="cosine", estimator={"tolerance": 1e-3})["series"]
    assert series["estimator"]["method"] == "quadrature"
    assert series["estimator"]["tolerance"] == 1e-3
    assert series["estimator"]["samples"] == series["samples"] < 10_000
    assert np.max(np.abs(np.array(series["reference"]["variance_error"], float))) < 1e-3
    assert series["verdict"]["status"] == "ok"


def test_without_a_tolerance_the_method_is_mc():
    assert parse_scene({"model": "eon"}).estimator.method == "mc"
    assert parse_scene({"model": "eon", "estimator": {"samples": 5}}).estimator.method == "mc"
    picked = parse_scene({"model": "eon", "estimator": {"tolerance": 0.01}})
    assert picked.estimator.method is None
    assert parse_scene(picked.model_dump(mode="json")) == picked


@pytest.mark.parametrize("method", ["mc", "qmc"])
def test_a_sampled_method_draws_until_its_error_bars_reach_the_tolerance(compute, method):
    (series,) = compute(
        techniques="uniform",
        theta_o_deg=[0, 60],
        estimator={"method": method, "tolerance": 5e-3},
        statistics="variance",
    )["series"]
    assert series["estimator"]["method"] == method
    assert np.all(2 * np.array(series["variance_stderr"]) <= 5e-3 * np.array(series["variance"]))
    assert np.max(np.abs(np.array(series["reference"]["variance_error"], float))) < 4 / 2 * 5e-3
    assert series["verdict"]["status"] == "ok"


def test_a_tolerance_out_of_reach_is_said_to_be(compute, monkeypatch):
    monkeypatch.setattr(choice, "MOST_SAMPLES", 1 << 17)
    (series,) = compute(techniques="cosine", theta_o_deg=[85], estimator={"method": "mc", "tolerance": 1e-5})["series"]
    (finding,) = [f for f in series["verdict"]["findings"] if f["name"] == "imprecise"]
    assert finding["evidence"]["tolerance"] == 1e-5
    assert finding["evidence"]["variance_relative_error"][0] > 1e-5
    assert "does not reach" in finding["message"]


def test_an_infinite_variance_does_not_keep_the_others_from_the_quadrature(compute):
    series = compute(techniques=["ltc", "uniform"], theta_o_deg=[45], estimator={"tolerance": 1e-3})["series"]
    assert [one["estimator"]["method"] for one in series] == ["quadrature"] * 2
    assert series[0]["variance"] == [None]
    assert series[1]["variance"][0] > 0


@pytest.mark.parametrize("tolerance", [0, -1, 1e-9, 2, "nan", "x"])
def test_a_tolerance_out_of_range_is_refused(tolerance):
    with pytest.raises(BadInput, match=r"estimator\.tolerance = .*: allowed is a number, 1e-06 to 1"):
        parse_scene({"model": "eon", "estimator": {"tolerance": tolerance}})
