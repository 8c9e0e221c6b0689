"""Widening to double: types, literals, functions, macros, and that lines stay where they are."""

import numpy as np

from service.catalogue import load_catalogue, read_entry
from service.engine import Engine
from service.probe import Probe
from service.widening import widen

SOURCE = """\
precision highp float;
#define SQUARE(x) ((x) * (x) * 1.0)
const float K = exp(0.5), TABLE[2] = float[](1., .5e-3f);
const int N = 3;
uniform mat3 m; // float in a comment
highp float f(const in vec3 v, float s) { return sin(v.x) * s.x + atan(v.y, 2.0) + float(N) + 3u; }
"""


def test_types_literals_and_functions_are_widened():
    out = widen(SOURCE)
    assert "double K = double_exp(0.5lf), TABLE[2] = double[](1.lf, .5e-3lf);" in out
    assert "(x) * (x) * 1.0lf" in out
    assert "const int N = 3;" in out
    assert "dmat3 m; // float in a comment" in out
    assert "double f(const in dvec3 v, double s)" in out
    assert "double_sin(v.x) * s.x + double_atan(v.y, 2.0lf) + double(N) + 3u" in out
    assert "precision" not in out


def test_lines_stay_where_they_are():
    assert widen(SOURCE).count("\n") == SOURCE.count("\n")
    assert widen(SOURCE).splitlines()[3] == "const int N = 3;"


OWN = """/*---
provides = ["model"]
name = "own"
title = "Own"
source = "own"
[parameters.sharpness]
min = 1.0
max = 50.0
default = 3.0
---*/
#define SCALE 0.25
const float NORMALISATION = exp(-1.0) * SCALE;
const float NODES[2] = float[](0.5, 0.25);
float exp_of(float x) { return exp(x); }
float brdf(vec3 wi, vec3 wo) {
    vec2 both = pow(vec2(wi.z, wo.z), vec2(0.37));
    float sum = 0.0;
    for (int i = 0; i < 2; ++i) sum += NODES[i] * acos(clamp(dot(wi, wo), -1.0, 1.0));
    while (sum > 10.0) sum -= 1;
    return NORMALISATION * exp_of(-sum) * both.x * both.y * (1.0 + 0.1 * sin(sharpness * atan(wi.y, wi.x))) * mix(1.0,
    2.0, 0.5);
}
"""


def test_own_code_in_double_has_the_accuracy_of_double(engine):
    catalogue = load_catalogue()
    entry = read_entry(OWN, "own.glsl")
    probe = Probe(Engine(engine.device, catalogue, engine.cache), entry, catalogue.technique("cosine"))
    rng = np.random.default_rng(0)
    wi, wo = rng.normal(size=(2, 1000, 3))
    wi, wo = (w / np.linalg.norm(w, axis=1, keepdims=True) for w in (wi, wo))
    wi[:, 2], wo[:, 2] = np.abs(wi[:, 2]), np.abs(wo[:, 2])
    found = probe.evaluate(wo, wi, np.array([[3.7]]), "double").brdf
    angle = np.arccos(np.clip(np.sum(wi * wo, axis=1), -1, 1))
    expected = np.exp(-1) * 0.25 * np.exp(-0.75 * angle) * (wi[:, 2] * wo[:, 2]) ** 0.37
    expected *= (1 + 0.1 * np.sin(3.7 * np.arctan2(wi[:, 1], wi[:, 0]))) * 1.5
    # arccos of a dot product next to 1 is the least accurate part
    assert np.abs(found / expected - 1).max() < 1e-12
