"""GGX and its samplers: identities of the masking, closed forms, and the code that MaterialX ships."""

import math
from importlib.resources import files

import numpy as np
import pytest
from scipy.integrate import dblquad

from service.catalogue import load_catalogue
from service.reference import cell_reference, ggx, load_model, load_technique
from service.reference.half_vector import half_vector
from service.reference.lobe_moments import integrate_lobes
from service.reference.moments import Pair
from tests.service.conftest import view

OWN = ("ggx-half-vector", "ggx-vndf", "ggx-vndf-caps", "ggx-vndf-bounded")
VISIBLE = OWN[1:]
ALPHAS = [(0.001, 0.001), (0.01, 0.5), (0.3, 0.3), (1.0, 1.0), (2.0, 0.7), (10.0, 10.0)]
ANGLES = (0.0, 45.0, 85.0, 89.9)  # degrees


def parameters(mx, my=None, f0=1.0):
    return {"f0": f0, "mx": mx, "my": mx if my is None else my}


def at(theta_deg, phi=0.4):
    return view(math.radians(theta_deg), phi)


def cell(technique, values, theta_deg, phi=0.0):
    return cell_reference("ggx", technique, values, math.radians(theta_deg), phi)


def smith(w, alpha):
    """Lambda as Heitz prints it (eq. 72, 80), from angles."""
    theta, phi = np.arccos(w[..., 2]), np.arctan2(w[..., 1], w[..., 0])
    along = (alpha[0] * np.cos(phi)) ** 2 + (alpha[1] * np.sin(phi)) ** 2
    return 0.5 * (np.sqrt(1.0 + along * np.tan(theta) ** 2) - 1.0)


def test_it_is_reciprocal_and_dark_below_the_horizon():
    wi, wo = np.random.default_rng(1).normal(size=(2, 2000, 3))
    wi, wo = (w / np.linalg.norm(w, axis=1)[:, None] for w in (wi, wo))
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    there, back = (load_model("ggx").brdf(a, b, parameters(0.1, 0.7, 0.2)) for a, b in ((wi, wo), (wo, wi)))
    np.testing.assert_allclose(there, back, rtol=1e-12)
    assert np.all(there[above] > 0)
    assert np.all(there[~above] == 0)


@pytest.mark.parametrize("theta", [0.0, 45.0, 80.0, 89.9])
def test_at_alpha_one_the_albedo_has_a_closed_form(theta):
    """D is 1/pi and f = 1/(2 pi (ci + co)) there: 1 - co log(1 + 1/co), which loses 69 % at the normal."""
    cosine = math.cos(math.radians(theta))
    for technique in (*OWN, "cosine", "uniform"):
        found = cell(technique, parameters(1.0), theta).albedo
        assert found == pytest.approx(1.0 - cosine * math.log1p(1.0 / cosine), rel=1e-8)


@pytest.mark.parametrize(("alpha", "theta", "phi"), [((0.5, 0.5), 60.0, 0.0), ((0.4, 0.8), 45.0, 0.7)])
def test_the_albedo_is_the_integral_of_the_printed_formula(alpha, theta, phi):
    wo = at(theta, phi)

    def reflected(turn, height):
        wi = view(math.acos(height), turn)
        h = (wi + wo) / np.linalg.norm(wi + wo)
        scaled = (h[0] / alpha[0]) ** 2 + (h[1] / alpha[1]) ** 2 + h[2] ** 2
        distribution = 1.0 / (math.pi * alpha[0] * alpha[1] * scaled**2)
        return distribution / (1.0 + smith(wi, alpha) + smith(wo, alpha)) / (4.0 * wo[2])

    expected, _ = dblquad(reflected, 0.0, 1.0, 0.0, 2.0 * math.pi, epsabs=1e-7)
    assert cell("ggx-vndf", parameters(*alpha), theta, phi).albedo == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("alpha", [0.3, 0.7, 1.0])
