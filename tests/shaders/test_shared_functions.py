"""The functions of shaders/common against NumPy and SciPy: double ones to a few float64 ulp, float ones to a few
float32 ulp.

Inputs are dense in the range and in its exponents; NumPy's own functions are good to 1 ulp, so a bound of n ulp proves
n + 1.
"""

import struct

import numpy as np
import pytest

from lavapipe import compile_glsl
from service.catalogue import load_catalogue
from service.widening import widen

TEMPLATE = """#version 460
{head}
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer A {{ {type}2 a[]; }};
layout(std430, binding = 1) writeonly buffer B {{ {scalar} b[]; }};
layout(push_constant) uniform Launch {{ uint count; }};
void main() {{
    uint i = gl_GlobalInvocationID.x;
    if (i < count) b[i] = {expression};
}}
"""


def run(device, head, expression, x, y, *, double):
    includes = load_catalogue().includes
    text = TEMPLATE.format(
        head=head, expression=expression, type="dvec" if double else "vec", scalar="double" if double else "float"
    )
    dtype = np.float64 if double else np.float32
    spirv = compile_glsl(text, include=includes)
    pipeline = device.pipeline(spirv, buffers=2, push_constant_bytes=4)
    with device.buffer((len(x), 2), dtype) as a, device.buffer(len(x), dtype) as b:
        a.array[:, 0], a.array[:, 1] = x, y
        device.run(pipeline, [a, b], (-(-len(x) // 64), 1, 1), struct.pack("<I", len(x)))
        return b.array.copy()


def spread(low, high, count=100_000, seed=1):
    """Half uniform, half log-uniform in magnitude, both signs where the range has them, and its ends."""
    rng = np.random.default_rng(seed)
    flat = rng.uniform(low, high, count // 2)
    if low > 0:
        steep = (
            low * (high / low) ** rng.uniform(0, 1, count // 2)
            if high / low < 1e300
            else 10 ** flat_exponents(rng, count)
        )
    else:
        signs = rng.choice([-1, 1], count // 2) if low < 0 else 1
        steep = high * 2.0 ** rng.uniform(-40, 0, count // 2) * signs
    return np.concatenate([flat, np.clip(steep, low, high), [low, high]])


def flat_exponents(rng, count):
    return rng.uniform(-300, 300, count // 2)


def ulps(found, expected):
    """Error in units of the last place of the expected value; equal infinities and NaNs count as none."""
    same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    with np.errstate(invalid="ignore"):
        error = np.abs(found - expected) / np.spacing(np.abs(expected))
    return np.where(same, 0, np.where(np.isfinite(error), error, np.inf))


DOUBLE = [
    ("sin", np.sin, (-100, 100), 2),
    ("cos", np.cos, (-100, 100), 2),
    ("sin", np.sin, (-1e6, 1e6), 2),
    ("tan", np.tan, (-10, 10), 4),
    ("asin", np.arcsin, (-1, 1), 2),
    ("acos", np.arccos, (-1, 1), 2),
    ("atan", np.arctan, (-100, 100), 2),
    ("atan", np.arctan, (-1e20, 1e20), 2),
    ("sinh", np.sinh, (-20, 20), 6),
    ("cosh", np.cosh, (-20, 20), 6),
    ("tanh", np.tanh, (-20, 20), 8),
    ("asinh", np.arcsinh, (-1e3, 1e3), 4),
    ("acosh", np.arccosh, (1, 1e3), 4),
    ("atanh", np.arctanh, (-0.999, 0.999), 6),
    ("exp", np.exp, (-700, 700), 2),
    ("exp", np.exp, (-1, 1), 2),
    ("exp2", np.exp2, (-1000, 1000), 2),
    ("log", np.log, (1e-300, 1e300), 2),
    ("log", np.log, (0.5, 2), 2),
    ("log2", np.log2, (0.5, 2), 3),
]


@pytest.mark.parametrize(("name", "truth", "domain", "bound"), DOUBLE, ids=[f"{d[0]}{d[2]}" for d in DOUBLE])
def test_a_double_function_is_right_to_a_few_ulp(device, name, truth, domain, bound):
    x = spread(*domain)
    found = run(device, '#include "common/double.glsl"', f"double_{name}(a[i].x)", x, x, double=True)
    assert ulps(found, truth(x)).max() <= bound


@pytest.mark.parametrize(("low", "high", "power"), [(1e-30, 1, 0.1), (0, 1, 1e4), (1e-3, 1e3, 40), (0.5, 2, 900)])
def test_double_pow_is_right_to_a_few_ulp(device, low, high, power):
    x = spread(low, high)
    y = np.random.default_rng(2).uniform(-power if low else 0, power, len(x))
    found = run(device, '#include "common/double.glsl"', "double_pow(a[i].x, a[i].y)", x, y, double=True)
    expected = x**y
    exponent = np.abs(np.log(expected, where=expected > 1e-300, out=np.full(len(x), np.inf)))
    error = ulps(found, expected)
    assert error[exponent < 50].max() <= 3
    assert error[exponent < 690].max() <= 32  # the rounding of the logarithm, times the exponent


def test_double_atan_of_two_is_right_in_every_quadrant(device):
    rng = np.random.default_rng(3)
    y, x = rng.normal(size=(2, 100_000)) * 2.0 ** rng.uniform(-30, 30, (2, 100_000))
    found = run(device, '#include "common/double.glsl"', "double_atan(a[i].x, a[i].y)", y, x, double=True)
    assert ulps(found, np.arctan2(y, x)).max() <= 3


def test_double_functions_keep_special_values(device):
    cases = [
        ("sin", [0.0, np.inf], [0.0, np.nan]),
        ("acos", [1.0, -1.0, 1.0000001], [0.0, np.pi, np.nan]),
        ("asin", [1.0, 0.0, 2.0], [np.pi / 2, 0.0, np.nan]),
        ("exp", [800.0, -800.0, 0.0, np.nan], [np.inf, 0.0, 1.0, np.nan]),
        ("log", [0.0, -1.0, 1.0, np.inf, 5e-324], [-np.inf, np.nan, 0.0, np.inf, np.log(5e-324)]),
        ("atan", [0.0, np.inf, -np.inf], [0.0, np.pi / 2, -np.pi / 2]),
    ]
    for name, x, expected in cases:
        x = np.array(x)
        found = run(device, '#include "common/double.glsl"', f"double_{name}(a[i].x)", x, x, double=True)
        assert ulps(found, np.array(expected)).max() <= 1
    x, y = np.array([0.0, 0.0, 0.0, 2.0, -1.0, 1.0]), np.array([0.0, 2.0, -1.0, 0.0, 2.0, np.inf])
    found = run(device, '#include "common/double.glsl"', "double_pow(a[i].x, a[i].y)", x, y, double=True)
    assert np.array_equal(found, [1.0, 0.0, np.inf, 1.0, np.nan, 1.0], equal_nan=True)


FLOAT = [
    ("arc", "quadrant_angle(a[i].x, sqrt((1.0 - a[i].x) * (1.0 + a[i].x)))", np.arcsin, (0, 1), 2),
    ("circle", "point_on_circle(a[i].x).x", lambda u: np.cos(2 * np.pi * u), (0, 1), None),
    ("circle", "point_on_circle(a[i].x).y", lambda u: np.sin(2 * np.pi * u), (0, 1), None),
]


@pytest.mark.parametrize("double", [False, True], ids=["float", "double"])
@pytest.mark.parametrize(("file", "expression", "truth", "domain", "bound"), FLOAT, ids=[f[1] for f in FLOAT])
def test_arc_and_circle_are_right_in_both_precisions(device, file, expression, truth, domain, bound, double):
    """The circle is bounded absolutely: its sine and cosine have exact zeros, where ulp of the value mean nothing."""
    x = spread(*domain).astype(np.float64 if double else np.float32)
    text = load_catalogue().includes[f"common/{file}.glsl"]
    head = '#define DOUBLE_PRECISION\n#include "common/double.glsl"\n' + widen(text) if double else text
    found = run(device, head, expression, x, x, double=double)
    expected = truth(x.astype(np.longdouble)).astype(np.float64)
    if bound is None:
        assert np.abs(found - expected).max() <= (2.0**-51 if double else 2.0**-23)
    else:
        assert ulps(found, expected.astype(found.dtype)).max() <= bound


def test_exponential_ratio_is_right_where_its_parts_have_no_float32(device):
    """3/2 exp(x)/a: exp(x) alone is as small as e^-117, 1/a as large as 2^126, the result within e^-30 and e^30."""
    rng = np.random.default_rng(3)
    a = (2.0 ** rng.uniform(-126, 0, 100_000)).astype(np.float32)
    x = (np.log(a.astype(float)) + rng.uniform(-30, 30, len(a))).astype(np.float32)
    head = load_catalogue().includes["common/exponential.glsl"]
    found = run(device, head, "exponential_ratio(0.5, 3.0, a[i].x, 1.0, a[i].y)", x, a, double=False)
    expected = 1.5 * np.exp(x.astype(np.longdouble)) / a.astype(np.longdouble)
    assert ulps(found, expected.astype(np.float32)).max() <= 4
