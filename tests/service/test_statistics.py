"""Sampled statistics on the device against the float64 reference, and laws that hold for every run.

Seeds are fixed. A comparison of k values with a bound of 4 standard errors expects 6.3e-5 k of them outside; the
bounds below allow what a correct sampler passes with a probability of at least 0.999.
"""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from service import sampling
from service.catalogue import SHADERS, load_catalogue, read_entry
from service.moments import bernstein_half_width
from service.reference import cell_reference, load_model, load_technique
from service.scene import parse_scene, resolve
from service.statistics import compute_statistics, series_cells
from tests.service.conftest import column, view

CONVERGENT = ["cosine", "uniform", "ltc-nonnegative", "cltc-mis"]
ALL = [*CONVERGENT, "ltc", "cltc"]
ANGLES = [0.0, 0.4, 0.7755, 2.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 88.0, 89.0, 89.5, 89.9, 89.99]
ROUGHNESS = [0.0, 0.05, 0.25, 0.5, 0.75, 1.0]


@pytest.fixture(scope="module")
def grid(session_engine):
    """A million samples for every convergent technique, roughness and angle."""
    scene = {
        "model": "eon",
        "techniques": CONVERGENT,
        "parameters": {"roughness": ROUGHNESS},
        "theta_o_deg": ANGLES,
        "estimator": {"samples": 1_000_000, "seed": 1},
    }
    return compute_statistics(resolve(parse_scene(scene), session_engine.catalogue), session_engine)["series"]


def test_means_agree_with_the_reference_within_their_standard_errors(grid):
    """With the reference's standard error, of 360 cells 0.02 are expected beyond 4, and one is allowed.

    Every one is below Bernstein's bound at 1e-6, which holds for any tail.
    """
    beyond, squares = 0, []
    for series in grid:
        variance = column(series, "reference", "variance")
        off = np.abs(column(series, "mean") - column(series, "reference", "mean"))
        stderr = np.sqrt(variance / series["samples"])
        rounding = 2e-7  # float32 weights near 1
        beyond += int(np.sum(off > 4 * stderr + rounding))
        bound = bernstein_half_width(variance, column(series, "reference", "max_weight"), series["samples"], 1e-6)
        assert np.all(off <= bound + rounding)
        squares += list((off[variance > 1e-9] / stderr[variance > 1e-9]) ** 2)
    assert beyond <= 1
    assert 0.7 < np.mean(squares) < 1.3


def test_variances_agree_with_the_reference_within_their_standard_errors(grid):
    """With the samples' own error bars where the verdict trusts them, and with the reference's everywhere."""
    own, known = 0, 0
    for series in grid:
        off = np.abs(column(series, "variance") - column(series, "reference", "variance"))
        heavy = heavy_angles(series)
        trusted = np.array([angle not in heavy for angle in series["theta_o_deg"]])
        rounding = 1e-12
        own += int(np.sum(off[trusted] > 4 * column(series, "variance_stderr")[trusted] + rounding))
        known += int(np.sum(off > 4 * column(series, "reference", "variance_stderr") + rounding))
    assert own <= 1
    assert known <= 1


def heavy_angles(series):
    findings = series["verdict"]["findings"]
    return {a for f in findings if f["name"] == "heavy-tail" for a in f["evidence"]["theta_o_deg"]}


def test_error_bars_are_trusted_up_to_89_degrees_and_not_beyond_where_they_fail(grid):
    for series in grid:
        heavy = heavy_angles(series)
        assert all(angle > 89 for angle in heavy)
        if series["technique"] in ("cosine", "ltc-nonnegative") and series["parameters"]["roughness"] == 1:
            assert {89.9, 89.99} <= heavy
        if series["technique"] in ("uniform", "cltc-mis"):
            assert not heavy


def test_a_finding_at_grazing_names_angles_below_90_and_counts_that_can_be_read(session_engine):
    data = {
        "model": "eon",
        "techniques": ["cosine"],
        "theta_o_deg": [89.999999999999, 10],
        "estimator": {"samples": 10},
    }
    (series,) = compute_statistics(resolve(parse_scene(data), session_engine.catalogue), session_engine)["series"]
    (finding,) = series["verdict"]["findings"]
    assert "10 to 89.999999999999 degrees" in finding["message"]
    assert re.search(r"; \de\+\d\d samples, more than a scene may ask for, would do", finding["message"])


def test_convergent_techniques_have_no_finding_but_heavy_tails(grid):
    assert {f["name"] for series in grid for f in series["verdict"]["findings"]} <= {"heavy-tail"}


