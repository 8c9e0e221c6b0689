"""The float64 truth of a file from itself, against the truth from the formulas, which shares no code with it."""

import math
from pathlib import Path

import numpy as np
import pytest

from service.device_reference import device_reference
from service.reference import cells_reference
from service.sampling import IncompleteRun
from service.scene import parse_scene, resolve

BROKEN = Path(__file__).parents[2] / "broken"
SHADERS = Path(__file__).parents[3] / "shaders"
ANGLES = [0.0, 20.0, 45.0, 70.0, 85.0, 89.5]
PAIRS = [
    ("eon", "cosine", {"roughness": 1.0}),
    ("eon", "cltc-mis", {"roughness": 0.3, "albedo": 0.6}),
    ("fon", "uniform", {"roughness": 0.6}),
    ("kurt", "beckmann-half-vector", {"mx": 0.1, "my": 0.4}),
    ("ashikhmin-shirley", "ashikhmin-shirley", {"nu": 1000.0, "nv": 50.0}),
    ("blinn-phong", "uniform", {"n": 200.0}),
]


def both(engine, model, technique, parameters, angles=ANGLES):
    """Device and formulas: a dict of columns each."""
    azimuth = {"phi_o_deg": 25.0} if engine.catalogue.model(model).head.anisotropic else {}
    scene = {"model": model, "techniques": [technique], "parameters": parameters, "theta_o_deg": angles, **azimuth}
    (plan,) = resolve(parse_scene(scene), engine.catalogue).series
    theta_o, phi_o = [math.radians(angle) for angle in angles], math.radians(plan.azimuth_deg)
    found = device_reference(plan, engine, angles)
    exact = cells_reference(model, technique, plan.parameters, theta_o, phi_o)
    return tuple(
        {name: np.array([getattr(c, name) for c in cells]) for name in vars(exact[0])} for cells in (found, exact)
    )


@pytest.mark.parametrize(("model", "technique", "parameters"), PAIRS, ids=[f"{m}-{t}" for m, t, _ in PAIRS])
def test_no_value_is_further_from_the_formulas_than_it_says(engine, model, technique, parameters):
    """1e-9 is room for the formulas' own error. Of six angles one may be open, next to grazing."""
    found, exact = both(engine, model, technique, parameters)
    for name in ("mean", "albedo", "variance"):
        known = np.isfinite(found[name])
        off = np.abs(found[name] - exact[name])
        assert known.sum() >= len(ANGLES) - 1, name
        assert np.all(off[known] <= found[f"{name}_uncertainty"][known] + 1e-9 * (1.0 + exact[name][known])), name
        assert np.all(found[f"{name}_uncertainty"][known] <= 1e-2 * np.maximum(exact[name][known], 1e-9))
    fourth = np.isfinite(found["fourth_moment"])
    # Where two resolutions agree to a hundredth it is given; it decides on tails, nothing finer.
    assert np.allclose(found["fourth_moment"][fourth], exact["fourth_moment"][fourth], rtol=3e-2, atol=1e-9)


def test_the_supremum_of_a_bounded_weight_is_found(engine):
    for technique, parameters in (("cosine", {"roughness": 0.8}), ("uniform", {"roughness": 0.8}), ("cltc-mis", {})):
        found, exact = both(engine, "eon", technique, parameters)
        # A search from the highest nodes: it may end on a lower hill, by less than a hundredth here.
        assert np.all(found["max_weight"] <= exact["max_weight"] * (1 + 1e-9))
        assert np.all(found["max_weight"] >= exact["max_weight"] * 0.99)


@pytest.mark.parametrize("technique", ["ltc", "cltc"])
def test_infinite_variances_unbounded_weights_and_lost_light_are_found(engine, technique):
    found, exact = both(engine, "eon", technique, {}, [30.0, 60.0, 80.0])
    assert np.all(np.isinf(found["max_weight"]))
    # What neither the quadrature nor the tail decides is open, never finite.
    assert not np.isfinite(found["variance"]).any()
    assert np.isinf(found["variance"]).sum() >= 2
    known = np.isfinite(found["uncovered"])
    assert known.sum() >= 2
    assert np.allclose(found["uncovered"][known], exact["uncovered"][known], rtol=1e-2, atol=1e-6)


