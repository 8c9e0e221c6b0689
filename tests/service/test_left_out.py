"""What a shader leaves out: by which rules, and without a change of a single bit."""

from itertools import combinations

import pytest

from service.catalogue import load_catalogue
from service.convergence import compute_convergence, parse_convergence_scene
from service.engine import BUFFERS, PUSH_CONSTANT_BYTES, Engine
from service.estimators.sampled import SeriesRun, monte_carlo
from service.explain.shaders import groups_of, shader_without
from service.left_out import Feature, features_left_out, structure_without
from service.sampling import Sampler
from service.scene import parse_scene, resolve
from service.statistics import compute_statistics, series_cells
from service.structure import Fixed, Structure

ANGLES = [0.0, 45.0, 80.0, 89.91]
SAMPLES = 20_000
NARROWEST = {
    "model": "eon",
    "parameters": {"roughness": 0.0, "albedo": 1.0},
    "techniques": ["cosine", "cltc-mis"],
    "theta_o_deg": ANGLES,
    "statistics": ["mean"],
    "error_bars": False,
}
"""A scene whose shaders leave out every kind of thing that can be left out."""


def asked(**scene):
    return resolve(parse_scene({"theta_o_deg": ANGLES, **scene}), load_catalogue())


def left_out_of(**scene):
    question = asked(**scene)
    return {feature.name: feature.reason for feature in features_left_out(question.series[0], question.scene)}


def bits(engine, question, plan, features):
    """What the shader without these features gives, as bytes, for all that it still computes."""
    shader = shader_without(engine, question, plan, features)
    pipeline = engine.device.pipeline(
        shader.spirv,
        buffers=BUFFERS["statistics"],
        push_constant_bytes=PUSH_CONSTANT_BYTES["statistics"],
        specialization=shader.constants,
    )
    with Sampler(engine.device, pipeline, shader.cells) as sampler:
        sums = sampler.run(SAMPLES)
    pipeline.close()
    structure = structure_without(features)
    kept = {
        "largest": structure.largest,
        "zero": structure.zeros,
        "first_bad": structure.first_bad,
        **dict.fromkeys(("drawn", "nonfinite", "negative", "shift"), True),
    }
    found = {name: getattr(sums, name).tobytes() for name, is_kept in kept.items() if is_kept}
    return found | {f"power {k + 1}": sums.powers[k].tobytes() for k in range(structure.moments)}


def common(one, other):
    """Both results, cut to the names that both have."""
    names = one.keys() & other.keys()
    return {name: one[name] for name in names}, {name: other[name] for name in names}


def test_every_feature_alone_and_every_pair_keeps_the_bits(engine):
    question = asked(**NARROWEST)
    plan = question.series[1]
    features = features_left_out(plan, question.scene)
    assert len(features) == 11
    full = bits(engine, question, plan, ())
    for some in [*combinations(features, 1), *combinations(features, 2), features]:
        one, other = common(full, bits(engine, question, plan, some))
        assert one == other, [feature.name for feature in some]


def declared_features():
    """(model, technique, values) at which a head of the catalogue says that something drops out."""
    catalogue = load_catalogue()
    for model in catalogue.models.values():
        technique = catalogue.techniques_for(model.name)[0]
        for values in model.head.left_out.values():
            yield model.name, technique, values
    for technique in catalogue.techniques.values():
        for values in technique.head.left_out.values():
            yield technique.head.models[0], technique.name, values


@pytest.mark.parametrize(("model", "technique", "values"), list(declared_features()))
def test_what_a_head_declares_keeps_the_bits_alone_and_with_all_the_rest(engine, model, technique, values):
    not_black = dict.fromkeys(load_catalogue().model(model).head.black, 0.5)
    question = asked(model=model, techniques=technique, parameters=not_black | values)
    plan = question.series[0]
    features = features_left_out(plan, question.scene)
    alone = [f for f in features if f.changes.get("fixed") and {x.name for x in f.changes["fixed"]} == set(values)]
    assert alone
    full = bits(engine, question, plan, ())
    for some in [*([feature] for feature in alone), features]:
        one, other = common(full, bits(engine, question, plan, some))
        assert one == other, [feature.name for feature in some]


def test_a_wrong_declaration_would_change_bits(engine):
    """The two tests above can fail: a parameter that is fixed at a value it does not have shows."""
    question = asked(model="eon", techniques="cosine", parameters={"roughness": 0.5})
    plan = question.series[0]
    wrong = Feature("multiple-scattering lobe", "", {"fixed": frozenset({Fixed("model", "roughness", 0.0)})})
    assert bits(engine, question, plan, [wrong])["power 1"] != bits(engine, question, plan, [])["power 1"]


def test_what_was_not_asked_is_left_out_by_name(compute):
    result = compute(techniques="cosine", theta_o_deg=[0], statistics="mean", estimator={"samples": 100})
    unasked = {"third and fourth powers of the weight", "largest weight", "count of zero weights"}
    assert unasked <= {entry["feature"] for entry in result["left_out"]}
    assert all(entry["reason"] and entry["series"] == [0] for entry in result["left_out"])
    assert "zero_fraction" not in result["series"][0]


def test_a_scene_that_asks_for_everything_keeps_what_it_needs():
    everything = left_out_of(model="kurt", techniques="half-vector-cosine", parameters={"kd": 0.2, "f0": 0.5})
    assert set(everything) == {"index of the first non-finite sample", "terms of the view in every sample"}