def test_no_sampled_weight_passes_the_supremum(grid):
    """Up to float32 rounding of weights: 2e-6 relative, and 1e-4 where 1/cos of a grazing view amplifies it."""
    for series in grid:
        supremum = column(series, "reference", "max_weight")
        grazing = np.array(series["theta_o_deg"]) > 89
        assert np.all(column(series, "max_weight") <= supremum * np.where(grazing, 1 + 1e-4, 1 + 2e-6))


def test_cltc_mis_mean_weight_is_the_albedo_at_every_angle(compute):
    (series,) = compute(techniques="cltc-mis", estimator={"samples": 4_000_000, "seed": 5})["series"]
    off = np.abs(column(series, "mean") - 1.0)
    assert np.all(off < 5 * column(series, "mean_stderr"))  # 64 angles: one in 27,000 seeds would fail


def test_at_roughness_0_every_technique_but_uniform_weighs_one(compute):
    """Exactly one for cosine; within a dozen float32 roundings of the transform (1.5e-6) for the others."""
    for technique in ["cosine", "ltc-nonnegative", "ltc", "cltc", "cltc-mis"]:
        (series,) = compute(techniques=technique, parameters={"roughness": 0}, theta_o_deg=ANGLES)["series"]
        assert np.all(column(series, "variance") < 1e-12)
        assert np.allclose(column(series, "max_weight"), 1, rtol=0 if technique == "cosine" else 1.5e-6, atol=0)
        assert series["verdict"]["status"] == "ok"


@pytest.mark.parametrize("roughness", [0, 1e-3, 1])
def test_a_clipped_lobe_loses_no_sample(compute, roughness):
    """Not one of 128 million directions rounds to the horizon or to density zero."""
    for series in compute(techniques=["cltc", "cltc-mis"], parameters={"roughness": roughness})["series"]:
        assert series["zero_fraction"] == [0.0] * 64


def test_albedo_0_reflects_nothing(compute):
    for series in compute(parameters={"albedo": 0}, theta_o_deg=[0, 45, 89.9])["series"]:
        assert column(series, "mean").tolist() == column(series, "variance").tolist() == [0, 0, 0]
        assert series["zero_fraction"] == [1, 1, 1]
        assert not {"nonfinite", "imprecise", "biased"} & {f["name"] for f in series["verdict"]["findings"]}


@pytest.mark.parametrize("model", ["fon", "eon-approx", "eon"])
def test_a_colour_channel_agrees_with_the_reference(compute, model):
    """Albedo below 1: of 128 comparisons 0.008 are expected beyond 4 standard errors, and one is allowed."""
    beyond = 0
    scene = {"parameters": {"albedo": [0.2, 0.7]}, "theta_o_deg": [0, 20, 50, 70, 80, 85, 88, 89]}
    for series in compute(model=model, techniques=CONVERGENT, **scene)["series"]:
        mean_stderr = np.sqrt(column(series, "reference", "variance") / series["samples"])
        for name, stderr in (("mean", mean_stderr), ("variance", column(series, "reference", "variance_stderr"))):
            off = np.abs(column(series, name) - column(series, "reference", name))
            beyond += int(np.sum(off > 4 * stderr + 2e-7))
    assert beyond <= 1


def test_ltc_and_cltc_are_named_for_what_they_are(compute):
    for series in compute(techniques=["ltc", "cltc"], theta_o_deg=[20, 45, 89.9])["series"]:
        names = [finding["name"] for finding in series["verdict"]["findings"]]
        assert names == ["infinite-variance", "biased", "uncovered", "unbounded-weight"]
        assert series["reference"]["variance"] == [None] * 3
        assert series["variance_stderr"] == series["mean_stderr"] == [None] * 3
        strength = series["verdict"]["findings"][0]["evidence"]["tail_strength"]
        assert all(0 < kappa < 0.01 for kappa in strength)
        mean = column(series, "mean")
        assert np.all(np.abs(mean - column(series, "reference", "mean")) < 2e-3)
        assert 0.991 < mean[-1] < 0.9935


def tail_probability(limit):
    """P(w > limit) of cltc at 80 degrees: the reference's own sampler on a grid of (u1, u2), graded to both ends."""
    graded = np.geomspace(1e-9, 0.5, 1500)
    edges = np.concatenate([[0.0], graded, 1 - graded[-2::-1], [1.0]])
    u1, u2 = np.meshgrid((edges[1:] + edges[:-1]) / 2, (np.arange(1000) + 0.5) / 1000, indexing="ij")
    wo, parameters = view(math.radians(80)), {"roughness": 1.0, "albedo": 1.0}
    wi, pdf = load_technique("cltc").sample(wo, u1, u2, parameters)
    weight = load_model("eon").brdf(wi, wo, parameters) * wi[..., 2] / pdf
    return float(np.sum(np.diff(edges) * np.mean(weight > limit, axis=1)))


