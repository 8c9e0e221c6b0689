"""Error against run time, in every format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from service.formats.metrology import plain
from service.formats.table_summary import run_lines

if TYPE_CHECKING:
    import numpy as np

    from service.figures import AnyChart

Result = Mapping[str, Any]
_VALUES = ("samples", "time_ms", "device_ms", "relative_rmse", "variance_relative_rmse")


def rows(result: Result) -> tuple[list[str], Iterator[list[Any]]]:
    """The columns and one row for each series, angle and count."""
    series = result["series"]
    names = list(dict.fromkeys(name for one in series for name in one["parameters"]))
    columns = ["model", "technique", "estimator", *names, "theta_o_deg", *_VALUES, "floor", "call_ns", "status"]

    def each() -> Iterator[list[Any]]:
        for one in series:
            head = [one["model"], one["technique"], one["estimator"], *(one["parameters"].get(name) for name in names)]
            for at, angle in enumerate(one["theta_o_deg"]):
                for number, count in enumerate(one["samples"]):
                    values = [count, one["time_ms"][number], one["device_ms"][number]]
                    values += [one[name][number][at] for name in _VALUES[3:]]
                    yield [*head, angle, *values, one["floor"][at], one["call_ns"], one["verdict"]["status"]]

    return columns, each()


def arrays(result: Result) -> dict[str, np.ndarray]:
    """The columns of `rows`, one value a series, angle and count; a null is NaN."""
    import numpy as np

    from service.formats import strict_json

    columns, each = rows(result)
    table = list(zip(*each, strict=True)) or [() for _ in columns]
    out = {}
    for name, values in zip(columns, table, strict=True):
        kind = np.str_ if any(isinstance(value, str) for value in values) else np.float64
        out[name] = np.array([np.nan if value is None else value for value in values], dtype=kind)
    for name in ("scene", "ranking", "efficiency", "run"):
        out[name] = np.array(strict_json.line(result.get(name)), dtype=np.str_)
    return out


def chart(result: Result) -> AnyChart:
    """Error against run time and samples, and the estimators side by side."""
    from service.figures.convergence import convergence_chart

    return convergence_chart(result)


def text(result: Result) -> str:
    """Cost, slopes and times to the target, the ranking and the efficiency table for a terminal."""
    target = result["target_error"]
    parts = [f"error against run time, relative RMS error of the directional albedo, target {target:.3g}"]
    fitted = [one for one in result["series"] if "slope" in one]
    if fitted:
        parts.append(_grid([_HEAD, *(row for one in fitted for row in _fitted_rows(one))]))
    parts += [_ranking(result), _efficiency(result["efficiency"]), _findings(result["series"])]
    parts.append(run_lines(result, 120))
    return "\n\n".join(part for part in parts if part) + "\n"


_HEAD = ["technique", "by", "theta_o_deg", "slope", "interval", "ms to target", "interval", "floor", "call ns"]


def _fitted_rows(one: Mapping[str, Any]) -> Iterator[list[str]]:
    name = " ".join([one["technique"], *(f"{key}={value:.6g}" for key, value in one["parameters"].items())])
    for at, angle in enumerate(one["theta_o_deg"]):
        slope, time = one["slope"][at], one["time_to_target_ms"][at]
        yield [
            name,
            one["estimator"],
            f"{angle:.6g}",
            "-" if slope is None else f"{slope:.3f}",
            _span(one["slope_interval"][at], ".3f"),
            ("-" if slope is None else "never") if time is None else plain(time, 3),
            _span(one["time_to_target_interval_ms"][at], ".3g"),
            "-" if not one["floor"][at] else plain(one["floor"][at], 3),
            f"{one['call_ns']:.1f}",
        ]


def _span(pair: Sequence[float] | None, form: str) -> str:
    return "-" if pair is None else f"{pair[0]:{form}} to {pair[1]:{form}}"


def _ranking(result: Result) -> str:
    lines = ["first to the target, by run time"]
    for entry in result["ranking"]:
        values = "".join(f"{name} {value:.6g}, " for name, value in entry["parameters"].items())
        tied = {tuple(pair) for pair in entry["tied"]}
        order = entry["order"]
        text = order[0] if order else "none"
        for faster, slower in pairwise(order):
            text += f" {'~' if (faster, slower) in tied else '<'} {slower}"
        unranked = f"; not ranked: {', '.join(entry['unranked'])}" if entry["unranked"] else ""
        lines.append(f"  {values}{entry['theta_o_deg']:.6g} deg: {text}{unranked}")
    if any(entry["tied"] for entry in result["ranking"]):
        lines.append("  a ~ b: not distinguishable")
    return "\n".join(lines)


def _efficiency(table: Mapping[str, Any]) -> str:
    """Who wins at each angle and set of parameters, and by what factor over the second."""
    if len(table["techniques"]) < 2:
        return ""
    varied = [name for name in table["parameters"][0] if len({row[name] for row in table["parameters"]}) > 1]
    head = [*varied, *(f"{angle:g} deg" for angle in table["theta_o_deg"])]
    grid = [head]
    for row, winners, leads in zip(table["parameters"], table["winner"], table["lead"], strict=True):
        grid.append(
            [
                *(f"{row[name]:.6g}" for name in varied),
                *(_won(name, lead) for name, lead in zip(winners, leads, strict=True)),
            ]
        )
    title = "most efficient, 1 / (relative variance x time), and its lead over the second"
    return f"{title}\n{_grid(grid)}"


def _won(name: str | None, lead: float | None) -> str:
    if name is None:
        return "-"
    return _short(name) if lead is None else f"{_short(name)} {lead:.2g}x"


def _short(name: str) -> str:
    return {"ltc-nonnegative": "ltc-nn"}.get(name, name)


def _findings(series: Sequence[Mapping[str, Any]]) -> str:
    lines = {
        f"{one['technique']}: {finding['name']}: {finding['message']}"
        for one in series
        for finding in one["verdict"]["findings"]
    }
    return "\n".join(sorted(lines))


def _grid(rows: Sequence[Sequence[str]]) -> str:
    sizes = [max(len(row[index]) for row in rows) for index in range(len(rows[0]))]
    return "\n".join(
        "  ".join(cell.ljust(size) for cell, size in zip(row, sizes, strict=True)).rstrip() for row in rows
    )
