"""Densities and samplers: that they belong together, integrate to one and keep the roles of wo and wi."""

import math
from fractions import Fraction

import numpy as np
import pytest

from service.reference.entry import Array, Technique, load_technique
from service.reference.techniques import cltc_mis
from service.reference.transformed_cosine import eon_lobe
from tests.service.reference import untransformed_quadrature

TECHNIQUES = ("cosine", "uniform", "ltc-nonnegative", "ltc", "cltc", "cltc-mis")
ONE_BRANCH = ("cosine", "uniform", "ltc-nonnegative", "ltc", "cltc")
ANGLES = (0.0, 0.3, 10.0, 45.0, 80.0, 89.9)  # degrees; d > 0 in the first two


def technique(name: str) -> Technique:
    found = load_technique(name)
    assert found is not None
    return found


def view(theta_deg: float, phi: float = 0.0) -> Array:
    theta = math.radians(theta_deg)
    return np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])


@pytest.mark.parametrize("name", TECHNIQUES)
def test_density_integrates_to_one(name: str) -> None:
    for roughness in (0.0, 0.05, 0.5, 1.0):
        for theta in ANGLES:
            wo = view(theta)
            lobe = untransformed_quadrature.matrix(name, wo, {"roughness": roughness})
            wi, solid_angle = untransformed_quadrature.nodes(lobe, wo)
            total = float(np.sum(technique(name).density(wo, wi, {"roughness": roughness}) * solid_angle))
            below = technique(name).below_horizon(wo, {"roughness": roughness})
            # Above the horizon by quadrature, below it in closed form.
            assert total + below == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize("theta", ANGLES)