def test_the_sampled_tail_of_cltc_follows_its_strength(engine, monkeypatch):
    """Of 20,000 blocks of n = 16,384 samples the share whose largest weight passes W is 1 - (1 - P(w > W))^n.

    Its spread is binomial; 5 standard deviations are the bound, and 1 % for the grid that P comes from. The strength
    kappa is the limit of 2 W^2 P; the next order is about 1/W of it, so at W = 1000 they agree to 1 %.
    """
    blocks, largest, add = 20_000, [], sampling._add

    def keep(total, launch, submission, outputs):
        done = add(total, launch, submission, outputs)
        found = sampling._view(outputs[1], launch)[..., sampling.LARGEST]
        largest.extend(found.view(np.float32).max(axis=(0, 1)).tolist())
        return done

    monkeypatch.setattr(sampling, "_add", keep)
    scene = parse_scene({"model": "eon", "techniques": ["cltc"], "theta_o_deg": [80], "estimator": {"seed": 3}})
    plan = resolve(scene, engine.catalogue).series[0]
    pipeline = engine.pipeline(plan.model, plan.technique, "statistics", {0: 2, 1: True})
    with sampling.Sampler(engine.device, pipeline, series_cells(plan, scene)) as sampler:
        sampler.run(blocks * sampling.BLOCK_SAMPLES)
    assert len(largest) == blocks
    for limit in (5.0, 10.0, 30.0):
        expected = 1 - (1 - tail_probability(limit)) ** sampling.BLOCK_SAMPLES
        spread = math.sqrt(expected * (1 - expected) / blocks)
        assert np.mean(np.array(largest) > limit) == pytest.approx(expected, abs=5 * spread + 0.01 * expected)
    kappa = cell_reference("eon", "cltc", {"roughness": 1.0, "albedo": 1.0}, math.radians(80)).tail_strength
    assert 2 * 1000**2 * tail_probability(1000.0) == pytest.approx(kappa, rel=0.01)


def test_a_billion_samples_keep_their_accuracy(compute):
    """At 10^9 samples the standard error of the variance is 3e-5 of it, and that of the mean 4e-6."""
    (series,) = compute(techniques="cltc-mis", theta_o_deg=[80], estimator={"samples": 10**9})["series"]
    (mean,), (variance,) = series["mean"], series["variance"]
    assert abs(mean - 1) < 4 * series["mean_stderr"][0] + 1e-7
    assert abs(variance - series["reference"]["variance"][0]) < 4 * series["variance_stderr"][0]
    assert series["variance_stderr"][0] / variance < 1e-4


def statistics_only(result):
    dropped = ("verdict", "device_ms")
    return [{k: v for k, v in series.items() if k not in dropped} for series in result["series"]]


def test_the_same_scene_gives_the_same_bits_in_launches_of_any_size(compute, monkeypatch):
    scene = {"techniques": ALL, "theta_o_deg": [0, 45, 89.9], "estimator": {"samples": 100_001, "seed": 9}}
    first = compute(**scene)
    monkeypatch.setattr(sampling, "LAUNCH_BLOCKS", 5)
    assert statistics_only(compute(**scene)) == statistics_only(first)


def test_a_cell_has_the_same_bits_alone_and_among_others(compute):
    estimator = {"samples": 50_000, "seed": 2}
    many = compute(parameters={"roughness": [0.3, 1]}, theta_o_deg=[10, 60, 89], estimator=estimator)
    among = next(s for s in many["series"] if s["technique"] == "ltc" and s["parameters"]["roughness"] == 1)
    (alone,) = compute(techniques="ltc", theta_o_deg=[60], estimator=estimator)["series"]
    for name in ("mean", "variance", "max_weight", "variance_stderr"):
        assert (alone[name][0] == among[name][1]) or (alone[name][0] is among[name][1] is None)


def test_a_narrower_question_gives_the_same_bits(compute):
    scene = {"techniques": "cltc-mis", "theta_o_deg": [80], "estimator": {"samples": 50_000}}
    (full,) = compute(**scene)["series"]
    (mean,) = compute(**scene, statistics="mean", error_bars=False, reference=False)["series"]
    (largest,) = compute(**scene, statistics="max_weight")["series"]
    assert mean["mean"] == full["mean"]
    assert largest["max_weight"] == full["max_weight"]
    assert not {"variance", "mean_stderr", "max_weight"} & set(mean)
    assert mean["reference"] is None


