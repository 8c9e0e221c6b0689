"""The variant: the one shader that a model, a technique and a job compile to.

Model, technique and job are separate files. Here they become one source: each in a namespace of its own, parameters as
read-only floats, `#line` before each part so that compile errors carry the author's file and line.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

from service import glsl
from service.catalogue import SHADERS, Catalogue, Entry
from service.loops import count_loops
from service.widening import widen

Precision = Literal["float", "double"]

_LANGUAGE = "#version 460\n#extension GL_GOOGLE_cpp_style_line_directive : enable\n"
_PREAMBLE = (
    '#line 1 "variant"\n#include "common/contract.glsl"\n#include "common/finite.glsl"\n'
    '#include "common/random.glsl"\n#include "common/loops.glsl"\n'
)
_DOUBLE = '#define DOUBLE_PRECISION\n#line 1 "variant"\n#include "common/double.glsl"\n'
_NOT_WIDENED = frozenset({"common/double.glsl", "common/random.glsl"})


@dataclass(frozen=True)
class Variant:
    """GLSL text ready to compile, and the names of the floats a cell brings, in the order of the parameter buffer."""

    source: str
    includes: dict[str, str]
    parameters: tuple[str, ...]
    name: str


def compose(catalogue: Catalogue, model: Entry, technique: Entry, job: str, precision: Precision = "float") -> Variant:
    """The source of one job (`statistics` or `probe`) for a model and a technique.

    In double precision every `float` of code, includes and job is a double, buffers too: the float64 truth of the same
    code.
    """
    parameters = tuple(catalogue.parameters_of(model, technique))
    has_albedo = "directional_albedo" in model.declared
    text = "".join(
        [
            _PREAMBLE,
            "".join(f"float parameter_{name};\n" for name in parameters),
            _part(model, "model", model.head.parameters),
            _part(technique, "technique", [*technique.head.parameters, *technique.head.uses]),
            f"#define ALBEDO_OF_VIEW {'model_directional_albedo(wo.z)' if has_albedo else '0.0'}\n",
            f"#define U1_SPLIT {'technique_u1_split(wo)' if 'u1_split' in technique.declared else '0.0'}\n",
            '#line 1 "variant"\n#include "common/weight.glsl"\n',
            f'#line 1 "{job}.comp"\n',
            job_texts()[job],
        ]
    )
    includes = {
        **catalogue.includes,
        "variant/load_parameters.glsl": _loader(parameters),
        "variant/draw_parameters.glsl": _drawer(parameters),
    }
    name = variant_name(model, technique, job, precision)
    if precision == "double":
        includes = {key: part if key in _NOT_WIDENED else widen(part) for key, part in includes.items()}
        return Variant(_LANGUAGE + _DOUBLE + widen(text), includes, parameters, name)
    return Variant(_LANGUAGE + text, includes, parameters, name)


def variant_name(model: Entry, technique: Entry, job: str, precision: Precision = "float") -> str:
    """What errors call a variant."""
    return f"{model.name}+{technique.name}.{job}" + (".double" if precision == "double" else "")


def _part(entry: Entry, prefix: str, parameters: Iterable[str]) -> str:
    names = {name: f"{prefix}_{name}" for name in entry.declared}
    names |= {name: f"parameter_{name}" for name in parameters}
    return f'#line 1 "{entry.origin}"\n{count_loops(glsl.rename(entry.code, names))}\n'


def _loader(parameters: Sequence[str]) -> str:
    """The function that fills the parameters of a cell from the buffer, one row a cell."""
    stride = len(parameters)
    lines = [
        f"    parameter_{name} = parameter_values[cell * {stride}u + {i}u];\n" for i, name in enumerate(parameters)
    ]
    return "void load_parameters(uint cell) {\n" + "".join(lines) + "}\n"


def _drawer(parameters: Sequence[str]) -> str:
    """The function that gives every parameter a random value within its range, and returns their sum.

    The first two come from bits that the caller has, each four of the others from one hash.
    """
    lines = []
    for i, name in enumerate(parameters):
        if i >= 2 and i % 4 == 2:
            lines.append(f"    bits = pcg4d(uvec4(counter, {i}u, 3u));\n")
        word = "xyzw"[i if i < 2 else (i - 2) % 4]
        unit = f"(float(int(bits.{word} >> 8u)) * 5.9604644775390625e-8)"
        lines.append(f"    parameter_{name} = ranges[{i}].x + ranges[{i}].y * {unit};\n")
    total = " + ".join(f"parameter_{name}" for name in parameters) or "0.0"
    head = "float draw_parameters(uvec2 given, uvec2 counter) {\n    uvec4 bits = uvec4(given, 0u, 0u);\n"
    return head + "".join(lines) + f"    return {total};\n}}\n"


@cache
def job_texts() -> dict[str, str]:
    """The text of every job by its name."""
    return {path.stem: path.read_text(encoding="utf-8") for path in SHADERS.glob("*.comp")}
