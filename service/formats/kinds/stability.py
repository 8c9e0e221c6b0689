"""Stability, as terminal text and CSV."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

_WIDTH = 120


def rows(result: Mapping[str, Any]) -> tuple[list[str], Iterator[list[Any]]]:
    """One row a region."""
    columns = ["technique", "name", "wi", "points", "nonfinite", "beyond_float32", "above_limit", "worst_ulp"]
    return columns, ([region[name] for name in columns] for region in result["regions"])


def text(result: Mapping[str, Any]) -> str:
    """The verdict of each technique, its regions, exceptions and stiffest places."""
    lines = []
    for technique in dict.fromkeys(check["technique"] for check in result["checks"]):
        lines += _technique_lines(result, technique)
    run = result["run"]
    lines.append(f"{run['device']}, {run['elapsed_ms'] / 1e3:.1f} s")
    return "\n".join(lines) + "\n"


def _technique_lines(result: Mapping[str, Any], technique: str) -> list[str]:
    """What a stability result says of one technique."""
    (check,) = (c for c in result["checks"] if c["technique"] == technique)
    lines = [f"{technique}: {check['status']}, {check['message']}", ""]
    lines.append(f"  {'region':<42}{'points':>9}{'not finite':>12}{'over 8 ulp':>12}{'worst ulp':>12}")
    for region in result["regions"]:
        if region["technique"] == technique:
            name = region["name"] if region["wi"] == "drawn" else f"{region['name']}, wi given"
            lines.append(
                f"  {name:<42}{region['points']:>9,}{region['nonfinite']:>12,}{region['above_limit']:>12,}"
                f"{region['worst_ulp']:>12.3g}"
            )
    listed = [e for e in result["exceptions"] if e["technique"] == technique]
    lines += ["", "  beyond 8 ulp:" if listed else "  nothing is beyond 8 ulp inside the ranges"]
    for e in listed:
        of_direction = e["by_rounded_direction_ulp"]
        lines += textwrap.wrap(
            f"{e['quantity']}, {e['points']:,} points: {e['reason']} (worst {e['worst_ulp']:.3g} ulp; one rounding of "
            f"the inputs: {e['by_rounded_inputs_ulp']:.3g} ulp"
            + (")" if of_direction is None else f", of the direction: {of_direction:.3g} ulp)"),
            _WIDTH, initial_indent="    ", subsequent_indent="      ",
        )  # fmt: skip
        lines += textwrap.wrap(_place(e["worst"]), _WIDTH, initial_indent="      at ", subsequent_indent="         ")
    lines += ["", f"  {'condition number':<20}{'of':<16}{'median':>10}{'worst':>12}   at"]
    for c in result["stiffness"]:
        if c["technique"] == technique:
            lines.append(
                f"  {c['input']:<20}{c['quantity']:<16}{c['median']:>10.3g}{c['worst']:>12.3g}   {_inputs(c['inputs'])}"
            )
    lines.append("")
    return lines


def _place(worst: Mapping[str, Any]) -> str:
    """The worst point: inputs, value and truth."""
    inputs = worst["inputs"]
    kind = "u" if "u_bits" in inputs else "wi"
    return (
        f"{_inputs(inputs)} wo={','.join(inputs['wo_bits'])} {kind}={','.join(inputs[kind + '_bits'])}:"
        f" {_number(worst['value'])}, true {_number(worst['expected'])}"
    )


def _inputs(inputs: Mapping[str, Any]) -> str:
    parameters = " ".join(f"{name}={value:.9g}" for name, value in inputs["parameters"].items())
    numbers = " u=" + ",".join(f"{value:.4g}" for value in inputs["u"]) if "u" in inputs else ""
    return f"{inputs['theta_o_deg']:.6g} deg {parameters}{numbers}"


def _number(value: Any) -> str:
    if isinstance(value, list):
        return "(" + ", ".join(_number(part) for part in value) + ")"
    return "not finite" if value is None else f"{value:.9g}"
