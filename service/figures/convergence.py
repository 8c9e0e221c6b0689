"""Error against run time and against samples, angle beside angle; and the three estimators against each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import altair as alt

from service.figures import scales, style
from service.figures.layout import AnyChart
from service.figures.panel import Lines
from service.figures.points import Row

ESTIMATORS = {"mc": "random numbers (mc)", "qmc": "scrambled Sobol' (qmc)", "quadrature": "quadrature"}
_ESTIMATOR_COLOURS = ("#D55E00", "#0072B2", "#009E73")
_LEAST_ERROR = 1e-7  # float32 rounding; nothing below it says anything


def convergence_chart(result: Mapping[str, Any], title: str | None = None) -> AnyChart:
    """The chart of a result of kind "convergence".

    First rows: relative RMS error over run time and over samples, a panel an angle, colours are techniques, dotted
    rules the bias that no number of samples removes. Last rows: error of mean and variance over device time, a panel a
    technique, colours are estimators. Raises ValueError where the result has no series.
    """
    series = result["series"]
    if not series:
        raise ValueError("there is nothing to draw: the result has no series")
    method = "mc" if any(one["estimator"] == "mc" for one in series) else series[0]["estimator"]
    mine = [one for one in series if one["estimator"] == method]
    rows: list[alt.HConcatChart] = [
        _by_angle(mine, result["target_error"], "time_ms", "run time (ms), samples times cost of a call"),
        _by_angle(mine, result["target_error"], "samples", "samples"),
    ]
    if len({one["estimator"] for one in series}) > 1:
        rows.append(_by_technique(series, "relative_rmse", "error of the mean"))
        rows.append(_by_technique(series, "variance_relative_rmse", "error of the variance"))
    chart = alt.vconcat(*rows).resolve_scale(color="independent", strokeDash="independent")
    drawn: AnyChart = chart.properties(title=_heading(result, title), config=style.config())
    return drawn


def _heading(result: Mapping[str, Any], title: str | None) -> alt.TitleParams:
    first = result["series"][0]
    parameters = ", ".join(f"{name} {value:.6g}" for name, value in first["parameters"].items())
    scene, run = result.get("scene") or {}, result.get("run") or {}
    facts = [
        f"relative RMS error over {max(one['replicates'] for one in result['series'])} replicates",
        f"seed {(scene.get('estimator') or {}).get('seed')}",
        f"{run.get('device')}, {run.get('threads')} threads",
    ]
    key = [
        "Grey rule: target. Dotted: bias floor. Upper rows: what a renderer pays. Lower rows: what each estimator of "
        "the statistics took on the device for one angle, RMS over the angles."
    ]
    return alt.TitleParams(
        text=title or f"Error against run time, {first['model']}, {parameters}", subtitle=[" · ".join(facts), *key]
    )


def _name(one: Mapping[str, Any], series: Sequence[Mapping[str, Any]]) -> str:
    varied = [name for name in one["parameters"] if len({repr(other["parameters"].get(name)) for other in series}) > 1]
    endless = " (infinite variance)" if one["verdict"]["status"] == "infinite-variance" else ""
    return " ".join([one["technique"], *(f"{name} {one['parameters'][name]:.6g}" for name in varied)]) + endless


def _technique_lines(series: Sequence[Mapping[str, Any]]) -> Lines:
    labels = list(dict.fromkeys(_name(one, series) for one in series))
    names = [next(one["technique"] for one in series if _name(one, series) == label) for label in labels]
    looks = style.technique_styles(names if len(set(names)) == len(labels) else labels)
    colours, dashes = zip(*looks, strict=True)
    return Lines("technique", labels, colours, dashes)


def _by_angle(series: Sequence[Mapping[str, Any]], target: float, across: str, title: str) -> alt.HConcatChart:
    """A panel for each view angle, all of one range."""
    lines = _technique_lines(series)
    angles = series[0]["theta_o_deg"]
    panels: list[list[Row]] = [
        [
            {"technique": _name(one, series), "x": x, "error": row[at], "number": number}
            for one in series
            for number, (x, row) in enumerate(zip(one[across], one["relative_rmse"], strict=True))
            if _drawable(row[at])
        ]
        for at in range(len(angles))
    ]
    floors: list[list[Row]] = [
        [{"technique": _name(one, series), "error": one["floor"][at]} for one in series if one["floor"][at]]
        for at in range(len(angles))
    ]
    x, y = _axes([row for panel in panels for row in panel], title, "relative RMS error of the albedo", target)
    charts = []
    for angle, rows, bias in zip(angles, panels, floors, strict=True):
        layers = [_rule(target, y)]
        if bias:
            floor = alt.Chart(alt.InlineData(values=bias)).mark_rule(strokeDash=[2, 2.5], strokeWidth=1.3)
            layers.append(floor.encode(y=_same(y), color=lines.colour()))
        layers.append(_curve(rows, x, y, lines))
        label = style.part_title(f"{scales.THETA_O} = {angle:.6g}°")
        charts.append(alt.LayerChart(layer=layers, width=style.PANEL_WIDTH, height=style.PANEL_HEIGHT, title=label))
    return alt.hconcat(*charts)


def _by_technique(series: Sequence[Mapping[str, Any]], column: str, title: str) -> alt.HConcatChart:
    """A panel for each technique with a finite variance: error over device time, RMS over the angles."""
    mine = [one for one in series if one["verdict"]["status"] != "infinite-variance"] or list(series)
    present = [name for name in ESTIMATORS if any(one["estimator"] == name for one in mine)]
    labels = [ESTIMATORS[name] for name in present]
    colours = [_ESTIMATOR_COLOURS[list(ESTIMATORS).index(name)] for name in present]
    lines = Lines("estimator", labels, colours)
    groups: dict[str, list[Row]] = {}
    for one in mine:
        rows = groups.setdefault(_name(one, mine), [])
        for number, (x, errors) in enumerate(zip(one["device_ms"], one[column], strict=True)):
            finite = [error for error in errors if error is not None]
            value = math.sqrt(sum(error**2 for error in finite) / len(finite)) if finite else None
            if _drawable(value):
                rows.append({"estimator": ESTIMATORS[one["estimator"]], "x": x, "error": value, "number": number})
    x, y = _axes([row for rows in groups.values() for row in rows], "device time for one angle (ms)", title, None)
    charts = [
        alt.LayerChart(
            layer=[_curve(rows, x, y, lines)],
            width=style.PANEL_WIDTH,
            height=style.PANEL_HEIGHT,
            title=style.part_title(name),
        )
        for name, rows in groups.items()
    ]
    return alt.hconcat(*charts)


def _drawable(error: float | None) -> bool:
    """Whether an error can stand on a logarithmic axis and says something."""
    return error is not None and error > _LEAST_ERROR


def _axes(rows: Sequence[Row], across: str, up: str, target: float | None) -> tuple[alt.X, alt.Y]:
    scale, axis = scales.log_scale([row["x"] for row in rows])
    x = alt.X("x:Q", scale=scale, axis=axis, title=across)
    scale, axis = scales.log_scale([row["error"] for row in rows] + ([target] if target else []))
    return x, alt.Y("error:Q", scale=scale, axis=axis, title=up)


def _same(y: alt.Y) -> alt.Y:
    return alt.Y("error:Q", scale=y["scale"], axis=y["axis"], title=y["title"])


def _rule(target: float, y: alt.Y) -> alt.Chart:
    rule = alt.Chart(alt.InlineData(values=[{"error": target}])).mark_rule(color=style.GREY, strokeWidth=0.8)
    chart: alt.Chart = rule.encode(y=_same(y))
    return chart


def _curve(rows: Sequence[Row], x: alt.X, y: alt.Y, lines: Lines) -> alt.Chart:
    tooltip = [
        alt.Tooltip(f"{lines.field}:N"),
        alt.Tooltip("x:Q", format=".4~g"),
        alt.Tooltip("error:Q", format=".3~g"),
    ]
    mark = alt.Chart(alt.InlineData(values=list(rows))).mark_line(strokeWidth=1.8, clip=True, point={"size": 14})
    chart: alt.Chart = mark.encode(x=x, y=y, color=lines.colour(), tooltip=tooltip, order="number:Q", **lines.dash())
    return chart
