"""Variance, largest weight and mean weight over the view angle, side by side: Figure 11 of the EON paper."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import altair as alt

from service.figures import style
from service.figures.layout import AnyChart, Sheet, panels, technique_lines, value_lines, with_data
from service.formats.series import Series

_MOST_ROWS_BY_VALUE = 4


def statistics_chart(result: Mapping[str, Any], title: str | None = None) -> AnyChart:
    """The chart of a result of kind "statistics"; a statistic that was not asked for has no panel.

    Where parameters are swept, each set of values has its own row of panels, all of one range; beyond four sets the
    rows are techniques and the colours are values. Raises ValueError where there is nothing to draw.
    """
    sheet = Sheet.of(result)
    labels = {technique: sheet.technique_label(technique) for technique in sheet.techniques}
    by_value = _grouped(sheet.series, sheet.values_label)
    if len(by_value) <= _MOST_ROWS_BY_VALUE:
        groups, lines = by_value, technique_lines(sheet, labels)
    else:
        groups, lines = _grouped(sheet.series, lambda one: labels[one.technique]), value_lines(sheet)
    columns = [
        panels(sheet, statistic, list(groups.values()), lines, labels)
        for statistic in ("variance", "max_weight", "mean")
        if sheet.has(statistic)
    ]
    rows = [
        alt.hconcat(*row, title=style.part_title(name) if len(groups) > 1 else alt.Undefined)
        for name, row in zip(groups, zip(*(charts for charts, _ in columns), strict=True), strict=True)
    ]
    chart: AnyChart = rows[0] if len(rows) == 1 else alt.vconcat(*rows)
    datasets = {name: rows for _, part in columns for name, rows in part.items()}
    return with_data(chart.properties(title=sheet.heading(title), config=style.config()), datasets)


def _grouped(series: Sequence[Series], name: Callable[[Series], str]) -> dict[str, list[Series]]:
    groups: dict[str, list[Series]] = {}
    for one in series:
        groups.setdefault(name(one), []).append(one)
    return groups