def test_a_truth_that_cannot_be_reached_is_not_given(compute, own_file):
    """Spikes at every hundredth of a degree: no rule resolves them, and no finding comes of it."""
    spikes = "return 10.0 * pow(abs(sin(3e4 * wi.x) * sin(2e4 * wi.y)), 400.0);"
    catalogue = own_file(f"float brdf(vec3 wi, vec3 wo) {{ {spikes} }}\n", "model", "spikes")
    (series,) = compute(
        catalogue=catalogue, model="spikes", techniques="cosine", theta_o_deg=[40], estimator={"samples": 65536}
    )["series"]
    assert series["reference"]["variance"] == [None]
    assert series["reference"]["variance_uncertainty"] == [None]
    assert series["variance_stderr"] != [None]
    assert "infinite-variance" not in {finding["name"] for finding in series["verdict"]["findings"]}


def test_a_wrong_density_is_named_biased_without_sampling_noise(compute, engine):
    """A density off by a factor: mean weight and albedo differ in the truth itself, at any count of samples."""
    catalogue = engine.catalogue.with_file(BROKEN / "pdf-factor.glsl")
    (name,) = (entry.name for entry in catalogue.techniques.values() if entry.own)
    (series,) = compute(
        catalogue=catalogue, model="lambert", techniques=name, theta_o_deg=[10, 60], estimator={"samples": 256}
    )["series"]
    biased = next(finding for finding in series["verdict"]["findings"] if finding["name"] == "biased")
    assert biased["evidence"]["theta_o_deg"] == [10, 60]
    mean, albedo = np.array(series["reference"]["mean"]), np.array(series["reference"]["albedo"])
    assert np.allclose(biased["evidence"]["bias"], mean - albedo)
    assert np.allclose(albedo, 1.0, rtol=0, atol=1e-4)


def test_a_catalogue_entry_as_a_users_file_keeps_its_verdict(compute, engine, tmp_path):
    """`ltc` read as a file of its own has no formulas; what is wrong with it is found all the same."""
    path = tmp_path / "ltc.glsl"
    path.write_text((SHADERS / "techniques" / "ltc.glsl").read_text())
    scene = {"techniques": "ltc", "theta_o_deg": [45, 75], "estimator": {"samples": 65536}}
    (known,), (own,) = (compute(catalogue=at, **scene)["series"] for at in (None, engine.catalogue.with_file(path)))
    names = [{finding["name"] for finding in series["verdict"]["findings"]} for series in (known, own)]
    assert {"infinite-variance", "unbounded-weight", "uncovered"} <= names[0] & names[1]
    assert own["reference"]["mean"] == pytest.approx(known["reference"]["mean"], rel=1e-3)


def test_a_reference_is_left_out_on_request_and_without_a_double_form(compute, own_file):
    """`mediump` code is fine; a function that only floats have (packing) is not, and then there is no truth."""
    plain = own_file("float brdf(vec3 wi, vec3 wo) { return INV_PI; }\n", "model", "plain")
    packed = "return unpackHalf2x16(packHalf2x16(vec2(INV_PI))).x;"
    without = own_file(f"float brdf(vec3 wi, vec3 wo) {{ {packed} }}\n", "model", "packed")
    scene = {"techniques": "cosine", "theta_o_deg": [30], "estimator": {"samples": 4096}}
    (one,) = compute(catalogue=plain, model="plain", reference=False, **scene)["series"]
    (other,) = compute(catalogue=without, model="packed", **scene)["series"]
    assert one["reference"] is None
    assert other["reference"] is None
    assert other["mean"] == pytest.approx([1.0], abs=1e-3)


@pytest.fixture
def own_file(engine, tmp_path):
    def write(code, role, name):
        path = tmp_path / f"{name}.glsl"
        path.write_text(f'/*---\nprovides = ["{role}"]\nname = "{name}"\ntitle = "Own"\nsource = "own"\n---*/\n{code}')
        return engine.catalogue.with_file(path)

    return write


def test_a_loop_at_the_limit_is_an_error_of_the_quadrature_too(compute, own_file):
    loop = "float x = 0.0; for (int i = 0; i < 70000; i++) x += wi.z; return x * 1e-5;"
    catalogue = own_file(f"float brdf(vec3 wi, vec3 wo) {{ {loop} }}\n", "model", "endless")
    with pytest.raises(IncompleteRun, match="limit of 65,535"):
        compute(
            catalogue=catalogue, model="endless", techniques="cosine", theta_o_deg=[30], reference=False,
            estimator={"method": "quadrature"},
        )  # fmt: skip
