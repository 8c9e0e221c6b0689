"""Variance and largest weight for several values of a parameter, technique beside technique: Figure 13 of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import altair as alt

from service.figures import style
from service.figures.layout import AnyChart, Datasets, Sheet, panels, value_lines, with_data


def roughness_chart(result: Mapping[str, Any], title: str | None = None) -> AnyChart:
    """A chart with a column for each technique and a row for variance and largest weight.

    Colour is the value of what is swept (roughness, in the paper), dark to light; panels of a row have one range.
    Raises ValueError where the result has neither statistic.
    """
    sheet = Sheet.of(result)
    labels = {technique: sheet.technique_label(technique) for technique in sheet.techniques}
    groups = [[one for one in sheet.series if one.technique == technique] for technique in sheet.techniques]
    statistics = [statistic for statistic in ("variance", "max_weight") if sheet.has(statistic)]
    if not statistics:
        raise ValueError("there is nothing to draw: the result has neither variance nor max_weight")
    rows: list[alt.HConcatChart] = []
    datasets: Datasets = {}
    for statistic in statistics:
        row, part = panels(sheet, statistic, groups, value_lines(sheet), labels)
        if statistic == statistics[0]:
            row = [one.properties(title=style.part_title(name)) for one, name in zip(row, labels.values(), strict=True)]
        datasets |= part
        rows.append(alt.hconcat(*row))
    chart = alt.vconcat(*rows).properties(title=sheet.heading(title), config=style.config())
    return with_data(chart, datasets)
