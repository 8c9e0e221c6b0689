"""Checks, as terminal text and CSV."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

_WIDTH = 120
_MARKS = {"pass": "pass", "fail": "FAIL", "not-applicable": "-"}


def rows(result: Mapping[str, Any]) -> tuple[list[str], Iterator[list[Any]]]:
    """One row a check."""
    columns = ["model", "technique", "name", "status", "message", "power"]

    def each() -> Iterator[list[Any]]:
        for check in result["checks"]:
            yield [result["model"], *(check[name] for name in columns[1:])]

    return columns, each()


def text(result: Mapping[str, Any]) -> str:
    """A line a check with its message; below a failure its power and the command that shows it again."""
    lines = [f"{result['subject']}: {result['status']}", ""]
    groups = dict.fromkeys(check["technique"] for check in result["checks"])
    for group in groups:
        lines.append(f"model {result['model']}" if group is None else f"{group} on {result['model']}")
        for check in result["checks"]:
            if check["technique"] == group:
                lines += _check_lines(check)
        lines.append("")
    if result.get("stability"):
        lines += ["edge grid, float32 against float64", *_stability(result["stability"]), ""]
    run = result["run"]
    lines.append(
        f"{run['device']}, {run['elapsed_ms'] / 1e3:.1f} s, seed {run['seed']}" + (", quick" if run["quick"] else "")
    )
    return "\n".join(lines) + "\n"


def _stability(stability: Mapping[str, Any]) -> list[str]:
    """The check of each technique, and how many points are beyond the limit for which reason."""
    lines = []
    for check in stability["checks"]:
        lines += _check_lines(check | {"name": check["technique"]})
        for e in stability["exceptions"]:
            if e["technique"] == check["technique"]:
                words = f"{e['quantity']}, {e['points']:,} points up to {e['worst_ulp']:.3g} ulp: {e['reason']}"
                lines += textwrap.wrap(words, _WIDTH, initial_indent=" " * 27, subsequent_indent=" " * 29)
    return lines


def _check_lines(check: Mapping[str, Any]) -> list[str]:
    """The lines of one check."""
    head = f"  {_MARKS[check['status']]:<5} {check['name']:<18} "
    lines = textwrap.wrap(check["message"], _WIDTH, initial_indent=head, subsequent_indent=" " * len(head))
    if check["status"] == "fail":
        indent = " " * len(head)
        lines += textwrap.wrap(f"looked at: {check['power']}", _WIDTH, initial_indent=indent, subsequent_indent=indent)
        if check["replay"]:
            lines.append(f"{indent}replay: {check['replay']['command']}")
    return lines
