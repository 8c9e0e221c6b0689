"""The Oren-Nayar family: closed forms, bridges between its models, and where energy is not kept.

The limits are facts of the formulas: roots and maxima of closed forms, or of an integral over one angle.
"""

import math

import numpy as np
import pytest

from service.reference.entry import exact_albedo, exact_average_albedo, load_model

SIGMAS = np.linspace(0.0, math.pi / 2, 1571)
NEARLY_GRAZING = 1e-9  # cosine
CLOSED = ("qon", "qon-footnote", "qon-fujii", "oren-nayar-tutorial")
ALL = (*CLOSED, "oren-nayar-full")


def view(cosine):
    return np.array([math.sqrt((1 - cosine) * (1 + cosine)), 0.0, cosine])


def integrated_albedo(model, cosine, parameters, order=80):
    """Gauss-Legendre in the cosine of wi below and above that of wo, and in azimuth between quarter turns."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    nodes, weights = (nodes + 1) / 2, weights / 2
    wo, total = view(cosine), 0.0
    split = math.acos(cosine)
    for low, high in ((0.0, split), (split, math.pi / 2)):
        theta, d_theta = low + (high - low) * nodes[:, None], (high - low) * weights[:, None]
        for quarter in (0.0, math.pi / 2):
            phi, d_phi = quarter + math.pi / 2 * nodes, math.pi / 2 * weights
            sine = np.sin(theta)
            wi = np.stack(np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)), axis=-1)
            total += np.sum(model.brdf(wi, wo, parameters) * np.cos(theta) * sine * d_theta * d_phi)
    return 2.0 * total


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("cosine", [1.0, 0.9, 0.5, 0.05])
def test_the_closed_albedo_is_the_integral(name, cosine):
    model = load_model(name)
    for sigma in (0.0, 0.1, 0.5, 1.5):
        parameters = {"sigma": sigma, "albedo": 0.7}
        expected = integrated_albedo(model, cosine, parameters)
        assert exact_albedo(model, cosine, parameters) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", ALL)
def test_without_roughness_it_is_lambert(name):
    wi, wo = view(0.3), view(0.6)
    assert load_model(name).brdf(wi, wo, {"sigma": 0.0, "albedo": 0.5}) == pytest.approx(0.5 / math.pi, rel=1e-14)


@pytest.mark.parametrize("name", ALL)
def test_it_is_reciprocal(name):
    rng = np.random.default_rng(4)
    wi, wo = rng.normal(size=(2, 500, 3))
    wi, wo = (np.abs(w / np.linalg.norm(w, axis=1)[:, None]) * [1, 1, 1] for w in (wi, wo))
    there, back = (load_model(name).brdf(a, b, {"sigma": 0.8, "albedo": 0.9}) for a, b in ((wi, wo), (wo, wi)))
    np.testing.assert_allclose(there, back, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "largest"),
    [("qon", 1.0152), ("qon-footnote", 1.0444), ("qon-fujii", 1.0287), ("oren-nayar-tutorial", 1.289)],
)
def test_the_largest_albedo_at_grazing(name, largest):
    model = load_model(name)
    found = max(exact_albedo(model, NEARLY_GRAZING, {"sigma": sigma, "albedo": 1.0}) for sigma in SIGMAS)
    assert found == pytest.approx(largest, abs=5e-5 if largest < 1.1 else 5e-4)


def test_qon_gains_energy_only_where_sigma_is_low():
    gains = [exact_albedo(load_model("qon"), NEARLY_GRAZING, {"sigma": s, "albedo": 1.0}) > 1 for s in SIGMAS[1:]]
    limit = SIGMAS[1:][gains][-1]
    assert all(gains[: np.searchsorted(SIGMAS[1:], limit)])
    assert limit == pytest.approx(0.326, abs=1e-3)


def test_the_full_model_gains_five_percent_at_grazing():
    model = load_model("oren-nayar-full")
    albedos = [integrated_albedo(model, 1e-5, {"sigma": s, "albedo": 1.0}, 120) for s in np.linspace(0.2, 0.5, 31)]
    assert max(albedos) == pytest.approx(1.0510, abs=1e-4)


def test_the_full_model_is_negative_in_forward_grazing_scattering_at_low_albedo():
    wi = view(1e-6) * [-1, 1, 1]
    sign = {rho: float(load_model("oren-nayar-full").brdf(wi, view(1e-6), {"sigma": math.pi / 2, "albedo": rho}))
            for rho in (0.82, 0.85)}  # fmt: skip
    assert sign[0.82] < 0 < sign[0.85]


def test_fon_never_gains_energy():
    cosines = np.linspace(1e-9, 1.0, 300)
    for roughness in np.linspace(0.0, 1.0, 21):
        albedo = load_model("fon").directional_albedo(cosines, {"roughness": roughness, "albedo": 1.0})
        assert np.all(albedo <= 1.0 + 1e-15)


@pytest.mark.parametrize("name", ["qon", "qon-footnote", "qon-fujii", "fon", "eon"])
@pytest.mark.parametrize("parameters", [{"sigma": s, "roughness": r, "albedo": a} for s, r, a in
                                        ((0.2, 0.1, 1.0), (0.8, 0.6, 0.7), (1.5, 1.0, 1.0))])  # fmt: skip
def test_the_average_albedo_in_closed_form_is_the_integral(name, parameters):
    """By Gauss-Legendre in the angle of the view; the directional albedo is smooth in it."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    theta = math.pi / 4 * (nodes + 1)
    albedo = load_model(name).directional_albedo(np.cos(theta), parameters)
    average = math.pi / 4 * np.sum(weights * albedo * np.sin(2 * theta))
    assert exact_average_albedo(load_model(name), parameters) == pytest.approx(average, abs=1e-12)


