"""Moments of the weight: two routes, refinement, closed forms, and what the reference says of infinite variance."""

import math

import numpy as np
import pytest

from service.reference import CellReference, cell_reference, cells_reference, load_model, load_technique, moments
from service.reference.entry import Array, Parameters
from service.reference.models import lambert
from service.reference.techniques import cosine
from tests.service.reference import untransformed_quadrature

MODELS = ("lambert", "fon", "eon", "eon-approx")
TECHNIQUES = ("cosine", "uniform", "ltc-nonnegative", "ltc", "cltc", "cltc-mis")
ROUGHNESS = (0.0, 0.05, 0.25, 0.5, 0.75, 1.0)
ANGLES = (0.0, 0.5, 0.7755, 10.0, 45.0, 80.0, 89.0, 89.9)  # degrees; d changes sign at 0.7755


def cell(model: str, technique: str, theta_deg: float, **parameters: float) -> CellReference:
    found = cell_reference(model, technique, {"roughness": 1.0, "albedo": 1.0} | parameters, math.radians(theta_deg))
    assert found is not None
    return found


def every_cell() -> list[tuple[str, float, float]]:
    return [(model, roughness, theta) for roughness in ROUGHNESS for theta in ANGLES for model in MODELS]


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_both_parameterisations_agree(technique: str) -> None:
    for model, roughness, theta in every_cell():
        expected = untransformed_quadrature.moments(model, technique, roughness, math.radians(theta))
        found = cell(model, technique, theta, roughness=roughness)
        # The second route does not know the curve on which the clamp of eon-approx sets in; else both reach 1e-10.
        relative = 1e-7 if model == "eon-approx" else 1e-9
        for name in ("mean", "uncovered", "zero_probability"):
            assert getattr(found, name) == pytest.approx(expected[name], rel=relative, abs=2e-11), (model, name)
        if math.isfinite(found.variance):
            # Below 1e-7 a standard deviation is made of rounded weights 1 + 1e-16, in both routes.
            assert found.variance == pytest.approx(expected["variance"], rel=relative, abs=1e-14), (model, roughness)
            assert found.fourth_moment == pytest.approx(expected["fourth_moment"], rel=relative, abs=1e-14)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_mean_is_albedo_without_the_uncovered_part(technique: str) -> None:
    for model, roughness, theta in every_cell():
        found = cell(model, technique, theta, roughness=roughness, albedo=0.7)
        # One part is quadrature and one a closed form: this bounds the quadrature error by a few roundings.
        assert found.mean == pytest.approx(found.albedo - found.uncovered, rel=2e-14)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_refinement_reaches_the_goal(technique: str) -> None:
    angles = np.radians([*ANGLES, 60.0, 85.0, 89.99, 89.9999])
    for model in MODELS:
        for roughness in (1e-30, 0.01, 1.0):
            cells = cells_reference(model, technique, {"roughness": roughness, "albedo": 1.0}, angles)
            assert cells is not None
            assert all(found.mean_uncertainty <= moments.GOAL * found.mean for found in cells)


def test_more_nodes_do_not_change_the_moments(monkeypatch: pytest.MonkeyPatch) -> None:
    cases = [(m, t, theta) for m in ("fon", "eon-approx") for t in TECHNIQUES for theta in (10.0, 80.0, 89.9)]
    before = [cell(m, t, theta) for m, t, theta in cases]
    monkeypatch.setattr(moments, "COARSE", 25)
    monkeypatch.setattr(moments, "FINE", 40)
    for (m, t, theta), old in zip(cases, before, strict=True):
        new = cell(m, t, theta)
        # The goal bounds the coarser of two rules; the finer one is far inside.
        assert new.mean == pytest.approx(old.mean, rel=1e-14)
        assert new.variance == pytest.approx(old.variance, rel=1e-11)
        assert new.fourth_moment == pytest.approx(old.fourth_moment, rel=1e-11)


