"""One evaluation again, from exact inputs: every value in float32 and float64, with its bits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from service.checks.selection import Subject
from service.engine import Engine
from service.errors import BadInput, Problem
from service.inputs import bits
from service.plain_data import plain_data
from service.probe import Probe, Values


def parse_floats(field: str, text: str, count: int) -> list[float]:
    """Float32 numbers from a list of bit patterns (0x3f800000) or decimals; BadInput names the field."""
    parts = text.split(",")
    try:
        values = [
            float(np.array([int(part, 16)], np.uint32).view(np.float32)[0])
            if part.strip().startswith("0x")
            else float(part)
            for part in parts
        ]
    except (ValueError, OverflowError):
        raise BadInput(Problem(field, text, f"{count} numbers or bit patterns such as 0x3f800000")) from None
    if len(values) != count:
        raise BadInput(Problem(field, text, f"{count} numbers"))
    return values


def replay_inputs(
    engine: Engine, subject: Subject, wo: Sequence[float], u: Sequence[float] | None, wi: Sequence[float] | None
) -> dict[str, Any]:
    """A result of kind `replay`: evaluates the subject's first technique at these inputs (float32)."""
    probe = Probe(engine, subject.model, subject.techniques[0], subject.fixed)
    row = np.array([[p.default for p in probe.declared.values()]], np.float32)
    view = np.array([wo], np.float32)
    if u is not None:
        value = np.array([u], np.float32)
        single, double = (probe.draw(view, value, row, precision) for precision in ("float", "double"))
    else:
        value = np.array([wi], np.float32)
        single, double = (probe.evaluate(view, value, row, precision) for precision in ("float", "double"))
    return {
        "kind": "replay",
        "subject": subject.given,
        "model": subject.model.name,
        "technique": probe.technique.name,
        "parameters": plain_data(dict(zip(probe.names, row[0], strict=True))),
        "wo": plain_data(view[0]),
        ("u" if u is not None else "wi_given"): plain_data(value[0]),
        "float32": _values(single) | {"bits": _bits(single)},
        "float64": _values(double),
    }


def _values(values: Values) -> dict[str, Any]:
    out: dict[str, Any] = {name: plain_data(getattr(values, name)[0]) for name in values.__dataclass_fields__}
    return out | {"nonfinite": [name for name in out if not np.isfinite(getattr(values, name)[0]).all()]}


def _bits(values: Values) -> dict[str, list[str]]:
    return {name: bits(getattr(values, name)[0]) for name in values.__dataclass_fields__}
