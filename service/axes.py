"""How to label the columns of a result's series when they are plotted: a text, a unit and a scale each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Axis = dict[str, str]

_WEIGHT = {
    "theta_o_deg": {"label": "view angle θo", "unit": "deg", "scale": "linear"},
    "phi_o_deg": {"label": "view azimuth φo", "unit": "deg", "scale": "linear"},
    "mean": {"label": "mean weight", "unit": "", "scale": "linear"},
    "variance": {"label": "variance of the weight", "unit": "", "scale": "log"},
    "max_weight": {"label": "largest weight", "unit": "", "scale": "log"},
    "zero_fraction": {"label": "share of samples of zero weight", "unit": "", "scale": "linear"},
    "nonfinite": {"label": "samples that are not finite", "unit": "samples", "scale": "linear"},
}


def axes(series: Sequence[Mapping[str, Any]]) -> dict[str, Axis]:
    """Label, unit and scale (`linear` or `log`) of every column that these series of statistics have.

    A standard error shares the axis of its statistic.
    """
    columns = {name for one in series for name in one}
    return {name: dict(axis) for name, axis in _WEIGHT.items() if name in columns}