@pytest.mark.parametrize("samples", [1, 2, 63, 64, 65, 16_384, 16_385])
def test_any_number_of_samples_is_drawn_exactly(compute, samples):
    (series,) = compute(techniques="uniform", theta_o_deg=[30], estimator={"samples": samples})["series"]
    assert series["samples"] == samples
    assert math.isfinite(series["mean"][0])
    assert (series["variance"][0] is None) == (samples == 1)


def with_replaced(kind, name, old, new):
    """The text of a shader file of the catalogue, changed in one place."""
    text = (SHADERS / kind / f"{name}.glsl").read_text()
    assert old in text
    return text.replace(old, new)


def planted(path):
    """The catalogue with one entry replaced, as if the catalogue itself were wrong: its own truth still judges it."""
    catalogue, entry = load_catalogue(), read_entry(path.read_text(), str(path))
    return replace(catalogue, techniques={**catalogue.techniques, entry.name: entry})


@pytest.mark.parametrize(
    ("technique", "old", "new", "finding"),
    [
        (
            "uniform",
            "uniform_hemisphere(u)",
            "uniform_hemisphere(vec2(sqrt((1.0 - u.x) * (1.0 + u.x)), u.y))",
            "biased",
        ),
        ("cosine", "cosine_hemisphere(u);", "DirectionSample(cosine_hemisphere(u).wi, UNIFORM_DENSITY);", "biased"),
        ("cltc-mis", "u.x * (1.0 / probability)", "0.5 + 0.5 * u.x * (1.0 / probability)", "biased"),
        ("cosine", "cosine_hemisphere(u);", "DirectionSample(cosine_hemisphere(u).wi, 1.0 / floor(u.x));", "nonfinite"),
        ("cosine", "cosine_hemisphere(u);", "DirectionSample(vec3(0.0, 0.0, sqrt(-1.0 - u.x)), 1.0);", "nonfinite"),
    ],
    ids=["uniform-radius", "wrong-density", "wrong-lobe-number", "infinite-density", "nan-direction"],
)
def test_a_planted_bug_is_found(compute, tmp_path, technique, old, new, finding):
    path = tmp_path / "broken.glsl"
    path.write_text(with_replaced("techniques", technique, old, new))
    (series,) = compute(catalogue=planted(path), techniques=technique, theta_o_deg=[0, 45, 85])["series"]
    assert series["verdict"]["status"] == finding


def test_the_uniform_lobe_of_the_listing_biases_the_mixture(compute, tmp_path):
    """Listing 4 of the EON paper takes the radius u1, so the cosine sqrt(1 - u1^2): the mean is then 1.019 at grazing.

    The standard error of a mean of 4 million weights is 1e-4.
    """
    path = tmp_path / "listing.glsl"
    cosine = "sqrt((1.0 - u.x / probability) * (1.0 + u.x / probability))"
    path.write_text(
        with_replaced("techniques", "cltc-mis", "vec2(u.x * (1.0 / probability), u.y)", f"vec2({cosine}, u.y)")
    )
    (series,) = compute(
        catalogue=planted(path),
        techniques="cltc-mis",
        theta_o_deg=[0, 45, 80, 89.9],
        estimator={"samples": 4_000_000},
    )["series"]
    assert series["mean"] == pytest.approx([1.0028, 1.0079, 1.0151, 1.0192], abs=5e-4)
    assert series["verdict"]["status"] == "biased"


def test_a_nonfinite_sample_can_be_replayed(compute, tmp_path, engine):
    """A density that is NaN for u2 in [0.5, 0.5 + 2^-12): the first such sample is named by index and by its bits."""
    path = tmp_path / "broken.glsl"
    bug = (
        "float hole = u.y >= 0.5 && u.y < 0.500244140625 ? 0.0 : 1.0;"
        "return DirectionSample(cosine_hemisphere(u).wi, INV_PI * sqrt(u.x) * hole / hole);"
    )
    path.write_text(with_replaced("techniques", "cosine", "return cosine_hemisphere(u);", bug))
    catalogue = planted(path)
    (series,) = compute(catalogue=catalogue, techniques="cosine", theta_o_deg=[45], estimator={"samples": 100_000})[
        "series"
    ]
    evidence = series["verdict"]["findings"][0]["evidence"]
    u2 = np.array([int(evidence["replay"][0]["u_bits"][1], 16)], np.uint32).view(np.float32)[0]
    assert 0.5 <= u2 < 0.500244140625
    assert series["nonfinite"][0] == pytest.approx(100_000 / 4096, abs=5 * math.sqrt(100_000 / 4096))
    assert series["mean"][0] == pytest.approx(1, abs=0.01)
