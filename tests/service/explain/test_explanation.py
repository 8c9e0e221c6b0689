"""What `explain` says: the contract of its result, and that its numbers are of the shaders it names."""

import json
import math

import numpy as np
import pytest

from service import formats
from service.errors import BadInput
from service.explain import compute_explanation, draws, parse_explain_scene
from service.explain.shaders import shader_without, size_of, whole_shader
from service.explain.timing import LAUNCH_SAMPLES, spread
from service.left_out import features_left_out
from service.scene import resolve
from service.statistics import compute_statistics

FIGURES = {"module_bytes", "spirv_bytes", "instructions", "compile_ms", "ns_per_sample"}
SCENE = {
    "model": "eon",
    "parameters": {"roughness": [0.0, 0.5, 1.0]},
    "techniques": ["cosine"],
    "theta_o_deg": [0, 60],
    "statistics": ["mean"],
}


@pytest.fixture(scope="module")
def explained(session_engine):
    """The explanation of SCENE in three rounds, and what it was told of its progress."""
    told = []
    question = resolve(parse_explain_scene(SCENE), session_engine.catalogue)
    result = compute_explanation(question, session_engine, lambda *what: told.append(what), rounds=3)
    return question, result, told


def test_the_result_has_the_form_of_the_contract(explained):
    _, result, _ = explained
    assert result["kind"] == "explain"
    assert set(result["variant"]) == set(result["full"]) == FIGURES
    for one in (result["variant"], result["full"], *(s[k] for s in result["shaders"] for k in ("variant", "full"))):
        assert all(math.isfinite(one[name]) and one[name] > 0 for name in FIGURES)
    for entry in result["left_out"]:
        assert set(entry) == {"feature", "reason", "series", "saves"}
        assert set(entry["saves"]) == {"ns_per_sample", "instructions"}
    run = result["run"]
    assert (run["rounds"], run["clock"], run["samples_per_round"]) == (3, "processor", LAUNCH_SAMPLES)
    assert json.loads(formats.encode(result, "json")) == json.loads(json.dumps(result))


def test_series_with_one_shader_are_measured_once(explained):
    _, result, told = explained
    assert [shader["series"] for shader in result["shaders"]] == [[0], [1, 2]]
    assert len(result["series"]) == 3
    features = sum(len(shader["left_out"]) for shader in result["shaders"])
    assert told[-1][1:] == ((features + 4) * 3 * LAUNCH_SAMPLES,) * 2


def test_what_is_left_out_is_what_the_statistics_say(explained, engine):
    question, result, _ = explained
    scene = question.scene.model_copy(
        update={"estimator": question.scene.estimator.model_copy(update={"samples": 100}), "reference": False}
    )
    stats = compute_statistics(resolve(scene, engine.catalogue), engine)
    assert [{k: entry[k] for k in ("feature", "reason", "series")} for entry in result["left_out"]] == stats["left_out"]


def test_each_feature_makes_its_shader_smaller_and_the_variant_is_the_smallest(explained, engine):
    question, result, _ = explained
    smooth = result["shaders"][0]
    assert smooth["variant"]["instructions"] < 0.75 * smooth["full"]["instructions"]
    assert all(entry["saves"]["instructions"] >= 0 for entry in smooth["left_out"])
    plan = question.series[0]
    (lobe,) = (f for f in features_left_out(plan, question.scene) if f.name == "multiple-scattering lobe")
    full, less = (
        size_of(engine, shader).instructions
        for shader in (whole_shader(engine, question, plan), shader_without(engine, question, plan, [lobe]))
    )
    (entry,) = (entry for entry in smooth["left_out"] if entry["feature"] == lobe.name)
    assert entry["saves"]["instructions"] == full - less > 0


def test_averages_are_over_series(explained):
    _, result, _ = explained
    one, other = (shader["variant"]["ns_per_sample"] for shader in result["shaders"])
    assert result["variant"]["ns_per_sample"] == pytest.approx((one + 2 * other) / 3)


def test_the_full_shader_holds_every_technique_of_the_scene(engine):
    scene = parse_explain_scene({**SCENE, "techniques": ["cosine", "uniform", "cltc-mis"]})
    question = resolve(scene, engine.catalogue)
    whole = whole_shader(engine, question, question.series[0])
    assert whole.name == "eon+cosine+uniform+cltc-mis.statistics"
    assert [whole_shader(engine, question, plan).constants[10] for plan in question.series[::3]] == [0, 1, 2]
    assert len({whole_shader(engine, question, plan).spirv for plan in question.series}) == 1


def test_text_and_rows_name_every_feature(explained):
    _, result, _ = explained
    text = formats.encode(result, "table").decode()
    rows = formats.encode(result, "csv").decode().splitlines()
    assert len(rows) == 1 + sum(len(shader["left_out"]) for shader in result["shaders"])
    for entry in result["left_out"]:
        assert entry["feature"] in text
        assert any(entry["feature"] in row for row in rows)
    assert "times as fast" in text
    assert max(map(len, text.splitlines())) <= 120


def test_a_black_scene_has_a_variant_of_nothing(engine):
    question = resolve(parse_explain_scene({**SCENE, "parameters": {"albedo": 0}}), engine.catalogue)
    result = compute_explanation(question, engine, rounds=3)
    assert set(result["variant"].values()) == {0}
    (entry,) = result["left_out"]
    assert entry["feature"] == "every sample"
    assert entry["saves"]["ns_per_sample"] == pytest.approx(result["full"]["ns_per_sample"])
    assert entry["saves"]["instructions"] == result["full"]["instructions"] > 0
    assert "every sample" in formats.encode(result, "table").decode()


def test_sizes_without_the_optimizer_are_those_of_the_module(engine, monkeypatch):
    question = resolve(parse_explain_scene(SCENE), engine.catalogue)
    shader = whole_shader(engine, question, question.series[0])
    monkeypatch.setattr("service.explain.shaders.specialized", lambda *_: None)
    size = size_of(engine, shader)
    assert not size.specialized
    assert size.spirv_bytes == size.module_bytes == len(shader.spirv)


@pytest.mark.parametrize(
    ("estimator", "field"),
    [({"method": "quadrature"}, "estimator.method"), ({"tolerance": 1e-3}, "estimator.tolerance")],
)
def test_a_scene_whose_shaders_draw_nothing_is_refused_by_name(estimator, field):
    with pytest.raises(BadInput, match=field):
        parse_explain_scene({**SCENE, "estimator": estimator})


def test_the_measurement_is_sized_before_it_runs(explained):
    question, result, _ = explained
    shaders = sum(len(shader["left_out"]) + 2 for shader in result["shaders"])
    assert draws(question) == shaders * 51 * LAUNCH_SAMPLES


def test_the_spread_of_rounds_is_median_quartiles_and_an_interval_of_the_median():
    found = spread(np.arange(101.0)[::-1])
    assert (found.median, found.quartiles) == (50.0, (25.0, 75.0))
    assert found.interval == (40.0, 60.0)  # ranks of a binomial of 101 with at most 2.5 % on either side