def test_the_white_furnace_loses_what_materialx_fitted(alpha):
    """MaterialX's rational fit of the directional albedo at F = 1: its coefficients, read from the package."""
    text = (files("MaterialX") / "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl").read_text()
    body = text[text.index("float x2 = mx_square(x);") : text.index("vec2 AB = clamp(r.xy / r.zw")]
    rows = [line.split("vec4(")[1].split(")") for line in body.splitlines() if "vec4(" in line]
    table = np.array([[float(number) for number in row[0].split(",")] for row in rows])
    for theta in (0.0, 45.0, 70.0):
        x, y = math.cos(math.radians(theta)), alpha
        a, b, c, d = table.T @ [1, x, y, x * y, x * x, y * y, x * x * y, x * y * y, x * x * y * y]
        assert cell("ggx-vndf", parameters(alpha), theta).albedo == pytest.approx(a / c + b / d, abs=0.02)


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("theta", ANGLES)
def test_no_view_reflects_more_than_all(alpha, theta):
    found = [cell(technique, parameters(*alpha), theta, 0.6) for technique in OWN]
    assert 0.0 < found[0].albedo <= 1.0
    for other in found[1:]:
        assert other.albedo == pytest.approx(found[0].albedo, rel=2e-8)


class Evenly:
    """A model whose weight under a technique is one: what it reflects is the share of directions above the horizon."""

    def __init__(self, technique):
        self.technique = technique
        self.kinks, self.half_vector_lobes = technique.kinks, technique.half_vector_lobes

    def brdf(self, wi, wo, values):
        return self.technique.density(wo, wi, values) / wi[..., 2]


@pytest.mark.parametrize("technique", OWN)
@pytest.mark.parametrize("alpha", ALPHAS)
def test_what_is_drawn_below_the_horizon_is_what_the_density_lacks_above(technique, alpha):
    """Two integrals that share no node. Of visible normals it is the identity that makes G1."""
    own = load_technique(technique)
    for theta in ANGLES:
        above, _ = integrate_lobes(Pair(Evenly(own), own, parameters(*alpha), at(theta)))
        assert above.mean + own.below_horizon(at(theta), parameters(*alpha)) == pytest.approx(1.0, abs=2e-8)


@pytest.mark.parametrize("technique", OWN)
@pytest.mark.parametrize("theta", ANGLES)
def test_the_density_is_one_over_the_jacobian_of_the_sampler(technique, theta):
    u, step, values = np.random.default_rng(7).uniform(0.05, 0.9, (2, 500)), 1e-5, parameters(0.5, 0.2)
    own, wo = load_technique(technique), at(theta)
    wi, pdf = own.sample(wo, *u, values)

    def slope(shift):
        ahead, behind = (own.sample(wo, u[0] + k * shift[0], u[1] + k * shift[1], values)[0] for k in (step, -step))
        return (ahead - behind) / (2 * step)

    area = np.linalg.norm(np.cross(slope((1, 0)), slope((0, 1))), axis=-1)
    # Central differences: truncation step^2 times a third derivative of order 1e4 in these lobes, rounding 1e-11.
    np.testing.assert_allclose(area * pdf, 1.0, rtol=3e-5)
    np.testing.assert_allclose(np.linalg.norm(wi, axis=-1), 1.0, rtol=1e-14)


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("theta", ANGLES)
def test_the_weight_of_visible_normals_is_g2_over_g1(alpha, theta):
    wo, values = at(theta), parameters(*alpha)
    wi, pdf = load_technique("ggx-vndf").sample(wo, *np.random.default_rng(2).random((2, 1000)), values)
    wi, pdf = wi[wi[:, 2] > 1e-6], pdf[wi[:, 2] > 1e-6]
    weight = load_model("ggx").brdf(wi, wo, values) * wi[:, 2] / pdf
    expected = (1.0 + smith(wo, alpha)) / (1.0 + smith(wi, alpha) + smith(wo, alpha))
    np.testing.assert_allclose(weight, expected, rtol=1e-9)
    assert np.all(weight <= 1.0 + 1e-12)


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("theta", ANGLES)
def test_the_largest_weight_of_visible_normals_is_one_and_that_of_bounded_ones_their_share(alpha, theta):
    """The normal direction of wi reaches both: nothing hides it."""
    share = (1.0 - float(ggx.spared(at(theta), alpha))) * math.cos(math.radians(theta))
    length = float(np.linalg.norm(at(theta) * [*alpha, 1.0]))
    for technique, expected in (
        ("ggx-vndf", 1.0),
        ("ggx-vndf-caps", 1.0),
        ("ggx-vndf-bounded", (length + share) / (length + math.cos(math.radians(theta)))),
    ):
        assert cell(technique, parameters(*alpha), theta, 0.4).max_weight == pytest.approx(expected, rel=1e-7)