def test_lobe_density_is_the_transformed_cosine_of_the_inverse_matrix(theta: float) -> None:
    wo, roughness = view(theta), 0.7
    mu = float(wo[2])
    r = roughness
    # Listing 2 as printed.
    a = 1 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r)
    b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545)
    c = 1 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r
    d = ((0.540852 + (-1.01625 + 0.475392 * mu) * mu) * r) / (-1.0743 + mu * (0.0725628 + mu))
    inverse = np.linalg.inv(np.array([[a, 0, b], [0, c, 0], [d, 0, 1]]))
    rng = np.random.default_rng(13)
    wi = rng.normal(size=(500, 3))
    wi /= np.linalg.norm(wi, axis=-1, keepdims=True)
    back = wi @ inverse.T
    length = np.linalg.norm(back, axis=-1)
    expected = np.maximum(back[:, 2] / length, 0) / np.pi * np.linalg.det(inverse) / length**3  # eq. 23, 24
    found = technique("ltc").density(wo, wi, {"roughness": roughness})
    # The printed d loses ten digits near the normal, where it is of order 1e-3.
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)
    share = 0.5 + 0.5 / math.hypot(1, d)  # eq. 28
    clipped = technique("cltc").density(wo, wi, {"roughness": roughness})
    np.testing.assert_allclose(clipped, np.where(wi[:, 2] > 0, expected / share, 0), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("theta", ANGLES)
@pytest.mark.parametrize("name", ONE_BRANCH)
def test_density_is_one_over_the_jacobian_of_the_sampler(name: str, theta: float) -> None:
    rng = np.random.default_rng(7)
    u1, u2 = rng.uniform(0.05, 0.95, (2, 2000))
    wo, parameters, step = view(theta, 0.8), {"roughness": 1.0}, 1e-5
    wi, pdf = technique(name).sample(wo, u1, u2, parameters)

    def slope(du1: float, du2: float) -> Array:
        ahead, _ = technique(name).sample(wo, u1 + du1, u2 + du2, parameters)
        behind, _ = technique(name).sample(wo, u1 - du1, u2 - du2, parameters)
        return np.asarray((ahead - behind) / (2 * step))

    area = np.linalg.norm(np.cross(slope(step, 0.0), slope(0.0, step)), axis=-1)
    # Central differences: truncation step^2 times a third derivative of order 1e3 (square roots), rounding 1e-11.
    np.testing.assert_allclose(area * pdf, 1.0, rtol=2e-6)
    np.testing.assert_allclose(np.linalg.norm(wi, axis=-1), 1.0, rtol=1e-15)
    np.testing.assert_array_equal(pdf, technique(name).density(wo, wi, parameters))


@pytest.mark.parametrize("theta", ANGLES)
@pytest.mark.parametrize("name", TECHNIQUES)
def test_sampler_and_density_have_the_same_averages(name: str, theta: float) -> None:
    wo, parameters = view(theta), {"roughness": 1.0}
    u = (np.arange(600) + 0.5) / 600
    u1, u2 = np.meshgrid(u, u, indexing="ij")
    drawn, _ = technique(name).sample(wo, u1, u2, parameters)
    wi, solid_angle = untransformed_quadrature.nodes(untransformed_quadrature.matrix(name, wo, parameters), wo)
    mass = technique(name).density(wo, wi, parameters) * solid_angle
    above = drawn[..., 2] > 0
    for probe in (lambda w: w[..., 0], lambda w: w[..., 2], lambda w: w[..., 1] ** 2, lambda w: w[..., 0] * w[..., 2]):
        # Midpoint rule with jumps at the horizon and between branches: error of order 1/600 of a jump's share.
        expected = float(np.sum(probe(wi) * mass))
        assert float(np.mean(np.where(above, probe(drawn), 0.0))) == pytest.approx(expected, abs=5e-4)
    if technique(name).below_horizon(wo, parameters) == 0.0:
        assert np.all(above)


@pytest.mark.parametrize("theta", [0.0, 0.3, 0.7754, 0.7756, 10.0, 89.9])
def test_clipped_lobe_ends_at_the_horizon_for_either_sign_of_d(theta: float) -> None:
    u2 = np.linspace(0, 1, 1000, endpoint=False)
    drawn, _ = technique("cltc").sample(view(theta), np.full(1000, 1 - 1e-14), u2, {"roughness": 1.0})
    # The rim of the squeezed disk is half horizon, half edge of the lobe; 1e-14 of the disk is sqrt(1e-14) in height.
    assert drawn[:, 2].min() == pytest.approx(0.0, abs=3e-7)
    unclipped, _ = technique("ltc").sample(view(theta), np.full(1000, 1 - 1e-14), u2, {"roughness": 1.0})
    if abs(theta - 0.7755) > 0.01:
        assert unclipped[:, 2].min() < -1e-3


@pytest.mark.parametrize("name", ["ltc-nonnegative", "ltc", "cltc", "cltc-mis"])
def test_density_takes_the_view_first(name: str) -> None:
    wo, wi = view(80.0), view(30.0, 1.0)
    there = technique(name).density(wo, wi, {"roughness": 1.0})
    back = technique(name).density(wi, wo, {"roughness": 1.0})
    assert abs(there / back - 1) > 0.05


@pytest.mark.parametrize("name", TECHNIQUES)
def test_many_views_at_once_give_what_each_gives(name: str) -> None:
    rng = np.random.default_rng(9)
    wo = np.stack([view(t, p) for t, p in zip(rng.uniform(0, 89.9, 50), rng.uniform(-4, 4, 50), strict=True)])
    u1, u2 = rng.random((2, 50))
    wi, pdf = technique(name).sample(wo, u1, u2, {"roughness": 0.7})
    for k in range(50):
        one, one_pdf = technique(name).sample(wo[k], u1[k], u2[k], {"roughness": 0.7})
        np.testing.assert_allclose(wi[k], one, rtol=1e-14, atol=1e-15)
        assert pdf[k] == pytest.approx(one_pdf, rel=1e-13)


@pytest.mark.parametrize("name", TECHNIQUES)
def test_lobe_turns_with_the_view(name: str) -> None:
    turn = 2.1
    rotation = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
    wo, wi = view(70.0), view(40.0, 0.6)
    straight = technique(name).density(wo, wi, {"roughness": 1.0})
    assert technique(name).density(rotation @ wo, rotation @ wi, {"roughness": 1.0}) == pytest.approx(
        straight, rel=1e-13
    )


@pytest.mark.parametrize("name", ONE_BRANCH[2:])
def test_without_roughness_a_lobe_is_cosine_sampling(name: str) -> None:
    wi = np.stack([view(t, p) for t in (0.0, 30.0, 89.99) for p in (0.0, 2.0)])
    expected = technique("cosine").density(view(60.0), wi, {})
    np.testing.assert_allclose(technique(name).density(view(60.0), wi, {"roughness": 0.0}), expected, rtol=1e-15)
    assert cltc_mis.uniform_probability(np.asarray(0.5), 0.0) == 0.0


def test_shear_is_the_listings_also_where_the_listing_cancels() -> None:
    for theta in (0.0, 1e-6, 1e-3, 0.5, 0.7755, 5.0, 60.0, 89.9):
        wo = view(theta)
        # mu is irrational: take the exact value of the sine's square, from which e = 1 - mu follows.
        e = Fraction(float(wo[0] ** 2 + wo[1] ** 2)) / Fraction(1 + float(wo[2]))
        mu = 1 - e
        above = Fraction("0.540852") + (Fraction("-1.01625") + Fraction("0.475392") * mu) * mu
        d = above / (Fraction("-1.0743") + mu * (Fraction("0.0725628") + mu))
        # At 0.7755 degrees d passes through zero; there only its absolute accuracy means anything.
        assert float(eon_lobe(wo, 1.0).d) == pytest.approx(float(d), rel=1e-13, abs=1e-17)


def test_shear_is_positive_only_for_views_within_0_7755_degrees() -> None:
    signs = [float(np.sign(eon_lobe(view(theta), 1.0).d)) for theta in (0.0, 0.7754, 0.7756, 5.0, 89.99)]
    assert signs == [1.0, 1.0, -1.0, -1.0, -1.0]


def test_matrix_never_degenerates_over_its_whole_range() -> None:
    wo = np.stack([view(theta) for theta in np.linspace(0, 90, 500)])
    for roughness in np.linspace(0, 1, 51):
        lobe = eon_lobe(wo, float(roughness))
        assert np.all(lobe.stretch > 0.7)
        assert np.all(lobe.c > 0.5)
        probability = cltc_mis.uniform_probability(wo[:, 2], float(roughness))
        assert np.all((probability >= 0) & (probability < 0.2))
