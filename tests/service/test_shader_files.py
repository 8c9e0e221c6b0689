"""The GLSL of EON and its samplers against the float64 reference and against an independent implementation.

Inputs are rounded to float32 first, so that both sides see the same numbers: what differs is rounding in the shader.
"""

from importlib.resources import files
from itertools import product

import numpy as np
import pytest

from service.catalogue import load_catalogue
from service.reference import load_model, load_technique
from tests.service.conftest import view

MODELS = ["eon", "eon-approx", "fon", "lambert"]
TECHNIQUES = ["cltc", "cltc-mis", "cosine", "ltc", "ltc-nonnegative", "uniform"]
FITTED = ["ltc-nonnegative", "ltc", "cltc", "cltc-mis"]
GRAZING = np.array([1.0, 1 - 2.0**-24, 0.9999, 0.7, 0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])


def directions(count, seed, graze=False):
    """Unit vectors above the horizon, float32; with `graze` their cosines are spread over decades."""
    rng = np.random.default_rng(seed)
    mu = 10.0 ** rng.uniform(-6, 0, count) if graze else rng.uniform(0, 1, count)
    return view(np.arccos(mu), rng.uniform(0, 2 * np.pi, count)).astype(np.float32)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("graze", [False, True])
def test_brdf_equals_the_reference(probe, model, graze):
    """Within 1e-6, about 8 float32 roundings, and a rounding of s.

    s is a sum of two products that cancel where the azimuths are a quarter turn apart. Its rounding, 1e-7, is divided
    by t = max(cos, cos), and is absolute.
    """
    wi, wo = directions(4096, 1, graze), directions(4096, 2, graze)
    for roughness, albedo in product([0.0, 0.05, 0.5, 1.0], [1.0, 0.3, 0.0]):
        found = probe(model, "uniform", wo, wi=wi, roughness=roughness, albedo=albedo)["brdf"]
        parameters = {"roughness": float(np.float32(roughness)), "albedo": float(np.float32(albedo))}
        expected = load_model(model).brdf(wi.astype(float), wo.astype(float), parameters)
        scale = 1 / np.maximum(wi[:, 2], wo[:, 2])
        assert np.all(np.abs(found - expected) <= 1e-6 * np.abs(expected) + 1e-7 * albedo * scale)


@pytest.mark.parametrize("model", MODELS)
def test_directional_albedo_equals_the_reference_down_to_grazing(probe, model):
    wo = view(np.arccos(GRAZING)).astype(np.float32)
    for roughness, albedo in product([0.0, 0.2, 1.0], [1.0, 0.4]):
        found = probe(model, "uniform", wo, wi=wo, roughness=roughness, albedo=albedo)["albedo"]
        parameters = {"roughness": float(np.float32(roughness)), "albedo": float(np.float32(albedo))}
        expected = load_model(model).directional_albedo(wo[:, 2].astype(float), parameters)
        assert found == pytest.approx(expected, rel=5e-7)


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("roughness", [0.0, 0.05, 0.5, 1.0])
def test_density_of_any_direction_equals_the_reference(probe, technique, roughness):
    """Close to the edge of the lobe the density is a difference of two terms of order one: 2e-6 is absolute there."""
    wi, wo = directions(4096, 3), directions(4096, 4)
    found = probe("eon", technique, wo, wi=wi, roughness=roughness)["direction_pdf"]
    expected = load_technique(technique).density(
        wo.astype(float), wi.astype(float), {"roughness": float(np.float32(roughness))}
    )
    assert np.all(np.abs(found - expected) <= 3e-6 * expected + 2e-6)


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("roughness", [0.0, 0.05, 1.0])
def test_the_density_that_comes_with_a_sample_is_that_of_its_direction(probe, technique, roughness):
    wo = directions(4096, 5)
    u = np.random.default_rng(6).random((4096, 2)).astype(np.float32)
    s = probe("eon", technique, wo, u=u, roughness=roughness)
    assert np.all(np.abs(s["pdf"] - s["direction_pdf"]) <= 1e-5 * s["pdf"] + 5e-6)
    assert np.linalg.norm(s["wi"].astype(float), axis=1) == pytest.approx(np.ones(4096), abs=3e-7)
    if not load_catalogue().techniques[technique].head.below_horizon:
        assert np.all(s["wi"][:, 2] >= 0)


