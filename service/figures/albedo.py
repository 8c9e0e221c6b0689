"""Directional albedo over the view angle: Figures 6 and 7 of the EON paper, Figures 2 and 3 of Kurt et al. 2010."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import altair as alt

from service.figures import scales, style
from service.figures.layout import AnyChart, Sheet

_SIZE = {"width": 1.25 * style.PANEL_WIDTH, "height": 1.25 * style.PANEL_HEIGHT}
_POINTS = 16  # sampled values of a curve that are drawn
_KEY = "Lines: float64 reference; points: sampled mean weight"
_AVERAGE_KEY = ", and its integral over views"
_HIGHEST = 1.6  # where the axis ends at the latest: some albedos have no limit at grazing


def albedo_chart(result: Mapping[str, Any], title: str | None = None) -> AnyChart:
    """A panel for each value of the last swept parameter, with a colour for each of the first.

    Lines are the float64 reference, points the sampled mean weight. A result with the block `average_albedo` has a
    panel of it as well. Parameters with equal values (mx and my of an isotropic sweep) count as one. Raises ValueError
    where the result has no mean weight.
    """
    sheet = Sheet.of(result)
    if not sheet.has("mean"):
        raise ValueError("there is nothing to draw: the result has no mean weight")
    rows = _rows(sheet)
    top = min(_HIGHEST, 1.1 * max(1.0, *(row["value"] for row in rows)))
    colours = list(dict.fromkeys(row["colour"] for row in rows))
    panels = list(dict.fromkeys(row["panel"] for row in rows))
    scale = alt.Scale(domain=colours, range=style.sequence(len(colours)))
    angles = [angle for one in sheet.series for angle in one.theta_o_deg]
    look = {
        "x": alt.X("theta_o_deg:Q", **scales.angle_axis(angles)),
        "y": alt.Y("value:Q", scale=alt.Scale(domain=[0.0, top], nice=False), title="directional albedo"),
        "color": alt.Color("colour:N", scale=scale, sort=colours, legend=alt.Legend(title=None, columns=3)),
    }
    charts = []
    for name in panels:
        data = alt.InlineData(values=[row for row in rows if row["panel"] == name])
        line = alt.Chart(data).transform_filter("datum.exact").mark_line(strokeWidth=1.5, clip=True).encode(**look)
        dots = (
            alt.Chart(data).transform_filter("!datum.exact").mark_point(size=18, filled=True, clip=True).encode(**look)
        )
        layers = alt.layer(_rule_at_one(), line, dots)
        charts.append(layers.properties(**_SIZE, **({"title": style.part_title(name)} if name else {})))
    if "average_albedo" in result:
        charts.append(_average(result["average_albedo"]))
    pairs = [alt.hconcat(*charts[k : k + 2]) for k in range(0, len(charts), 2)]
    heading = sheet.heading(title)
    heading.subtitle = [heading.subtitle[0], _KEY + (_AVERAGE_KEY if "average_albedo" in result else "")]
    chart: AnyChart = alt.vconcat(*pairs).properties(title=heading, config=style.config())
    return chart


def _average(block: Mapping[str, Any]) -> alt.LayerChart:
    """The panel of the average albedo over the swept parameter: closed form as a line, integrals as points."""
    layers = [_rule_at_one()]
    for name in ("closed_form", "integrated"):
        part = block[name]
        rows = [{"at": at, "average": y} for at, y in zip(part["value"], part["average"], strict=True)]
        chart = alt.Chart(alt.InlineData(values=rows))
        marked = chart.mark_line(strokeWidth=1.5) if name == "closed_form" else chart.mark_point(size=24, filled=True)
        x = alt.X("at:Q", title=block["parameter"], scale=alt.Scale(nice=False))
        y = alt.Y("average:Q", title="average albedo", scale=alt.Scale(domain=[0.0, 1.1], nice=False))
        layers.append(marked.encode(x=x, y=y, color=alt.value(style.GREY)))
    whole: alt.LayerChart = alt.LayerChart(layer=layers).properties(**_SIZE)
    return whole


def _rule_at_one() -> alt.Chart:
    rule = alt.Chart(alt.InlineData(values=[{"one": 1.0}])).mark_rule(color=style.GREY, strokeWidth=0.8)
    chart: alt.Chart = rule.encode(y="one:Q")
    return chart


def _rows(sheet: Sheet) -> list[dict[str, Any]]:
    names = _distinct(sheet)
    rows = []
    for one in sheet.series:
        labels = [f"{shown} = {one.parameters[name]:.4g}" for name, shown in names.items()]
        place = {"colour": labels[0] if labels else one.model, "panel": ", ".join(labels[1:])}
        mean, exact = one.values("mean") or [], one.reference("albedo") or []
        step = max(1, len(mean) // _POINTS)
        for is_exact, values, each in ((False, mean, step), (True, exact, 1)):
            points = list(zip(one.theta_o_deg, values, strict=False))[::each]
            rows += [{**place, "theta_o_deg": angle, "value": value, "exact": is_exact} for angle, value in points]
    return rows


def _distinct(sheet: Sheet) -> dict[str, str]:
    """The swept parameters and their names in print; those that always have equal values are one: `mx = my`."""
    equal: dict[tuple[Any, ...], list[str]] = {}
    for name in sheet.swept:
        equal.setdefault(tuple(one.parameters.get(name) for one in sheet.series), []).append(name)
    return {names[0]: " = ".join(names) for names in equal.values()}
