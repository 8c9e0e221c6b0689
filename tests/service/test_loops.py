"""Loops are counted: every condition asks, nested and without braces, and lines stay where they are."""

import numpy as np
import pytest

from service.catalogue import load_catalogue, read_entry
from service.engine import Engine
from service.loops import COUNTER, count_loops
from service.probe import LoopLimitReached, Probe

HEAD = '/*---\nprovides = ["model"]\nname = "loops"\ntitle = "L"\nsource = "own"\n---*/\n'


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("for (int i = 0; i < 3; i++) x();", f"for (int i = 0; {COUNTER}() && (i < 3); i++) x();"),
        ("for (;;) { break; }", f"for (; {COUNTER}();) {{ break; }}"),
        ("while (a(b, c[1])) ;", f"while ({COUNTER}() && (a(b, c[1]))) ;"),
        ("do { x; } while (x < 1);", f"do {{ x; }} while ({COUNTER}() && (x < 1));"),
        ("// for (;;)\nint former;", "// for (;;)\nint former;"),
        (
            "for (int i = 0; i < f(1); i++)\n while (b) c;",
            f"for (int i = 0; {COUNTER}() && (i < f(1)); i++)\n while ({COUNTER}() && (b)) c;",
        ),
    ],
)
def test_every_condition_asks_the_counter(text, expected):
    assert count_loops(text) == expected


def probe_of(engine, body):
    catalogue = load_catalogue()
    entry = read_entry(HEAD + f"float brdf(vec3 wi, vec3 wo) {{\n{body}\n}}\n", "loops.glsl")
    return Probe(Engine(engine.device, catalogue, engine.cache), entry, catalogue.technique("cosine"))


VIEW, NO_PARAMETERS = np.array([[0.0, 0.0, 1.0]]), np.zeros((1, 0))


def test_counted_loops_give_the_same_values(engine):
    probe = probe_of(
        engine, "float s = 0.0; for (int i = 0; i < 100; i++) { int k = 0; while (k < i) { k++; s += 1.0; } } return s;"
    )
    assert probe.evaluate(VIEW, VIEW, NO_PARAMETERS).brdf.tolist() == [4950.0]


@pytest.mark.parametrize(
    "body",
    [
        "float s = wi.z; while (true) { s += 1.0; if (s < 0.0) break; } return s;",
        "float s = wi.z; for (;;) { s += 1.0; if (s < 0.0) break; } return s;",
        "float s = 0.0; for (int i = 0; i < 1000; i++) for (int k = 0; k < 1000; k++) s += wi.z; return s;",
        "#define LOOP while (s >= 0.0) s += 1.0\nfloat s = wi.z; LOOP; return s;",
    ],
    ids=["while", "for", "nested", "in a macro"],
)
@pytest.mark.parametrize("precision", ["float", "double"])
def test_reaching_the_limit_is_an_error_not_a_number(engine, body, precision):
    with pytest.raises(LoopLimitReached, match=r"loops\.glsl"):
        probe_of(engine, body).evaluate(VIEW, VIEW, NO_PARAMETERS, precision)
