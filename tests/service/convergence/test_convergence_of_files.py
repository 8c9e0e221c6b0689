"""A user's own model and technique: their truth comes from their own code in double precision."""

import json

import numpy as np
import pytest

from service.catalogue import load_catalogue
from service.convergence import compute_convergence, parse_convergence_scene
from service.engine import Engine
from service.scene import resolve
from tests.service.command_line import samplerscope

MODEL = """/*---
provides = ["model"]
name = "half-lambert"
title = "Half of Lambert"
source = "here"
---*/
float brdf(vec3 wi, vec3 wo) { return min(wi.z, wo.z) > 0.0 ? 0.5 * INV_PI : 0.0; }
"""
TECHNIQUE = """/*---
provides = ["technique"]
name = "narrow"
title = "A hemisphere without its lowest part"
source = "here"
[parameters.lowest]
min = 0.0
max = 0.5
default = 0.1
---*/
DirectionSample sample_direction(vec3 wo, vec2 u) {
    float z = lowest + (1.0 - lowest) * u.x;
    float phi = 6.28318530718 * u.y;
    return DirectionSample(vec3(sqrt(1.0 - z * z) * vec2(cos(phi), sin(phi)), z), BROKEN / (2.0 * PI * (1.0 - lowest)));
}
float direction_pdf(vec3 wo, vec3 wi) { return wi.z >= lowest ? 1.0 / (2.0 * PI * (1.0 - lowest)) : 0.0; }
"""


@pytest.fixture
def own(tmp_path):
    def catalogue(broken="1.0"):
        (tmp_path / "model.glsl").write_text(MODEL)
        (tmp_path / "technique.glsl").write_text(TECHNIQUE.replace("BROKEN", broken))
        return load_catalogue().with_file(tmp_path / "model.glsl").with_file(tmp_path / "technique.glsl")

    return catalogue


def test_floor_and_curve_of_a_biased_technique_without_a_reference(own, engine):
    """The part below z = 0.1 holds 1 % of the light: the mean is 0.495 of an albedo of 0.5."""
    at = Engine(engine.device, own(), engine.cache)
    scene = parse_convergence_scene(
        {
            "model": "half-lambert",
            "techniques": ["narrow", "cosine"],
            "theta_o_deg": [20],
            "estimator": {"samples": 1024},
        }
    )
    narrow, cosine = (
        one
        for one in compute_convergence(resolve(scene, at.catalogue), at)["series"]
        if one["estimator"] == "quadrature"
    )
    assert narrow["floor"] == [pytest.approx(0.01, rel=1e-4)]
    assert narrow["relative_rmse"][-1] == [pytest.approx(0.01, rel=1e-4)]
    assert narrow["verdict"]["status"] == "biased"
    assert cosine["floor"] == [0.0]


def test_the_command_takes_a_file_and_runs_it_apart(tmp_path):
    path = tmp_path / "model.glsl"
    path.write_text(MODEL)
    options = "--technique uniform --theta-o-deg 20 --samples 1024 --method qmc,quadrature --format json"
    done = samplerscope("converge", "--model", path, *options.split())
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["kind"] == "convergence"
    assert {one["estimator"] for one in result["series"]} == {"qmc", "quadrature"}
    for one in result["series"]:
        assert one["floor"] == [0.0]
        assert one["relative_rmse"][-1][0] < 0.02  # 1024 points of a net, for a weight that is twice the cosine


@pytest.mark.parametrize("method", ["mc", "qmc", "quadrature"])
def test_samples_that_are_not_finite_are_counted_by_every_estimator_and_can_be_replayed(own, compute, method):
    (series,) = compute(
        catalogue=own("(u.x > 0.9 ? sqrt(-u.x) : 1.0)"),
        model="half-lambert",
        techniques="narrow",
        theta_o_deg=[20],
        estimator={"method": method, "samples": 4096},
    )["series"]
    assert series["nonfinite"][0] > 0
    assert series["verdict"]["status"] == "nonfinite"
    bits = series["verdict"]["findings"][0]["evidence"]["replay"][0]["u_bits"]
    u1 = np.array([int(bits[0], 16)], np.uint32).view(np.float32)[0]
    assert 0.9 < u1 < 1.0