@pytest.mark.parametrize("theta", [0.0, 0.5, 10.0, 45.0, 80.0, 89.0, 89.9, 89.99, 89.9999])
@pytest.mark.parametrize("roughness", [0.05, 0.5, 1.0])
def test_variance_of_cosine_on_fon_is_the_closed_form(theta: float, roughness: float) -> None:
    found = cell("fon", "cosine", theta, roughness=roughness, albedo=0.8)
    mu, sine = math.cos(math.radians(theta)), math.sin(math.radians(theta))
    # w = albedo A (1 + r s/t); second moment of s/t under cos_i / pi, integrated by hand on both sides of theta_o.
    second = 0.5 * sine**2 * (0.5 - math.log(mu) - sine**2 / 4)
    scale = 0.8 / (1 + (0.5 - 2 / (3 * math.pi)) * roughness)
    first = (found.mean / scale - 1) / roughness if theta > 0 else 0.0
    # The subtraction of first^2 and its division by r cost digits for small variances, hence the absolute part.
    assert found.variance == pytest.approx((scale * roughness) ** 2 * (second - first**2), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("technique", ["cosine", "ltc-nonnegative", "ltc", "cltc", "cltc-mis"])
@pytest.mark.parametrize("model", ["lambert", "fon", "eon"])
def test_without_roughness_every_weight_is_the_albedo(model: str, technique: str) -> None:
    for theta in ANGLES:
        found = cell(model, technique, theta, roughness=0.0, albedo=0.8)
        # Weights are rounded to 1e-16, so their variance is of order 1e-32.
        assert found.variance < 1e-29
        assert found.max_weight == pytest.approx(0.8, rel=1e-14)
        assert found.tail_strength == found.uncovered == found.zero_probability == 0.0


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_a_black_surface_has_only_zero_weights(technique: str) -> None:
    for model in MODELS:
        found = cell(model, technique, 80.0, albedo=0.0)
        assert found.mean == found.variance == found.fourth_moment == found.max_weight == found.tail_strength == 0.0
        # The density integrates to one by quadrature.
        assert found.zero_probability == pytest.approx(1.0, abs=moments.GOAL)


def test_the_reference_names_the_techniques_with_infinite_variance() -> None:
    for technique in TECHNIQUES:
        for roughness in (1e-6, 0.05, 1.0):
            for theta in (0.0, 10.0, 89.99):
                found = cell("eon", technique, theta, roughness=roughness)
                diverges = technique in ("ltc", "cltc")
                assert (found.variance == math.inf) is diverges
                assert (found.fourth_moment == math.inf) is diverges
                assert (found.max_weight == math.inf) is diverges
                assert (found.tail_strength > 0.0) is diverges
                assert (found.uncovered > 0.0) is diverges


def test_clipped_lobe_loses_three_quarters_of_a_percent_at_grazing() -> None:
    # The paper's figure 11 shows a "slight bias": 0.992 in its right panel, for both lobes with d < 0.
    for technique in ("ltc", "cltc"):
        found = cell("eon", technique, 89.9)
        assert found.albedo == pytest.approx(1.0, abs=1e-15)
        assert found.mean == pytest.approx(0.9923, abs=1e-4)


@pytest.mark.parametrize("theta", [0.2, 10.0, 45.0, 80.0, 89.9])
@pytest.mark.parametrize("model", ["fon", "eon"])
@pytest.mark.parametrize("clipped", [True, False])
def test_tail_strength_is_the_limit_of_the_tail_probability(model: str, theta: float, clipped: bool) -> None:
    found = cell(model, "cltc" if clipped else "ltc", theta)
    tails = [2 * w**2 * tail_probability(model, theta, clipped, w) for w in (1e4, 1e5)]
    # Corrections to the tail fall like 1/W.
    assert tails[0] == pytest.approx(found.tail_strength, rel=1e-2)
    assert tails[1] == pytest.approx(found.tail_strength, rel=1e-3)


def tail_probability(model: str, theta: float, clipped: bool, threshold: float) -> float:
    """P(w > threshold) in the untransformed space, where the edge is the horizon and the density cos / pi is known."""
    the_model, the_technique = load_model(model), load_technique("cltc" if clipped else "ltc")
    assert the_model is not None
    assert the_technique is not None
    wo = np.array([math.sin(math.radians(theta)), 0.0, math.cos(math.radians(theta))])
    lobe = untransformed_quadrature.matrix("cltc", wo, {"roughness": 1.0})
    a, b, c, d = (float(v) for v in (lobe.a, lobe.b, lobe.c, lobe.d))
    nodes, weights = np.polynomial.legendre.leggauss(64)
    psi = np.pi / 4 * (nodes + 1)
    side = 1.0 if d > 0 else -1.0  # the side of the untransformed horizon that maps above the surface
    low, high = np.full(64, 1e-12), np.full(64, 0.1)
    for _ in range(60):
        tilt = np.sqrt(low * high)
        x, y, z = side * np.cos(psi) * np.cos(tilt), np.sin(psi), np.cos(psi) * np.sin(tilt)
        wi = np.stack([a * x + b * z, c * y, d * x + z], axis=-1)
        wi /= np.linalg.norm(wi, axis=-1, keepdims=True)
        reflected = the_model.brdf(wi, wo, {"roughness": 1.0, "albedo": 1.0}) * wi[:, 2]
        heavier = reflected > threshold * the_technique.density(wo, wi, {"roughness": 1.0})
        low, high = np.where(heavier, tilt, low), np.where(heavier, high, tilt)
    share = 0.5 + 0.5 / math.hypot(1.0, d) if clipped else 1.0
    inside = np.cos(psi) ** 2 * 2 * np.sin(low / 2) ** 2 / (np.pi * share)
    return float(2 * np.pi / 4 * np.sum(weights * inside))


def test_part_of_the_lobe_below_the_horizon_has_the_area_of_the_cut_half_ellipse() -> None:
    found = cell("eon", "ltc", 89.9)
    assert found.zero_probability == pytest.approx(0.0531, abs=1e-4)
    assert cell("eon", "cltc", 89.9).zero_probability == 0.0


def test_samples_below_the_horizon_count_as_zero_weights() -> None:
    class Wasteful:
        """Cosine sampling that sends a quarter of its samples below the horizon."""

        kinks, below_horizon = staticmethod(cosine.kinks), staticmethod(lambda wo, parameters: 0.25)
        sample = staticmethod(cosine.sample)

        def density(self, wo: Array, wi: Array, parameters: Parameters) -> Array:
            return 0.75 * cosine.density(wo, wi, parameters)

    pair = moments.Pair(lambert, Wasteful(), {"albedo": 1.0}, np.array([0.6, 0.0, 0.8]))
    found = moments.integrate_moments(pair, finite=True)
    # w is 4/3 with probability 3/4, else 0.
    assert found.mean == pytest.approx(1.0, rel=1e-14)
    assert found.variance == pytest.approx(0.75 / 9 + 0.25, rel=1e-13)
    assert found.fourth == pytest.approx(0.75 / 81 + 0.25, rel=1e-13)
    assert found.weightless == 0.25


def test_unknown_names_have_no_reference() -> None:
    for name in ("mine", "../fon", "fon.brdf", ""):
        assert cell_reference(name, "cosine", {}, 0.3) is None
        assert cells_reference("fon", name, {}, [0.3]) is None
        assert cells_reference("fon", name, {}, []) is None
    assert cells_reference("fon", "cosine", {}, []) == []


@pytest.mark.parametrize("theta_o", [-0.1, math.pi / 2, math.nan])
def test_views_below_the_horizon_are_refused(theta_o: float) -> None:
    with pytest.raises(ValueError, match="theta_o must be in"):
        cell_reference("fon", "cosine", {}, theta_o)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_extreme_inputs_give_numbers(technique: str) -> None:
    for model in ("fon", "eon-approx"):
        for roughness in (1.0, 1e-6, 1e-300, 5e-324):
            for theta_o in (1e-12, 1e-5, math.radians(89.9999), math.nextafter(math.pi / 2, 0.0)):
                found = cell_reference(model, technique, {"roughness": roughness, "albedo": 0.5}, theta_o)
                assert found is not None
                assert found.mean == pytest.approx(found.albedo - found.uncovered, rel=1e-13)
                assert found.variance >= 0.0
                assert found.max_weight >= found.mean * (1 - 1e-14)
                assert found.mean_uncertainty < 1e-6 * found.mean


def test_the_view_azimuth_does_not_matter() -> None:
    for technique in TECHNIQUES:
        straight = cell_reference("eon", technique, {"roughness": 1.0, "albedo": 1.0}, 1.2)
        turned = cell_reference("eon", technique, {"roughness": 1.0, "albedo": 1.0}, 1.2, phi_o=2.5)
        assert straight is not None
        assert turned is not None
        for name in ("mean", "variance", "max_weight", "uncovered", "tail_strength"):
            # Rounding of the turned components only.
            assert getattr(turned, name) == pytest.approx(getattr(straight, name), rel=1e-12, abs=1e-15)
