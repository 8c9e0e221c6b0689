"""Namespaces by renaming: what is found, what is renamed, and that lines stay where they are."""

from service import glsl

SOURCE = """\
#include "common/arc.glsl"
#define SQUARE(x) ((x) * (x))
const float A = 1.0, B = SQUARE(2.0);
struct Lobe { float pdf; };
float pdf(vec3 wi) { float A_local = A; return A_local * B; }  // pdf of A
Lobe make(float pdf);
vec3 table[3] = vec3[3](vec3(1), vec3(2), vec3(A));
#if SQUARE(2) > 3
float brdf(vec3 wi, vec3 wo) { Lobe l; l.pdf = pdf(wi); return l.pdf; }
#endif
"""


def test_declared_names_are_functions_globals_structs_and_macros():
    assert glsl.declared_names(SOURCE) == {"SQUARE", "A", "B", "Lobe", "pdf", "make", "table", "brdf"}


def test_members_comments_and_includes_keep_their_names():
    names = {name: f"model_{name}" for name in glsl.declared_names(SOURCE)}
    renamed = glsl.rename(SOURCE, names)
    assert "l.pdf = model_pdf(wi)" in renamed
    assert "// pdf of A" in renamed
    assert '#include "common/arc.glsl"' in renamed
    assert "#define model_SQUARE(x)" in renamed
    assert "#if model_SQUARE(2) > 3" in renamed
    assert "A_local" in renamed


def test_lines_stay_where_they_are():
    renamed = glsl.rename(SOURCE, {"brdf": "model_brdf"})
    assert renamed.splitlines()[8].startswith("float model_brdf(")
    assert len(renamed.splitlines()) == len(SOURCE.splitlines())


def test_tokens_join_to_the_text():
    assert "".join(token for _, token in glsl.tokens(SOURCE)) == SOURCE


def test_expressions_at_top_level_are_not_declarations():
    assert glsl.declared_names("const float X = Y * Z, W = f(V);") == {"X", "W"}
