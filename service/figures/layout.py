"""What the charts of statistics share: reading the result, labels, titles, panels of one range."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import altair as alt

from service.figures import points, style
from service.figures.panel import LOG, REFERENCE, Lines, panel
from service.formats.series import Series, read, swept, swept_value

AnyChart = alt.VConcatChart | alt.HConcatChart
Datasets = dict[str, list[points.Row]]

_CHARACTERS_A_PANEL = 64

_MOST_BEYOND_SAMPLED = 1e6

_NO_LIMIT = {"variance": "infinite variance", "max_weight": "unbounded weight"}


@dataclass(frozen=True)
class Sheet:
    """A statistics result, read for drawing: its series, what is swept, and which statistics it has."""

    result: Mapping[str, Any]
    series: Sequence[Series]
    swept: Sequence[str]

    @classmethod
    def of(cls, result: Mapping[str, Any]) -> Sheet:
        """Read `result`; raises ValueError where it has nothing to draw."""
        series = read(result)
        sheet = cls(result, series, swept(series))
        if not any(sheet.has(statistic) for statistic in LOG):
            raise ValueError("there is nothing to draw: the result has no series with mean, variance or max_weight")
        return sheet

    def has(self, statistic: str) -> bool:
        """Whether any series has `statistic`."""
        return any(one.values(statistic) is not None for one in self.series)

    @property
    def count(self) -> int:
        """How many statistics the result has."""
        return sum(self.has(statistic) for statistic in LOG)

    @property
    def techniques(self) -> list[str]:
        """Names of the techniques in the order of the series."""
        return list(dict.fromkeys(one.technique for one in self.series))

    def values_label(self, one: Series) -> str:
        """The values of what is swept: `roughness 0.25`; empty where nothing is."""
        return ", ".join(f"{name} {swept_value(one, name)}" for name in self.swept)

    def technique_label(self, technique: str) -> str:
        """The technique's name in the legend, which says where sampled values have no limit."""
        mine = [one for one in self.series if one.technique == technique]
        found = [
            words
            for statistic, words in _NO_LIMIT.items()
            if any(one.values(statistic) is not None and any(one.no_limit(statistic)) for one in mine)
        ]
        if not found:
            return technique
        # An infinite variance implies an unbounded weight: the worse of the two says both.
        return f"{technique} ({found[0]}: sampled value)"

    def unit_line(self, statistic: str) -> bool:
        """Whether 1 is the expected value: the mean weight of models that keep all energy."""
        return statistic == "mean" and all(one.parameters.get("albedo", 1.0) == 1.0 for one in self.series)

    def heading(self, title: str | None) -> alt.TitleParams:
        """Title and subtitle: the model, the count of samples, the seed, the device, what is drawn how."""
        first = self.series[0]
        fixed = [f"{name} {value:.6g}" for name, value in first.parameters.items() if name not in self.swept]
        return alt.TitleParams(
            text=title or f"Throughput weight of {', '.join([first.model, *fixed])}", subtitle=self._subtitle()
        )

    def _subtitle(self) -> list[str]:
        estimator = (self.result.get("scene") or {}).get("estimator") or {}
        counts = [count for one in self.series for count in one.values("samples") or [] if count is not None]
        facts = []
        if counts:
            low, high = min(counts), max(counts)
            facts.append(f"{low:,} samples per angle" if low == high else f"{low:,} to {high:,} samples per angle")
        methods = list(dict.fromkeys(one.method for one in self.series))
        if methods != ["mc"]:
            facts.append(", ".join(methods))
        if estimator.get("seed") is not None:
            facts.append(f"seed {estimator['seed']}")
        if (self.result.get("run") or {}).get("device"):
            facts.append(self.result["run"]["device"])
        width = _CHARACTERS_A_PANEL * max(2, self.count)
        return [*textwrap.wrap(" · ".join(facts), width), *textwrap.wrap(self._key(), width)]

    def _key(self) -> str:
        shown = [(one, statistic) for one in self.series for statistic in LOG if one.values(statistic) is not None]
        key = []
        if any(one.values(f"{statistic}_stderr") for one, statistic in shown):
            angles = {angle for one in self.series for angle in one.theta_o_deg}
            key.append(f"{'bars' if len(angles) == 1 else 'bands'}: two standard errors")
        if any(one.reference(statistic) for one, statistic in shown):
            supremum = any(one.reference("max_weight") for one, statistic in shown if statistic == "max_weight")
            key.append("thin: float64 reference" + (" (of the largest weight, its supremum)" if supremum else ""))
        if any(any(one.no_limit(statistic)) for one, statistic in shown):
            key.append("faint with circles: sampled where no finite value exists")
        log = [value for one, statistic in shown if LOG[statistic] for value in one.values(statistic) or []]
        if any(value is not None and not points.drawable(value, log=True) for value in log):
            key.append("zero is not drawn on logarithmic axes")
        text = "; ".join(key)
        return text[:1].upper() + text[1:]


