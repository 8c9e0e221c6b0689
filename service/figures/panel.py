"""One panel: a statistic of the weight over the view angle, for several series."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import altair as alt

from service.figures import scales, style
from service.figures.points import Row

TITLES = {"variance": "variance of the weight", "max_weight": "largest weight", "mean": "mean weight"}
REFERENCE = "-reference"
LOG = {"variance": True, "max_weight": True, "mean": False}


@dataclass(frozen=True)
class Lines:
    """What tells the series of a chart apart: a field of the rows with its colours and, optionally, dashes.

    `panels` is how many panels stand side by side: the room that the legend has.
    """

    field: str
    labels: Sequence[str]
    colours: Sequence[str]
    dashes: Sequence[style.Dash] | None = None
    panels: int = 3

    def colour(self) -> alt.Color:
        """The encoding of colour, with the chart's one legend."""
        scale = alt.Scale(domain=list(self.labels), range=list(self.colours))
        # A long name takes the width of a panel, a short one a third of it.
        columns = min(len(self.labels), self.panels * (1 if max(map(len, self.labels)) > 16 else 3))
        return alt.Color(f"{self.field}:N", scale=scale, legend=alt.Legend(title=None, columns=columns))

    def dash(self) -> dict[str, Any]:
        """The encoding of dashes, merged into the same legend; empty where all lines are solid."""
        if self.dashes is None:
            return {}
        scale = alt.Scale(domain=list(self.labels), range=[list(dash) for dash in self.dashes])
        return {"strokeDash": alt.StrokeDash(f"{self.field}:N", scale=scale, legend=alt.Legend(title=None))}


