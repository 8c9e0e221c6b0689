"""The catalogue: what the shipped files declare, and what a file may not do."""

import pytest

from service.catalogue import RESERVED, SHADERS, load_catalogue, read_entry
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
        (HEAD.replace('"mine"', '"My Name"'), CODE, "name"),
        ('name = "mine"\n', CODE, "provides"),
        (HEAD + "x = = 1\n", CODE, "not TOML"),
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
