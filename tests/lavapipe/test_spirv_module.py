"""Reading SPIR-V: what a module declares is found, and no damage does harm."""

import random

import pytest

from lavapipe import InvalidArgument, compile_glsl, read_module

SOURCE = """#version 450
layout(local_size_x = 1) in;
layout(constant_id = 1) const int unused = 1;
layout(constant_id = 2) const uint used = 1;
layout(constant_id = 3) const bool flag = true;
layout(constant_id = 4) const double wide = 1.0lf;
layout(set = 0, binding = 0) buffer A { double a[]; };
layout(set = 2, binding = 7) readonly buffer B { mat3 b[]; };
PUSH
void main() { if (flag) a[0] = wide + double(used); }
"""


def module_bytes(push: str = "") -> bytes:
    return compile_glsl(SOURCE.replace("PUSH", push))


def test_declarations_are_found() -> None:
    module = read_module(module_bytes())
    assert {i: (c.kind, c.bits) for i, c in module.specialization.items()} == {
        1: ("int", 32),
        2: ("uint", 32),
        3: ("bool", 32),
        4: ("float", 64),
    }
    assert module.bindings == {(0, 0), (2, 7)}
    assert not module.other_resources
    assert module.capabilities == {1, 10}
    assert module.instructions > 20


@pytest.mark.parametrize(
    ("block", "size"),
    [
        ("", 0),
        ("layout(push_constant) uniform P { float x; } p;", 4),
        ("layout(push_constant) uniform P { float x; vec3 y; uint z; } p;", 32),
        ("layout(push_constant) uniform P { layout(offset = 32) vec2 x; } p;", 40),
        ("layout(push_constant) uniform P { float x[5]; } p;", 20),
        ("layout(push_constant) uniform P { mat3 m; } p;", 48),
        ("struct S { double d; float f; };\nlayout(push_constant) uniform P { float x; S s[2]; } p;", 40),
    ],
)
def test_push_constant_block_is_measured(block: str, size: int) -> None:
    assert read_module(module_bytes(block)).push_constant_bytes == size


def test_damage_is_an_invalid_argument_or_nothing() -> None:
    rng = random.Random(1)
    good = module_bytes("layout(push_constant) uniform P { mat3 m; float x[2]; } p;")
    for _ in range(2000):
        spirv = bytearray(good)
        for _ in range(rng.randint(1, 4)):
            spirv[rng.randrange(len(spirv))] = rng.randrange(256)
        try:
            read_module(bytes(spirv))
        except InvalidArgument as error:
            message = str(error)
            assert message.startswith("spirv: ")