def test_the_largest_weight_of_half_vectors_grows_like_one_over_alpha_and_the_view_cosine():
    """w = ci |wi + wo|^2/((ci + co)(|ai| co + |ao| ci)), a for stretched: next to grazing towards wo, 1/(alpha co)."""
    for alpha in (0.1, 0.5):
        top = cell("ggx-half-vector", parameters(alpha), 89.99).max_weight
        assert top == pytest.approx(1.0 / (alpha * math.cos(math.radians(89.99))), rel=0.01)


@pytest.mark.parametrize("same", [True, False])
def test_the_bounded_cap_holds_all_above_the_horizon_and_touches_it_where_alphas_are_equal(same):
    rng, closest = np.random.default_rng(4), math.inf
    for _ in range(20):
        alpha = tuple(np.exp(rng.uniform(np.log(0.01), np.log(1.0 if same else 10.0), 2)))
        alpha = alpha[:1] * 2 if same else alpha
        wo = view(np.arccos(rng.random(20_000)), turn := rng.uniform(0, 2 * np.pi, 20_000))
        wi = view(np.arccos(10.0 ** rng.uniform(-12, 0, 20_000)), np.where(rng.random(20_000) < 0.5, turn, turn[::-1]))
        h = half_vector(wi, wo)
        normal = np.stack([h.x / alpha[0], h.y / alpha[1], np.ones_like(h.x)], axis=-1)
        facing = np.sum(normal * ggx.stretched(wo, alpha), axis=-1) / np.sum(normal**2, axis=-1)
        over_rim = 2.0 * facing / (ggx.spared(wo, alpha) * ggx.stretched(wo, alpha)[:, 2])
        closest = min(closest, float(over_rim.min()))
    assert closest > 1.0 - 1e-9
    assert not same or closest < 1.0 + 1e-6


def test_at_alpha_one_bounded_normals_are_uniform_sampling():
    """The cap is the hemisphere there, and stretching changes nothing."""
    bounded, u = load_technique("ggx-vndf-bounded"), np.random.default_rng(5).random((2, 1000))
    wi, density = bounded.sample(at(50.0), *u, parameters(1.0))
    np.testing.assert_allclose(density, 0.5 / math.pi, rtol=1e-12)
    assert np.all(wi[:, 2] >= -1e-12)


@pytest.mark.parametrize("alpha", ALPHAS[:4])
def test_bounded_normals_have_less_variance_than_visible_ones_and_these_than_half_vectors(alpha):
    for theta in ANGLES[1:]:
        order = [cell(t, parameters(*alpha), theta, 0.3).variance for t in ("ggx-vndf-bounded", "ggx-vndf", OWN[0])]
        assert order[0] < order[1] < order[2]


@pytest.mark.parametrize("mx", [0.001, 10.0])
@pytest.mark.parametrize("my", [0.001, 0.3])
def test_extreme_alphas_stay_finite_and_right_on_the_device(compute, mx, my):
    scene = {"model": "ggx", "parameters": {"mx": mx, "my": my}, "phi_o_deg": 40, "techniques": list(VISIBLE)}
    for series in compute(**scene, theta_o_deg=[0, 85, 89.9], estimator={"samples": 2**16})["series"]:
        assert series["verdict"]["status"] in ("ok", "heavy-tail", "imprecise")
        off = np.abs(np.array(series["mean"]) - np.array(series["reference"]["mean"]))
        assert np.all(off < 5 * np.array(series["mean_stderr"]) + 1e-5)
        assert np.all(np.array(series["max_weight"]) <= np.array(series["reference"]["max_weight"]) * (1 + 2e-6))