@pytest.mark.parametrize(
    ("scene", "name"),
    [
        ({"statistics": "max_weight"}, "powers of the weight"),
        ({"statistics": "mean"}, "third and fourth powers of the weight"),
        ({"statistics": "mean", "error_bars": False}, "powers of the weight above the first"),
        ({"statistics": "variance", "error_bars": False}, "third and fourth powers of the weight"),
    ],
)
def test_powers_that_no_statistic_needs_are_left_out(scene, name):
    assert name in left_out_of(model="eon", techniques="cosine", **scene)


def test_features_follow_model_technique_and_values():
    narrow = left_out_of(model="eon", techniques="cltc-mis", parameters={"roughness": 0.0, "albedo": 1.0})
    assert narrow["multiple-scattering lobe"] == narrow["uniform lobe"] == "roughness is 0"
    assert narrow["albedo factor"] == "albedo is 1"
    assert {"azimuth of the view", "test for the horizon", "terms of the view in every sample"} <= set(narrow)
    wide = left_out_of(model="eon", techniques="ltc", parameters={"roughness": 1e-30, "albedo": 0.5})
    assert not {"multiple-scattering lobe", "linear transformation", "albedo factor", "test for the horizon"} & set(
        wide
    )
    assert "azimuth of the view" not in left_out_of(model="ward", techniques="cosine")
    assert "the other techniques" in left_out_of(model="eon", techniques=["cosine", "uniform"])


def test_a_quadrature_leaves_out_structure_only():
    question = asked(**NARROWEST)
    names = {feature.name for feature in features_left_out(question.series[0], question.scene, "quadrature")}
    assert names == {"azimuth of the view", "test for the horizon", "multiple-scattering lobe", "albedo factor"}


def test_a_sweep_compiles_once_for_all_values_without_structure():
    question = asked(model="eon", techniques="cosine", parameters={"roughness": [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]})
    assert [group.series for group in groups_of(question)] == [[0], [1, 2, 3, 4, 5]]


@pytest.mark.parametrize("statistics", [["mean"], ["mean", "variance", "max_weight"]])
def test_a_black_model_is_answered_without_the_device_as_the_shader_would(engine, monkeypatch, statistics):
    question = asked(model="eon", techniques="ltc", parameters={"albedo": 0.0}, statistics=statistics)
    plan, scene = question.series[0], question.scene
    estimator = scene.estimator.model_copy(update={"samples": SAMPLES})
    drawn = monte_carlo(SeriesRun(plan, engine, series_cells(plan, scene), Structure()), estimator)
    monkeypatch.setattr(Engine, "pipeline", lambda *_, **__: pytest.fail("a shader was built"))
    result = compute_statistics(question, engine)
    (series,) = result["series"]
    assert [entry["feature"] for entry in result["left_out"]] == ["every sample"]
    assert series["mean"] == drawn.statistics.mean.tolist() == [0.0] * 4
    assert series["mean_stderr"] == drawn.statistics.mean_stderr.tolist()
    assert series["verdict"]["status"] == "ok"
    if "variance" in statistics:
        assert series["variance"] == drawn.statistics.variance.tolist()
        assert series["max_weight"] == drawn.largest.tolist()
        assert series["zero_fraction"] == drawn.zero_fraction.tolist()


@pytest.mark.parametrize("method", ["qmc", "quadrature"])
def test_a_black_model_is_black_for_every_estimator(compute, method):
    (series,) = compute(techniques="cosine", parameters={"albedo": 0.0}, estimator={"method": method})["series"]
    assert set(series["mean"]) == set(series["variance"]) == {0.0}
    assert series["estimator"]["method"] == method


OWN = """/*---
provides = ["model"]
name = "lambert"
title = "Right but at roughness 0"
source = "own"
black = { roughness = 0.0 }
[left_out]
"lobe" = { roughness = 0.0 }
[parameters.roughness]
min = 0.0
max = 1.0
default = 0.0
---*/
float brdf(vec3 wi, vec3 wo) { return wi.z > 0.0 ? INV_PI * (1.0 + roughness / (roughness * roughness)) : 0.0; }
"""


def test_a_users_own_file_is_not_believed(engine, tmp_path):
    """A compiler that knows the roughness folds 0/0 to some number; a renderer would meet the NaN."""
    path = tmp_path / "lambert.glsl"
    path.write_text(OWN)
    catalogue = load_catalogue().with_file(path)
    scene = parse_scene({"model": "lambert", "techniques": ["cosine"], "estimator": {"samples": 1000}})
    question = resolve(scene, catalogue)
    names = {feature.name for feature in features_left_out(question.series[0], question.scene)}
    assert names == {"index of the first non-finite sample", "terms of the view in every sample"}
    (series,) = compute_statistics(question, Engine(engine.device, catalogue, engine.cache))["series"]
    assert series["verdict"]["status"] == "nonfinite"
    assert min(series["nonfinite"]) > 0


def test_an_error_curve_names_what_it_leaves_out(engine):
    scene = {"model": "lambert", "techniques": ["uniform"], "theta_o_deg": [45], "estimator": {"samples": 64}}
    result = compute_convergence(resolve(parse_convergence_scene(scene), engine.catalogue), engine)
    named = {entry["feature"]: entry["series"] for entry in result["left_out"]}
    assert named["largest weight"] == named["third and fourth powers of the weight"] == [0, 1]
    assert named["azimuth of the view"] == named["albedo factor"] == [0, 1, 2]
    assert [one["estimator"] for one in result["series"]] == ["mc", "qmc", "quadrature"]
