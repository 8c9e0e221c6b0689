"""The plots of a report card, as SVG: albedo over the view, the tail of the weight, residuals of chi-square."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import altair as alt

from service.formats import pictures

_SIZE = {"width": 340, "height": 210}


def of_check(check: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """(caption, SVG) of each plot that the evidence of a check allows."""
    evidence = check["evidence"]
    if check["name"] == "energy" and evidence.get("curve"):
        yield "directional albedo at the setting that reflects most", _svg(_albedo(evidence["curve"]))
    if check["name"] == "tail" and _levels(evidence):
        index = evidence["tail_index"]
        words = "bounded" if index is None else f"tail index {index:.3g}"
        yield f"share of samples above a weight, followed by search ({words})", _svg(_tail(evidence))
    if check["name"] == "chi-square" and evidence.get("bins"):
        yield (
            "directions counted against expected, in standard deviations, over azimuth and cosine",
            _svg(_residuals(evidence["bins"])),
        )


def _svg(chart: alt.Chart | alt.LayerChart) -> str:
    return pictures.encode(alt.HConcatChart(hconcat=[chart.properties(**_SIZE)]), "svg").decode()


def _albedo(curve: Mapping[str, Any]) -> alt.LayerChart:
    rows = [{"theta": t, "albedo": a} for t, a in zip(curve["theta_o_deg"], curve["albedo"], strict=True)]
    low, high = min(row["albedo"] for row in rows), max(row["albedo"] for row in rows)
    pad = max(0.01, 0.1 * (high - low))
    scale = alt.Scale(domain=[min(low, 1) - pad, max(high, 1) + pad], nice=False)
    line = alt.Chart(alt.InlineData(values=rows)).mark_line(point=True)
    unit = alt.Chart(alt.InlineData(values=[{"albedo": 1}])).mark_rule(color="#888", strokeDash=[4, 3])
    y = alt.Y("albedo:Q", scale=scale, title="directional albedo")
    x = alt.X("theta:Q", title="view angle, degrees", scale=alt.Scale(domain=[0, 90]))
    return alt.LayerChart(layer=[unit.encode(y=y), line.encode(x=x, y=y)])


def _levels(evidence: Mapping[str, Any]) -> list[dict[str, float]]:
    step = evidence.get("probability_step") or 0.25
    return [
        {"weight": w, "probability": step ** (k + 1)}
        for k, w in enumerate(evidence.get("thresholds") or [])
        if w is not None and w > 0
    ]


def _tail(evidence: Mapping[str, Any]) -> alt.Chart:
    levels = _levels(evidence)
    top = max(level["weight"] for level in levels)
    low = min(level["weight"] for level in levels)
    domain = [low / 1.2, max(top, low * 1.5) * 1.2]
    scale = alt.Scale(type="log", domain=domain, nice=False)
    exponent = math.floor(math.log10(levels[-1]["probability"]))
    chart: alt.Chart = (
        alt.Chart(alt.InlineData(values=levels))
        .mark_line(point=True)
        .encode(
            x=alt.X("weight:Q", scale=scale, title="weight W", axis=alt.Axis(tickCount=5, format="~g")),
            y=alt.Y(
                "probability:Q",
                scale=alt.Scale(type="log", domain=[10.0**exponent, 1]),
                title="P(w > W)",
                axis=alt.Axis(tickCount=6, format="~e"),
            ),
        )
    )
    return chart


def _residuals(bins: Mapping[str, Any]) -> alt.Chart:
    rows = [
        {"z0": 1 - t1, "z1": 1 - t0, "p0": math.degrees(p0), "p1": math.degrees(p1), "residual": r}
        for (t0, t1, p0, p1), r in zip(bins["boxes"], bins["residual"], strict=True)
    ]
    limit = max(3.0, max(abs(row["residual"]) for row in rows))
    chart: alt.Chart = (
        alt.Chart(alt.InlineData(values=rows))
        .mark_rect()
        .encode(
            x=alt.X("p0:Q", title="azimuth, degrees", scale=alt.Scale(domain=[0, 360], nice=False)),
            x2="p1:Q",
            y=alt.Y("z0:Q", title="cosine"),
            y2="z1:Q",
            color=alt.Color(
                "residual:Q",
                scale=alt.Scale(scheme="blueorange", domain=[-limit, limit]),
                legend=alt.Legend(title="deviation"),
            ),
        )
    )
    return chart