@pytest.mark.parametrize("technique", FITTED)
def test_the_density_belongs_to_the_view_and_not_to_the_drawn_direction(probe, technique):
    """Swapping view and drawn direction, as published code does in one place, gives another density."""
    high, low = view(0.2).astype(np.float32), view(1.3, 0.4).astype(np.float32)
    one = probe("eon", technique, high[None], wi=low[None])["direction_pdf"][0]
    other = probe("eon", technique, low[None], wi=high[None])["direction_pdf"][0]
    expected = load_technique(technique).density(high.astype(float), low.astype(float), {"roughness": 1.0})
    assert one == pytest.approx(float(expected), rel=1e-5)
    assert abs(one - other) > 0.02


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_turning_the_view_about_the_normal_turns_the_sample(probe, technique):
    u = np.random.default_rng(7).random((256, 2)).astype(np.float32)
    straight = probe("eon", technique, view(np.full(256, 0.9)), u=u)
    turned = probe("eon", technique, view(np.full(256, 0.9), 2.0), u=u)
    assert turned["pdf"] == pytest.approx(straight["pdf"], rel=1e-5, abs=1e-6)
    if technique in FITTED:
        c, s = np.cos(2.0), np.sin(2.0)
        x, y, z = straight["wi"].T.astype(float)
        expected = np.stack([c * x - s * y, s * x + c * y, z], axis=1)
        assert np.abs(turned["wi"] - expected).max() < 1e-6


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("technique", TECHNIQUES)
def test_every_value_is_finite_at_the_ends_of_the_ranges(probe, model, technique):
    ends = [0.0, 2.0**-24, 0.5, 1 - 2.0**-24]
    u = np.array([pair for pair in product(ends, ends) for _ in GRAZING], np.float32)
    mu = np.tile(np.append(GRAZING[:-1], 0.0), len(ends) ** 2)
    wo = np.stack([np.sqrt(1 - mu**2), 0 * mu, mu], axis=1)
    for roughness, albedo in product([0.0, 1e-38, 1e-6, 1.0], [0.0, 1.0]):
        for values in probe(model, technique, wo, u=u, roughness=roughness, albedo=albedo).values():
            assert np.all(np.isfinite(values))


def test_the_lobe_is_clipped_on_the_side_that_its_shear_asks_for(probe):
    """d is positive closer to the normal than 0.7755 degrees and negative beyond: every direction stays above."""
    u = np.random.default_rng(8).random((4096, 2)).astype(np.float32)
    for theta_o in (0.0, 0.003, 0.0135, 0.2):
        s = probe("eon", "cltc", np.repeat(view([theta_o]), 4096, axis=0), u=u)
        assert s["wi"][:, 2].min() >= 0
        assert np.mean(s["weight"] == 0) < 1e-3
        assert np.all(s["direction_pdf"][s["pdf"] > 1e-5] > 0)


def materialx_model():
    """The energy-compensated Oren-Nayar function of the MaterialX package, as a model file."""
    library = files("MaterialX") / "libraries"
    text = (library / "pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl").read_text()
    begin = text.index("float mx_oren_nayar_fujii_diffuse_dir_albedo")
    end = text.index("vec3 mx_oren_nayar_compensated_diffuse_dir_albedo")
    constants = "".join(line + "\n" for line in text.splitlines() if line.startswith("const float FUJII"))
    return (
        '/*---\nprovides = ["model"]\nname = "materialx"\ntitle = "MaterialX"\nsource = "the MaterialX package"\n'
        "[parameters.roughness]\nmin = 0.0\nmax = 1.0\ndefault = 1.0\n"
        "[parameters.albedo]\nmin = 0.0\nmax = 1.0\ndefault = 1.0\n---*/\n"
        '#include "common/arc.glsl"\n#define M_FLOAT_EPS 1e-8\n#define M_PI PI\n#define M_PI_INV INV_PI\n'
        "float mx_square(float x) { return x * x; }\nvec3 mx_square(vec3 x) { return x * x; }\n"
        "float mx_acos(float x) { return quadrant_angle(sqrt((1.0 - x) * (1.0 + x)), x); }\n"
        f"{constants}{text[begin:end]}\n"
        "float brdf(vec3 wi, vec3 wo) {\n"
        "    vec3 f = mx_oren_nayar_compensated_diffuse(wo.z, wi.z, dot(wi, wo), roughness, vec3(albedo));\n"
        "    return f.x * INV_PI;\n}\n"
    )


def test_eon_equals_the_function_that_materialx_ships(probe, tmp_path):
    """Cosines above 0.1: below, the printed form that MaterialX uses loses digits (1e-5 at 0.1, 8 % at 0.001)."""
    path = tmp_path / "materialx.glsl"
    path.write_text(materialx_model())
    catalogue = load_catalogue().with_file(path)
    wi, wo = (w[w[:, 2] > 0.1][:2048] for w in (directions(4096, 9), directions(4096, 10)))
    for roughness, albedo in product([0.1, 0.5, 1.0], [1.0, 0.5]):
        other = probe("materialx", "uniform", wo, wi=wi, catalogue=catalogue, roughness=roughness, albedo=albedo)
        ours = probe("eon", "uniform", wo, wi=wi, roughness=roughness, albedo=albedo)
        assert ours["brdf"] == pytest.approx(other["brdf"], rel=2e-5)
