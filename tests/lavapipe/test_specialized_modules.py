"""What a module comes to when its specialization is known."""

import pytest

from lavapipe import Cache, compile_glsl, read_module, specialized
from lavapipe import optimizer as optimizer_module

SOURCE = """#version 460
layout(local_size_x = 1) in;
layout(constant_id = 3) const bool WITH_ROOT = true;
layout(constant_id = 4) const float SCALE = 2.0;
layout(std430, set = 0, binding = 0) buffer Data { float data[]; };
void main() {
    float x = data[0] * SCALE;
    if (WITH_ROOT) x += sqrt(data[1]);
    data[2] = x;
}
"""


@pytest.fixture
def module():
    return compile_glsl(SOURCE)


def instructions(spirv):
    return read_module(spirv).instructions


def test_code_that_the_specialization_rules_out_is_gone(module):
    kept, dropped = (specialized(module, {3: value, 4: 2.0}) for value in (True, False))
    assert instructions(dropped) < instructions(kept) < instructions(module)
    assert read_module(kept).specialization == {}


def test_a_float_constant_is_folded(module):
    by_zero, by_one, by_two = (instructions(specialized(module, {3: False, 4: value})) for value in (0.0, 1.0, 2.0))
    assert by_zero < by_two
    assert by_one < by_two


def test_the_result_comes_from_the_cache_the_second_time(module, tmp_path, monkeypatch):
    cache = Cache(tmp_path)
    first = specialized(module, {3: False}, cache)
    monkeypatch.setattr(optimizer_module.shutil, "which", lambda _: None)
    assert specialized(module, {3: False}, cache) == first
    assert specialized(module, {3: True}, cache) is None


def test_what_the_optimizer_refuses_is_none(module, tmp_path):
    assert specialized(module[:-8], {}, Cache(tmp_path)) is None
