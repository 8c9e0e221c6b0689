"""BRDFs in the plane of the view, all models of a family in one panel: Figure 3 of the EON paper."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import altair as alt

from service.figures import style
from service.figures.layout import AnyChart


def slices_chart(result: Mapping[str, Any], title: str | None = None) -> AnyChart:
    """A panel for each view angle of a result of kind "slices", with a line for each model."""
    models = list(dict.fromkeys(one["model"] for one in result["series"]))
    styles = style.technique_styles(models)
    legend = alt.Legend(title=None, columns=5)
    colour = alt.Color("model:N", scale=alt.Scale(domain=models, range=[s[0] for s in styles]), legend=legend)
    dash = alt.StrokeDash("model:N", scale=alt.Scale(domain=models, range=[list(s[1]) for s in styles]), legend=legend)
    top = max(value for one in result["series"] for value in one["value"] if value is not None)
    y = alt.Y("value:Q", title="f cos θi (1/sr)", scale=alt.Scale(domain=[0, 1.05 * top], nice=False))
    x = alt.X("theta_i_deg:Q", title="light angle θi (degrees), positive on the view's side",
              scale=alt.Scale(domain=[-90, 90]), axis=alt.Axis(values=list(range(-90, 91, 30))))  # fmt: skip
    charts = []
    for angle in dict.fromkeys(one["theta_o_deg"] for one in result["series"]):
        rows = [
            {"model": one["model"], "theta_i_deg": theta_i, "value": value}
            for one in result["series"]
            if one["theta_o_deg"] == angle
            for theta_i, value in zip(one["theta_i_deg"], one["value"], strict=True)
        ]
        chart = (
            alt.Chart(alt.InlineData(values=rows))
            .mark_line(strokeWidth=1.5)
            .encode(x=x, y=y, color=colour, strokeDash=dash)
        )
        size = {"width": 1.2 * style.PANEL_WIDTH, "height": 1.2 * style.PANEL_HEIGHT}
        charts.append(chart.properties(**size, title=style.part_title(f"view angle {angle:g} degrees")))
    parts = [alt.hconcat(*charts[k : k + 2]) for k in range(0, len(charts), 2)]
    heading = alt.TitleParams(text=title or "BRDFs in the plane of the view", subtitle=[result["run"]["device"]])
    whole: AnyChart = alt.vconcat(*parts).properties(title=heading, config=style.config())
    return whole