def panel(
    name: str,
    statistic: str,
    rows: Sequence[Row],
    truth: Sequence[Row],
    lines: Lines,
    shown: Sequence[float],
    angles: Sequence[float],
    unit_line: bool,
) -> alt.LayerChart:
    """The chart of `rows` (see `points.sampled`), with `truth` as thin lines and a rule at 1 where asked.

    In the whole chart `rows` are the data set `name`, `truth` the data set `name` + REFERENCE. `shown` are the values
    that the axis must cover, so that panels of one statistic can share their range; `angles` likewise for the other
    axis.
    """
    log = LOG[statistic]
    if log:
        scale, axis = scales.log_scale(shown)
    else:
        scale, axis = scales.linear_scale(shown), alt.Axis(tickCount=6)
    one_angle = len(set(angles)) == 1
    x = _techniques_axis(lines, angles[0]) if one_angle else alt.X("theta_o_deg:Q", **scales.angle_axis(angles))
    y = alt.Y("value:Q", scale=scale, axis=axis, title=TITLES[statistic])
    floor = scale.to_dict()["domain"][0]
    data = alt.NamedData(name)
    layers = [
        *([_unit()] if unit_line else []),
        *(_band(data, x, y, lines, floor) if any("stderr" in row for row in rows) else []),
        *(_curves(data, rows, x, y, lines) if rows else []),
        *_truth(name, truth, x, y, None if statistic != "max_weight" else lines, one_angle),
    ]
    if not rows:
        place = {"theta_o_deg": sum(angles) / max(len(angles), 1), lines.field: lines.labels[len(lines.labels) // 2]}
        layers.append(_nothing({**place, "value": shown[0] if shown else 1.0}, x, y, log))
    return alt.LayerChart(layer=layers, width=style.PANEL_WIDTH, height=style.PANEL_HEIGHT)


def _techniques_axis(lines: Lines, angle: float) -> alt.X:
    """The axis of a panel of one view angle: there is no curve to draw, so the series stand side by side."""
    axis = alt.Axis(labelAngle=-35, labelLimit=110, grid=False)
    return alt.X(f"{lines.field}:N", sort=list(lines.labels), axis=axis, title=f"at {scales.THETA_O} = {angle:.6g}°")


def _data(rows: Sequence[Row]) -> alt.InlineData:
    return alt.InlineData(values=list(rows))


def _unit() -> alt.Chart:
    rule = alt.Chart(_data([{"one": 1.0}])).mark_rule(color=style.GREY, strokeWidth=0.8)
    chart: alt.Chart = rule.encode(y=alt.Y("one:Q"))
    return chart


def _band(data: alt.NamedData, x: alt.X, y: alt.Y, lines: Lines, floor: float) -> list[alt.Chart]:
    """The error bars; one that a logarithmic axis cannot show to its end stops at the axis' edge."""
    chart = alt.Chart(data).transform_calculate(low=f"max(datum.value - 2 * datum.stderr, {floor!r})")
    chart = chart.transform_calculate(high="datum.value + 2 * datum.stderr")
    low = alt.Y("low:Q", scale=y["scale"], axis=y["axis"], title=y["title"])
    spread: dict[str, Any] = {"x": x, "y": low, "y2": alt.Y2("high:Q"), "color": lines.colour()}
    area = chart.transform_filter("datum.stderr != null && !datum.marker").mark_area(opacity=0.18, clip=True)
    bar = chart.transform_filter("datum.stderr != null && datum.marker").mark_rule(strokeWidth=1.2, clip=True)
    return [area.encode(**spread, detail=["series:N", "run:N"]), bar.encode(**spread)]


def _curves(data: alt.NamedData, rows: Sequence[Row], x: alt.X, y: alt.Y, lines: Lines) -> list[alt.Chart]:
    """Firm lines where there is a limit, faint ones with open markers where there is none."""
    look: dict[str, Any] = {"x": x, "y": y, "color": lines.colour(), "tooltip": _tooltip(rows)}
    out = []
    for kept, opacity, width in (("datum.limit", 1.0, 1.8), ("!datum.limit", 0.45, 1.2)):
        line = alt.Chart(data).transform_filter(kept).mark_line(strokeWidth=width, opacity=opacity, clip=True)
        out.append(line.encode(**look, **lines.dash(), detail=["series:N", "run:N"]))
    point = alt.Chart(data).transform_filter("datum.marker")
    out.append(point.mark_point(size=22, strokeWidth=1.1, filled=False, opacity=0.9).encode(**look))
    return out


def _truth(name: str, rows: Sequence[Row], x: alt.X, y: alt.Y, lines: Lines | None, one_angle: bool) -> list[alt.Chart]:
    """The reference as thin lines: in `lines`' colours where it lies apart from the curves, else in grey."""
    if not rows:
        return []
    chart = alt.Chart(alt.NamedData(name + REFERENCE))
    look: dict[str, Any] = {"x": x, "y": y, "color": lines.colour() if lines else alt.value(style.GREY)}
    if one_angle:
        return [chart.mark_tick(thickness=1, size=16, opacity=0.9).encode(**look)]
    line = chart.mark_line(strokeWidth=0.7, opacity=0.8, clip=True)
    return [line.encode(**look, detail=["series:N", "run:N"])]


def _nothing(place: Row, x: alt.X, y: alt.Y, log: bool) -> alt.Chart:
    words = alt.Chart(_data([{**place, "text": "zero at every angle" if log else "no value"}]))
    chart: alt.Chart = words.mark_text(color=style.GREY, fontSize=12).encode(x=x, y=y, text="text:N")
    return chart


def _tooltip(rows: Sequence[Row]) -> list[alt.Tooltip]:
    hidden = {"series", "run", "marker", "limit"}
    names = dict.fromkeys(name for row in rows for name in row if name not in hidden)
    numbers = {name for name in names if any(isinstance(row.get(name), int | float) for row in rows)}
    return [
        alt.Tooltip(f"{name}:Q", format=",.6~g" if name != "samples" else ",")
        if name in numbers
        else alt.Tooltip(f"{name}:N")
        for name in names
    ]
