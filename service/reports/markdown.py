"""A report card as Markdown, for the text of a pull request."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_MARKS = {"pass": "pass", "fail": "**FAIL**", "not-applicable": "n/a"}


def render(result: Mapping[str, Any]) -> str:
    """The card of a result of kind `check` or `stability`."""
    lines = [f"# {title(result)}: {result['status']}", ""]
    checks = result["checks"] if result["kind"] == "check" else []
    for group in dict.fromkeys(check["technique"] for check in checks):
        lines += [f"## {group_title(result, group)}", "", "| check | verdict | what was found |", "|---|---|---|"]
        lines += [_row(check) for check in checks if check["technique"] == group]
        lines.append("")
        lines += _failures([check for check in checks if check["technique"] == group])
    stability = result if result["kind"] == "stability" else result.get("stability")
    if stability:
        lines += _stability(stability)
    run = result["run"]
    lines += ["", f"{run['device']}, {run['driver']}; {run['elapsed_ms'] / 1e3:.1f} s" + _seed(run), ""]
    return "\n".join(lines)


def title(result: Mapping[str, Any]) -> str:
    """What the card is about."""
    return str(result["subject"]) if result["kind"] == "check" else f"stability of {result['scene']['model']}"


def group_title(result: Mapping[str, Any], technique: str | None) -> str:
    """The heading of one technique's checks, or of the model's."""
    return f"model `{result['model']}`" if technique is None else f"`{technique}` on `{result['model']}`"


def _seed(run: Mapping[str, Any]) -> str:
    if "seed" not in run:
        return ""
    return f"; seed {run['seed']}" + ("; quick, at lower power" if run["quick"] else "")


def _row(check: Mapping[str, Any]) -> str:
    return f"| {check['name']} | {_MARKS[check['status']]} | {_cell(check['message'])} |"


def _failures(checks: list[Mapping[str, Any]]) -> list[str]:
    lines: list[str] = []
    for check in checks:
        if check["status"] == "fail":
            lines += [f"**{check['name']}**: {check['message']}", "", f"Looked at: {check['power']}.", ""]
            if check["replay"]:
                lines += ["```", check["replay"]["command"], "```", ""] if "command" in check["replay"] else []
    return lines


def _stability(stability: Mapping[str, Any]) -> list[str]:
    lines = ["## Edge grid: float32 against float64", ""]
    lines += [f"- {check['technique']}: {_MARKS[check['status']]}, {check['message']}" for check in stability["checks"]]
    if stability["exceptions"]:
        lines += [
            "",
            "| technique | quantity | points beyond 8 ulp | worst, ulp | by rounded inputs, ulp "
            "| by a rounded direction, ulp | reason |",
        ]
        lines += ["|---|---|---:|---:|---:|---:|---|"]
        lines += [
            f"| {e['technique']} | {e['quantity']} | {e['points']:,} | {e['worst_ulp']:.3g} | "
            f"{e['by_rounded_inputs_ulp']:.3g} | {_ulp(e['by_rounded_direction_ulp'])} | {_cell(e['reason'])} |"
            for e in stability["exceptions"]
        ]
    return lines


def _ulp(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
