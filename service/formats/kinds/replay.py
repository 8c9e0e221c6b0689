"""One evaluation from exact inputs, as terminal text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def text(result: Mapping[str, Any]) -> str:
    """Inputs, then every value in float32, its bits, and in float64."""
    lines = [f"{result['technique']} on {result['model']}"]
    lines += [f"  {name} = {value!r}" for name, value in result["parameters"].items()]
    lines += [
        f"  {name:<13} {result[key]}" for name, key in (("wo", "wo"), ("u", "u"), ("wi", "wi_given")) if key in result
    ]
    lines.append(f"  {'':<13} {'float32':<16}{'bits':<14}float64")
    single, double = result["float32"], result["float64"]
    for name in ("wi", "pdf", "brdf", "direction_pdf", "weight", "albedo"):
        columns = zip(_list(single[name]), single["bits"][name], _list(double[name]), strict=True)
        for i, (value, bits, truth) in enumerate(columns):
            label = f"{name}.{'xyz'[i]}" if name == "wi" else name
            lines.append(f"  {label:<13} {_number(value):<16}{bits:<14}{_number(truth)}")
    return "\n".join(lines) + "\n"


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _number(value: float | None) -> str:
    return "not finite" if value is None else f"{value:.9g}"
