"""The catalogue: what the shipped files declare, and what a file may not do."""

import pytest

from service.catalogue import RESERVED, SHADERS, load_catalogue, own_entry, read_entry
from service.convergence import ConvergenceScene
from service.errors import ShaderFileError
from service.scene import Estimator

HEAD = 'provides = ["model"]\nname = "mine"\ntitle = "Mine"\nsource = "own"\n'
CODE = "float brdf(vec3 wi, vec3 wo) { return 1.0; }\n"


def entry(head=HEAD, code=CODE):
    return read_entry(f"/*---\n{head}---*/\n{code}", "mine.glsl")


def test_every_shipped_file_is_found_under_its_own_name():
    catalogue = load_catalogue()
    assert set(catalogue.models) == {path.stem for path in SHADERS.glob("models/*.glsl")}
    assert set(catalogue.techniques) == {path.stem for path in SHADERS.glob("techniques/*.glsl")}
    for name, item in [*catalogue.models.items(), *catalogue.techniques.items()]:
        assert item.origin.endswith(f"/{name}.glsl")


def test_a_minimal_file_is_enough():
    assert entry().head.models == "any"


@pytest.mark.parametrize(
    ("head", "code", "says"),
    [
        (HEAD + "colour = 3\n", CODE, "colour"),
        (HEAD.replace('"mine"', '"My Name"'), CODE, "name = My Name: allowed is at most 64 lower case letters"),
        (HEAD.replace('["model"]', '["brdf"]'), CODE, 'provides = brdf: allowed is ["model"], ["technique"]'),
        (HEAD.replace('["model"]', '"model"'), CODE, 'provides = model: allowed is ["model"], ["technique"]'),
        (HEAD + 'model = "eon"\n', CODE, "no field of this name; there are provides, name"),
        (HEAD + 'models = "eon"\n', CODE, 'models = eon: allowed is "any" or a list'),
        (HEAD + "[parameters.r]\nmin = 0\nmax = 1\n", CODE, "parameters.r.default = None: allowed is a number"),
        (
            HEAD + '[parameters.r]\nmin = "low"\nmax = 1\ndefault = 0\n',
            CODE,
            "parameters.r.min = low: allowed is a number",
        ),
        (HEAD + "[parameters.float]\nmin = 0\nmax = 1\ndefault = 0\n", CODE, "may not be called 'float'"),
        ('name = "mine"\n', CODE, "provides"),
        (HEAD + "x = = 1\n", CODE, "mine.glsl:6: the head is not TOML"),
        (HEAD + "[parameters.samples]\nmin = 0\nmax = 1\ndefault = 0\n", CODE, "samples"),
        (HEAD + "[parameters.r]\nmin = 0\nmax = 1\ndefault = 2\n", CODE, "min <= default <= max"),
        (HEAD + "black = { albedo = 0 }\n", CODE, "'albedo' is no parameter of this file"),
        (HEAD + '[left_out]\n"lobe" = { r = 2 }\n[parameters.r]\nmin = 0\nmax = 1\ndefault = 0\n', CODE, "range"),
        (HEAD + '[left_out]\n"lobe" = {}\n', CODE, "must name a parameter"),
        (HEAD, "float f() { return 1.0; }", "brdf"),
        (HEAD.replace("model", "technique"), CODE, "sample_direction"),
    ],
)
def test_a_file_that_breaks_the_contract_is_refused_with_its_name(head, code, says):
    with pytest.raises(ShaderFileError, match=r"mine\.glsl") as caught:
        entry(head, code)
    assert says in str(caught.value)


def test_no_parameter_has_the_name_of_a_field_of_a_scene():
    assert {*ConvergenceScene.model_fields, *Estimator.model_fields} <= RESERVED


def test_a_file_without_head_is_refused():
    with pytest.raises(ShaderFileError, match="head"):
        read_entry(CODE, "mine.glsl")


def test_a_head_without_an_end_is_refused():
    with pytest.raises(ShaderFileError, match=r"end with a line ---\*/"):
        read_entry(f"/*---\n{HEAD}\n{CODE}", "mine.glsl")


@pytest.mark.parametrize(
    "code",
    [
        "float brdf(vec3 wi) { return 1.0; }",
        "vec3 brdf(vec3 wi, vec3 wo) { return vec3(1.0); }",
        "float brdf(vec3 wi, vec3 wo, float roughness) { return 1.0; }",
        CODE + "float directional_albedo(vec3 wo) { return 1.0; }",
    ],
)
def test_a_function_of_another_signature_is_refused_with_its_line(code):
    with pytest.raises(ShaderFileError, match=r"mine\.glsl:[78]: (brdf|directional_albedo): must be float \1\("):
        own_entry(f"/*---\n{HEAD}---*/\n{code}", "mine.glsl")


@pytest.mark.parametrize(
    "code",
    [
        "float brdf(const in vec3 a, /* the view */ vec3 b) { return 1.0; }",
        "float brdf(vec3, vec3);\nfloat brdf(vec3 wi, vec3 wo) { return 1.0; }",
        "float brdf(vec3 wi, vec3 wo) { return 1.0; }\nfloat brdf(vec3 wi, vec3 wo, float x) { return x; }",
        "#define V vec3\nfloat brdf(V wi, V wo) { return 1.0; }",
    ],
)
def test_a_signature_may_be_written_in_any_way_that_glsl_knows(code):
    assert own_entry(f"/*---\n{HEAD}---*/\n{code}", "mine.glsl").head.name == "mine"


def test_files_of_any_editor_are_read():
    text = f"/*---\n{HEAD}---*/\n{CODE}"
    assert own_entry("\ufeff" + text.replace("\n", "\r\n"), "mine.glsl").code == text