def test_the_average_albedos_of_the_papers_models_as_printed():
    """EON paper, eq. 9 and 15, and EON itself, which keeps all energy."""
    sigma, r = 0.8, 0.6
    a, b = 1 - 0.5 * sigma**2 / (sigma**2 + 0.33), 0.45 * sigma**2 / (sigma**2 + 0.09)
    qon = exact_average_albedo(load_model("qon"), {"sigma": sigma, "albedo": 1.0})
    assert qon == pytest.approx(a + (2 / 3 - 64 / (45 * math.pi)) * b, abs=1e-14)
    a = 1 / (1 + (1 / 2 - 2 / (3 * math.pi)) * r)
    fon, eon = (exact_average_albedo(load_model(n), {"roughness": r, "albedo": 1.0}) for n in ("fon", "eon"))
    assert fon == pytest.approx(a * (1 + (2 / 3 - 28 / (15 * math.pi)) * r), abs=1e-14)
    assert eon == pytest.approx(1.0, abs=1e-14)


def test_average_albedos_from_device_values_are_the_closed_forms(probe):
    """The albedo that the shader declares, at 40 Gauss-Legendre views; 1e-6 leaves room for float32 (6e-8 each)."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    theta = math.pi / 4 * (nodes + 1)
    wo = np.array([view(cosine) for cosine in np.cos(theta)])
    for name, parameters in (("qon", {"sigma": 0.8, "albedo": 0.7}), ("fon", {"roughness": 0.6, "albedo": 0.7}),
                             ("eon", {"roughness": 0.6, "albedo": 0.7})):  # fmt: skip
        rounded = {key: float(np.float32(value)) for key, value in parameters.items()}
        albedo = probe(name, "cosine", wo, wi=wo, **parameters)["albedo"]
        average = math.pi / 4 * np.sum(weights * albedo * np.sin(2 * theta))
        assert average == pytest.approx(exact_average_albedo(load_model(name), rounded), abs=1e-6)


def test_the_tutorials_variant_ignores_azimuth():
    wo, wi, across = view(0.3), view(0.5), np.array([0.0, math.sqrt(0.75), 0.5])
    parameters = {"sigma": 0.5, "albedo": 1.0}
    model = load_model("oren-nayar-tutorial")
    assert model.brdf(wi, wo, parameters) == model.brdf(wi * [-1, 1, 1], wo, parameters)
    assert model.brdf(wi, wo, parameters) == pytest.approx(float(model.brdf(across, wo, parameters)), rel=1e-14)