def materialx_file():
    """What the MaterialX package ships for GGX, as a file that is both a model and a technique."""
    text = (files("MaterialX") / "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl").read_text()
    parts = text[text.index("float mx_ggx_NDF(") : text.index("// Rational quadratic fit")]
    return (
        '/*---\nprovides = ["model", "technique"]\nname = "materialx"\ntitle = "MaterialX"\n'
        'source = "the MaterialX package"\nmodels = ["materialx"]\nbelow_horizon = true\nanisotropic = true\n'
        + "".join(f"[parameters.{name}]\nmin = 0.001\nmax = 10.0\ndefault = 0.3\n" for name in ("mx", "my"))
        + "---*/\n#define M_PI PI\n#define mx_cos cos\n#define mx_sin sin\nfloat mx_square(float x) { return x * x; }\n"
        f"{parts}\n"
        "float brdf(vec3 wi, vec3 wo) {\n    vec3 h = normalize(wi + wo);\n"
        "    return mx_ggx_NDF(h, vec2(mx, my)) * mx_ggx_smith_G2(wi.z, wo.z, mx) / (4.0 * wi.z * wo.z);\n}\n"
        "float direction_pdf(vec3 wo, vec3 wi) {\n"
        "    float g1 = mx_ggx_smith_G1(wo.z, mx);\n"
        "    return mx_ggx_VNDF_reflection_PDF(normalize(wi + wo), vec2(mx, my), g1, wo.z);\n}\n"
        "DirectionSample sample_direction(vec3 wo, vec2 u) {\n"
        "    vec3 h = mx_ggx_importance_sample_VNDF(u.yx, wo, vec2(mx, my));\n"
        "    vec3 wi = 2.0 * dot(wo, h) * h - wo;\n    return DirectionSample(wi, direction_pdf(wo, wi));\n}\n"
    )


@pytest.fixture
def materialx(tmp_path):
    path = tmp_path / "materialx.glsl"
    path.write_text(materialx_file())
    return load_catalogue().with_file(path)


@pytest.mark.parametrize("alpha", [0.1, 0.5, 1.0])
def test_values_and_densities_are_those_that_materialx_ships(probe, materialx, alpha):
    """Its masking takes one alpha. Cosines above 0.1; below, and for narrower lobes, its differences lose digits."""
    rng = np.random.default_rng(9)
    wi, wo = (view(np.arccos(rng.uniform(0.1, 1, 4096)), rng.uniform(0, 6, 4096)).astype(np.float32) for _ in "io")
    other = probe("materialx", "materialx", wo, wi=wi, catalogue=materialx, mx=alpha, my=alpha)
    for technique in ("ggx-vndf", "ggx-vndf-caps"):
        ours = probe("ggx", technique, wo, wi=wi, mx=alpha, my=alpha)
        assert ours["brdf"] == pytest.approx(other["brdf"], rel=2e-5)
        assert ours["direction_pdf"] == pytest.approx(other["direction_pdf"], rel=2e-5)


def test_caps_draw_the_directions_that_materialx_draws(probe, materialx):
    """Where wo lies in the x-z plane both count the azimuth of the cap from it."""
    u = np.random.default_rng(10).random((4096, 2)).astype(np.float32) * 0.99
    wo = view(np.radians(np.linspace(0.0, 85.0, 4096))).astype(np.float32)
    other = probe("materialx", "materialx", wo, u=u, catalogue=materialx, mx=0.2, my=0.5)
    ours = probe("ggx", "ggx-vndf-caps", wo, u=u, mx=0.2, my=0.5)
    assert np.abs(ours["wi"] - other["wi"]).max() < 2e-4
    assert np.quantile(np.abs(ours["wi"] - other["wi"]), 0.99) < 3e-6
