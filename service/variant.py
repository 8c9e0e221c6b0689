"""The variant: the one shader that a model, a technique and a job compile to.

Model, technique and job are separate files. Here they become one source: each in a namespace of its own, parameters as
read-only floats, `#line` before each part so that compile errors carry the author's file and line. What such a shader
leaves out is chosen after compilation, by specialization constants: see service/structure.py.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

from service import glsl
from service.catalogue import SHADERS, Catalogue, Entry
from service.loops import count_loops
from service.structure import (
    TECHNIQUE_ID,
    Role,
    parameter_ids,
    parameter_slots,
    read_parameters,
    technique_prefixes,
)
from service.widening import widen

Precision = Literal["float", "double"]

_LANGUAGE = "#version 460\n#extension GL_GOOGLE_cpp_style_line_directive : enable\n"
_PREAMBLE = (
    '#line 1 "variant"\n#include "common/contract.glsl"\n#include "common/finite.glsl"\n'
    '#include "common/random.glsl"\n#include "common/loops.glsl"\n#include "common/structure.glsl"\n'
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


def compose(
    catalogue: Catalogue, model: Entry, techniques: Sequence[Entry], job: str, precision: Precision = "float"
) -> Variant:
    """The source of one job (`statistics`, `probe`, ...) for a model and a technique, or several to choose from.

    In double precision every `float` of code, includes and job is a double, buffers too: the float64 truth of the same
    code.
    """
    parameters = tuple({name: None for technique in techniques for name in catalogue.parameters_of(model, technique)})
    slots = parameter_slots(model, techniques)
    prefixes = technique_prefixes(techniques)
    text = "".join(
        [
            _PREAMBLE,
            "".join(f"float {prefix}_{name};\n" for prefix, name in slots),
            _part(model, "model", "model"),
            *(_part(one, "technique", prefix) for one, prefix in zip(techniques, prefixes, strict=True)),
            '#line 1 "variant"\n',
            _chooser(prefixes) if len(techniques) > 1 else "",
            _optional("ALBEDO_OF_VIEW", "directional_albedo", model, "model_directional_albedo(wo.z)"),
            _optional("U1_SPLIT", "u1_split", techniques[0], f"{prefixes[0]}_u1_split(wo)"),
            '#include "common/weight.glsl"\n',
            f'#line 1 "{job}.comp"\n',
            job_texts()[job],
        ]
    )
    includes = {
        **catalogue.includes,
        "variant/load_parameters.glsl": _loader(parameters, slots, fixable=precision == "float"),
        "variant/draw_parameters.glsl": _drawer(parameters, slots),
    }
    name = variant_name(model, techniques, job, precision)
    if precision == "double":
        includes = {key: part if key in _NOT_WIDENED else widen(part) for key, part in includes.items()}
        return Variant(_LANGUAGE + _DOUBLE + widen(text), includes, parameters, name)
    return Variant(_LANGUAGE + text, includes, parameters, name)


def variant_name(model: Entry, techniques: Sequence[Entry], job: str, precision: Precision = "float") -> str:
    """What errors call a variant."""
    name = f"{model.name}+{'+'.join(technique.name for technique in techniques)}.{job}"
    return f"{name}.double" if precision == "double" else name


def _part(entry: Entry, role: Role, prefix: str) -> str:
    names = {name: f"{prefix}_{name}" for name in (*entry.declared, *read_parameters(entry, role))}
    origin = re.sub(r'["\\\r\n]', "_", entry.origin) if entry.own else entry.origin  # what may stand in a #line
    return f'#line 1 "{origin}"\n{count_loops(glsl.rename(entry.code, names))}\n'


def _optional(macro: str, function: str, entry: Entry, call: str) -> str:
    """A macro that calls a function which a file need not have; 0 where it has none."""
    return f"#define {macro} {call if function in entry.declared else '0.0'}\n"


def _chooser(prefixes: Sequence[str]) -> str:
    """The function that draws with the technique of the specialization constant."""
    calls = "".join(
        f"    if (TECHNIQUE == {i}u) return {prefix}_sample_direction(wo, u);\n"
        for i, prefix in enumerate(prefixes[:-1])
    )
    return (
        f"layout(constant_id = {TECHNIQUE_ID}) const uint TECHNIQUE = 0u;\n"
        f"DirectionSample technique_sample_direction(vec3 wo, vec2 u) {{\n{calls}"
        f"    return {prefixes[-1]}_sample_direction(wo, u);\n}}\n"
    )


def _loader(parameters: Sequence[str], slots: Sequence[tuple[str, str]], fixable: bool) -> str:
    """The function that fills the parameters of a cell from the buffer, one row a cell, but those that are fixed."""
    constants, lines = [], []
    for i, (prefix, name) in enumerate(slots):
        value = f"parameter_values[cell * {len(parameters)}u + {parameters.index(name)}u]"
        if fixable:
            is_fixed, fixed = parameter_ids(i)
            constants.append(f"layout(constant_id = {is_fixed}) const bool IS_FIXED_{i} = false;\n")
            constants.append(f"layout(constant_id = {fixed}) const float FIXED_{i} = 0.0;\n")
            value = f"IS_FIXED_{i} ? FIXED_{i} : {value}"
        lines.append(f"    {prefix}_{name} = {value};\n")
    return "".join(constants) + "void load_parameters(uint cell) {\n" + "".join(lines) + "}\n"


def _drawer(parameters: Sequence[str], slots: Sequence[tuple[str, str]]) -> str:
    """The function that gives every parameter a random value within its range, and returns their sum.

    The first two come from bits that the caller has, each four of the others from one hash.
    """
    lines = []
    for i, name in enumerate(parameters):
        if i >= 2 and i % 4 == 2:
            lines.append(f"    bits = pcg4d(uvec4(counter, {i}u, 3u));\n")
        word = "xyzw"[i if i < 2 else (i - 2) % 4]
        unit = f"(float(int(bits.{word} >> 8u)) * 5.9604644775390625e-8)"
        lines.append(f"    float parameter_{name} = ranges[{i}].x + ranges[{i}].y * {unit};\n")
    lines += [f"    {prefix}_{name} = parameter_{name};\n" for prefix, name in slots]
    total = " + ".join(f"parameter_{name}" for name in parameters) or "0.0"
    head = "float draw_parameters(uvec2 given, uvec2 counter) {\n    uvec4 bits = uvec4(given, 0u, 0u);\n"
    return head + "".join(lines) + f"    return {total};\n}}\n"


@cache
def job_texts() -> dict[str, str]:
    """The text of every job by its name."""
    return {path.stem: path.read_text(encoding="utf-8") for path in SHADERS.glob("*.comp")}
