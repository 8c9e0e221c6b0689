"""Axes: which range of values a panel shows, and where its ticks are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import altair as alt

THETA_O = "θo"

_MOST_DECADES = 7
_LEAST_SPAN = 0.02
_STEPS = (1, 2, 5)


def log_scale(values: Sequence[float]) -> tuple[alt.Scale, alt.Axis]:
    """Scale and axis of a logarithmic panel that shows all `values` (positive)."""
    low, high = (min(values), max(values)) if values else (0.1, 10.0)
    domain = [_below(low), _above(high)]
    if domain[0] == domain[1]:
        domain = [domain[0] / 2, domain[1] * 2]
    first, last = math.floor(math.log10(domain[0])), math.ceil(math.log10(domain[1]))
    each = max(1, math.ceil((last - first) / _MOST_DECADES))
    marks = _STEPS if domain[1] / domain[0] < 50 else (1,)
    ticks = [_decimal(mark, power) for power in range(first, last + 1, each) for mark in marks]
    ticks = [tick for tick in ticks if domain[0] <= tick <= domain[1]]
    scale = alt.Scale(type="log", domain=domain, nice=False)
    return scale, alt.Axis(values=ticks, labelExpr=_POWER_LABEL)


# Fixed decimals where they are short, powers of ten elsewhere; Vega's own choice (0.00001, 1,000,000) is hard to read.
_POWER_LABEL = "datum.value >= 1e5 || datum.value < 1e-3 ? format(datum.value, '~e') : format(datum.value, '~g')"


def linear_scale(values: Sequence[float], least_span: float = _LEAST_SPAN) -> alt.Scale:
    """The scale of a linear panel that shows all `values` with some room around them."""
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    span = max(high - low, least_span)
    middle = (low + high) / 2
    return alt.Scale(domain=[middle - 0.6 * span, middle + 0.6 * span], nice=True, zero=False)


def angle_axis(angles: Sequence[float]) -> dict[str, Any]:
    """Scale, axis and title of the view angle in degrees."""
    low, high = (min(angles), max(angles)) if angles else (0.0, 90.0)
    if high - low > 45:
        scale, axis = alt.Scale(domain=[0, 90], nice=False), alt.Axis(values=list(range(0, 91, 15)))
    else:
        room = max(0.04 * (high - low), 0.0 if high > low else 1.0)
        scale = alt.Scale(domain=[max(0.0, low - room), min(90.0, high + room)], nice=False, zero=False)
        axis = alt.Axis(tickCount=5)
    return {"scale": scale, "axis": axis, "title": f"view angle {THETA_O} (degrees)"}


def _decimal(mark: int, power: int) -> float:
    return float(f"{mark}e{power}")


def _below(value: float) -> float:
    power = math.floor(math.log10(value))
    return max(_decimal(s, p) for p in (power - 1, power) for s in _STEPS if _decimal(s, p) <= value)


def _above(value: float) -> float:
    power = math.floor(math.log10(value))
    return min(_decimal(s, p) for p in (power, power + 1) for s in _STEPS if _decimal(s, p) >= value)
