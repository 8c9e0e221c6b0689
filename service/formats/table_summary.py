"""What stands below the tables: what the signs mean, a line for each series with its findings, and the run."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from service.formats.metrology import plain
from service.formats.series import Series, swept_value

_INDENT = "    "


def name_of(one: Series, names: Sequence[str]) -> str:
    """The technique with the values of what is swept: `cosine roughness=0.25`."""
    return " ".join([one.technique, *(f"{name}={swept_value(one, name)}" for name in names)])


def legend(series: Sequence[Series], names: Sequence[str], width: int) -> str:
    """What the signs in the tables mean, for those that occur."""
    lines = []
    if any(one.values(name) for one in series for name in ("mean_stderr", "variance_stderr")):
        lines.append("0.9923(4): 0.9923 with a standard error of 0.0004.")
    if any(one.method == "quadrature" for one in series):
        lines.append("quadrature: in place of standard errors, bounds of the error; samples are nodes, at the most.")
    if any(one.values("max_weight") and (one.reference("max_weight") or any(one.unbounded_weight)) for one in series):
        lines.append("12.3 / 57.3: the largest sampled weight, and the largest there is.")
    endless = [one for one in series if one.values("variance") and any(one.infinite_variance)]
    if any(one.method != "quadrature" for one in endless):
        lines.append("inf [8.21]: the variance is infinite; 8.21 is what this run sampled and has no limit.")
    if endless:
        lines += [text for text in (_tail(one, names) for one in endless) if text]
    return "\n".join(row for line in lines for row in textwrap.wrap(line, width, subsequent_indent=_INDENT))


def _tail(one: Series, names: Sequence[str]) -> str:
    known = [
        (strength, angle) for strength, angle in zip(one.tail_strength or [], one.theta_o_deg, strict=False) if strength
    ]
    if not known:
        return ""
    strength, angle = max(known)
    return f"{_INDENT}{name_of(one, names)}: tail strength up to {plain(strength, 3)}, at {angle:.6g} deg."


def summary(series: Sequence[Series], names: Sequence[str], width: int) -> str:
    """A line for each series (samples, time, speed, verdict), the messages of its findings below it."""
    head = ["series", "samples per angle", "nonfinite", "device ms", "Msamples/s", "verdict"]
    rows = [head, *(_summary_row(one, names) for one in series)]
    if any(one.method != "mc" for one in series):
        for row, word in zip(rows, ["estimator", *(one.method for one in series)], strict=True):
            row.insert(1, word)
    sizes = [max(len(row[index]) for row in rows) for index in range(len(head))]
    lines = []
    for row, one in zip(rows, [None, *series], strict=True):
        cells = [row[0].ljust(sizes[0])]
        cells += [cell.rjust(size) for cell, size in zip(row[1:-1], sizes[1:-1], strict=True)]
        lines.append("  ".join([*cells, row[-1]]))
        for finding in one.findings if one else []:
            text = f"{finding.get('name')}: {finding.get('message', '')}"
            lines += textwrap.wrap(text, width, initial_indent=_INDENT, subsequent_indent=_INDENT * 2)
    return "\n".join(lines) if series else ""


def _summary_row(one: Series, names: Sequence[str]) -> list[str]:
    samples = [value for value in one.values("samples") or [] if value is not None]
    nonfinite = one.values("nonfinite")
    elapsed = one.raw.get("device_ms")
    known = elapsed and samples and one.method != "quadrature"
    speed = f"{sum(samples) / elapsed / 1e3:.1f}" if known else "-"
    return [
        name_of(one, names),
        _span(samples),
        "-" if nonfinite is None else f"{sum(value or 0 for value in nonfinite):,}",
        "-" if elapsed is None else f"{elapsed:.1f}",
        speed,
        one.status or "-",
    ]


def _span(samples: Sequence[int]) -> str:
    if not samples:
        return "-"
    low, high = min(samples), max(samples)
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def run_lines(result: Mapping[str, Any], width: int) -> str:
    """The device, the times and what the shader leaves out."""
    run = result.get("run") or {}
    times = (("elapsed", "elapsed_ms"), ("device", "device_ms"), ("compile", "compile_ms"))
    lines = [
        f"device    {run.get('device') or '-'}",
        f"driver    {run.get('driver') or '-'}",
        "time      " + ", ".join(f"{name} {run[key]:.1f} ms" for name, key in times if run.get(key) is not None),
    ]
    if "left_out" in result:
        series = len(result.get("series") or [])
        lines.append("left out  " + ("; ".join(_left_out(entry, series) for entry in result["left_out"]) or "nothing"))
    return "\n".join(
        row for line in lines for row in textwrap.wrap(line, width, subsequent_indent=" " * 10, break_long_words=True)
    )


def _left_out(entry: Mapping[str, Any], series: int) -> str:
    where = entry.get("series", range(series))
    some = f", {len(where)} of {series} series" if len(where) < series else ""
    return f"{entry['feature']} ({entry['reason']}{some})"