def panels(
    sheet: Sheet, statistic: str, groups: Sequence[Sequence[Series]], lines: Lines, labels: Mapping[str, str]
) -> tuple[list[alt.LayerChart], Datasets]:
    """A panel of `statistic` for each group of series, and the data sets they draw; all have the same range.

    The data sets go to the whole chart at the end (`with_data`): Altair copies what a part holds whenever parts are
    put together.
    `labels` gives each technique's name in the legend.
    """
    log = LOG[statistic]
    rows, truth = [], []
    for group in groups:
        named = [(one, _labels(sheet, one, labels)) for one in group]
        rows.append([row for one, names in named for row in points.sampled(one, statistic, names, log)])
        truth.append([row for one, names in named for row in points.truth(one, statistic, names, log)])
    unit = sheet.unit_line(statistic)
    shown = [row["value"] for part in rows for row in part] + ([1.0] if unit else [])
    # A variance of 1e200, which rare weights carry, would flatten everything else: its line leaves the panel.
    most = _MOST_BEYOND_SAMPLED * max(shown, default=math.inf) if log else math.inf
    shown += [row["value"] for part in truth for row in part if row["value"] <= most]
    angles = [angle for one in sheet.series for angle in one.theta_o_deg]
    charts: list[alt.LayerChart] = []
    datasets: Datasets = {}
    for index, (mine, exact) in enumerate(zip(rows, truth, strict=True)):
        name = f"{statistic}-{index}"
        charts.append(panel(name, statistic, mine, exact, lines, shown, angles, unit))
        datasets |= {key: part for key, part in ((name, mine), (name + REFERENCE, exact)) if part}
    return charts, datasets


def _labels(sheet: Sheet, one: Series, labels: Mapping[str, str]) -> dict[str, Any]:
    index = next(index for index, other in enumerate(sheet.series) if other is one)
    names: dict[str, Any] = {"series": index, "technique": labels[one.technique]}
    if sheet.swept:
        names["parameters"] = sheet.values_label(one)
    return names


def technique_lines(sheet: Sheet, labels: Mapping[str, str]) -> Lines:
    """The lines of a chart whose colours are techniques."""
    styles = style.technique_styles(list(labels))
    colours, dashes = zip(*styles, strict=True)
    return Lines("technique", list(labels.values()), colours, dashes, panels=sheet.count)


def value_lines(sheet: Sheet) -> Lines:
    """The lines of a chart whose colours are the values of what is swept, dark to light."""
    labels = list(dict.fromkeys(sheet.values_label(one) for one in sheet.series))
    return Lines("parameters", labels, style.sequence(len(labels)), panels=max(2, sheet.count))


def with_data(chart: AnyChart, datasets: Datasets) -> AnyChart:
    """`chart`, which now holds `datasets`.

    They are set past Altair's check of every row against its schema, which takes seconds for thousands of angles.
    """
    chart.datasets = datasets
    return chart
