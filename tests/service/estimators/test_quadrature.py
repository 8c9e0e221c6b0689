"""The quadrature against the float64 reference, and what it says of integrals it cannot do."""

from dataclasses import replace

import numpy as np
import pytest

from service.estimators.cubature import Goal, Values, integrate
from service.estimators.panels import POINTS
from tests.service.conftest import column

CONVERGENT = ["cosine", "uniform", "ltc-nonnegative", "cltc-mis"]
ROUNDING = 2e-6  # of a variance summed from float32 weights
GRAZING_ROUNDING = 2e-5  # where the weight is f/cos at cos 1e-3: rounding of wi is magnified


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_no_error_exceeds_the_one_that_is_stated(compute, tolerance):
    """Over every convergent technique, four roughnesses and 64 angles; the bound is a heuristic that has to hold."""
    result = compute(
        techniques=CONVERGENT,
        parameters={"roughness": [0.02, 0.25, 0.6, 1.0]},
        estimator={"method": "quadrature", "tolerance": tolerance},
        statistics=["mean", "variance"],
    )
    for series in result["series"]:
        variance = column(series, "reference", "variance")
        off = np.abs(column(series, "variance") - variance)
        assert np.all(off <= column(series, "variance_stderr") + GRAZING_ROUNDING * variance + 1e-12), series[
            "technique"
        ]
        assert np.all(np.abs(column(series, "reference", "mean_error")) <= column(series, "mean_stderr") + ROUNDING)
        if series["verdict"]["status"] == "ok":
            assert np.all(
                column(series, "variance_stderr")
                <= tolerance * np.maximum(column(series, "variance"), 1e-9 / tolerance)
            )


def test_the_aim_of_a_thousandth_is_met_at_roughness_1_in_64_angles(compute):
    result = compute(techniques=CONVERGENT, estimator={"method": "quadrature", "tolerance": 1e-3})
    for series in result["series"]:
        assert series["verdict"]["status"] == "ok"
        assert np.max(np.abs(column(series, "reference", "variance_error"))) < 1e-3


@pytest.mark.parametrize("technique", ["ltc", "cltc"])
@pytest.mark.parametrize("reference", [True, False])
def test_an_infinite_variance_is_null_with_the_finding_also_without_a_reference(compute, technique, reference):
    (series,) = compute(
        techniques=technique, theta_o_deg=[15, 45, 80], estimator={"method": "quadrature"}, reference=reference
    )["series"]
    assert series["variance"] == [None] * 3
    assert series["variance_stderr"] == [None] * 3
    assert series["verdict"]["findings"][0]["name"] == "infinite-variance"
    assert None not in series["mean"]


def test_a_constant_weight_has_no_variance_at_all(compute):
    (series,) = compute(techniques="cosine", parameters={"roughness": 0}, estimator={"method": "quadrature"})["series"]
    assert max(series["variance"]) < 1e-12
    assert np.allclose(series["mean"], 1, rtol=0, atol=1e-7)


def test_powers_of_u_are_integrated_to_their_exact_values():
    """On the host alone: moments of u1^2 u2 over the square are 1/((2k + 1)(k + 1)) for power k."""

    def evaluate(given):
        low, width = given.corner[:, None, :2], given.corner[:, None, 2:]
        grid = np.stack([np.repeat(POINTS, 8), np.tile(POINTS, 8)], axis=1)
        u = low + width * grid
        return Values(u[..., 0] ** 2 * u[..., 1], np.zeros(1))

    found = integrate(1, False, Goal(1e-8, 1e-9, np.array([True]), 1 << 20), evaluate)
    exact = [1 / ((2 * k + 1) * (k + 1)) for k in range(1, 5)]
    c, (a, b, third, _) = found.shift, found.powers[:, 0]
    assert np.isclose(c + a, exact[0], rtol=1e-12)
    assert np.isclose(b + 2 * a * c + c * c, exact[1], rtol=1e-12)
    assert np.isclose(third + 3 * b * c + 3 * a * c * c + c**3, exact[2], rtol=1e-12)


def test_a_jump_on_a_slanted_line_is_enclosed():
    """The indicator of u1 + u2 < 0.7 has mean 0.245; its panels can only shrink around the line."""

    def evaluate(given):
        grid = np.stack([np.repeat(POINTS, 8), np.tile(POINTS, 8)], axis=1)
        u = given.corner[:, None, :2] + given.corner[:, None, 2:] * grid
        return Values((u.sum(axis=-1) < 0.7).astype(float), np.zeros(1))

    found = integrate(1, False, Goal(1e-2, 1e-9, np.array([True]), 1 << 20), evaluate)
    mean = (found.shift + found.powers[0])[0]
    assert abs(mean - 0.245) <= found.mean_error[0] <= 0.01
    assert found.converged[0]


def test_a_logarithmic_divergence_is_seen_and_a_root_is_not_called_one():
    def run(function):
        def evaluate(given):
            u1 = given.corner[:, None, 0] + given.corner[:, None, 2] * np.repeat(POINTS, 8)
            return Values(function(u1), np.zeros(1))

        return integrate(1, False, Goal(1e-4, 1e-9, np.array([True]), 1 << 18), evaluate)

    assert run(lambda u: u**-0.5).growing[0]
    tame = run(lambda u: u**-0.25)
    assert tame.converged[0]
    assert not tame.growing[0]
    variance = (tame.powers[1] - tame.powers[0] ** 2)[0]
    assert np.isclose(variance, 2 - (4 / 3) ** 2, rtol=1e-4)


def test_a_declared_split_saves_nodes_and_changes_no_value(engine, compute):
    """Without `u1_split` the jump of a mixture is enclosed by ever smaller panels."""
    catalogue = engine.catalogue
    entry = catalogue.technique("cltc-mis")
    code = entry.code.replace("u1_split", "another_name")
    unsplit = replace(entry, code=code, declared=frozenset({*entry.declared, "another_name"}) - {"u1_split"})
    without = replace(catalogue, techniques={**catalogue.techniques, "cltc-mis": unsplit})
    scene = {
        "techniques": "cltc-mis",
        "theta_o_deg": [10, 60],
        "estimator": {"method": "quadrature", "tolerance": 1e-3},
    }
    (one,), (other,) = (compute(catalogue=at, **scene)["series"] for at in (catalogue, without))
    assert one["samples"] < other["samples"]
    assert np.allclose(one["variance"], other["variance"], rtol=2e-3)
