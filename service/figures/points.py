"""What a panel draws: plain rows of finite numbers, made from the series of a statistics result."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from service.formats.series import Series

Row = dict[str, Any]

LEAST_POSITIVE = 1e-12
"""A variance below this is rounding of zero, and is not drawn on a logarithmic axis."""

_MARKERS = 22


def sampled(one: Series, statistic: str, labels: Mapping[str, Any], log: bool) -> list[Row]:
    """A row for each angle at which `statistic` can be drawn.

    `value` with its `stderr` where that means something; `limit` is false where the sampled value has no limit;
    `run` counts unbroken stretches, each drawn as one line; `marker` says which rows get a point: those that have no
    neighbour, and some of those without limit.
    """
    values = one.values(statistic)
    if values is None:
        return []
    errors = one.values(f"{statistic}_stderr") or [None] * len(values)
    samples = one.values("samples") or [None] * len(values)
    columns = zip(one.theta_o_deg, values, errors, samples, one.no_limit(statistic), strict=True)
    rows: list[Row] = []
    run = 0
    for angle, value, error, count, endless in columns:
        if not drawable(value, log):
            run += 1
            continue
        if rows and rows[-1]["limit"] == endless:
            run += 1
        row = {**labels, "theta_o_deg": angle, "value": value, "limit": not endless, "run": run, "marker": False}
        if error is not None and not endless:
            row["stderr"] = error
        if count is not None:
            row["samples"] = count
        rows.append(row)
    _mark(rows)
    return rows


def truth(one: Series, statistic: str, labels: Mapping[str, Any], log: bool) -> list[Row]:
    """A row for each angle at which the reference of `statistic` can be drawn."""
    rows: list[Row] = []
    run = 0
    for angle, value in zip(one.theta_o_deg, one.reference(statistic) or [], strict=False):
        if drawable(value, log):
            rows.append({**labels, "theta_o_deg": angle, "value": value, "run": run})
        else:
            run += 1
    return rows


def drawable(value: float | None, log: bool) -> bool:
    """Whether an axis can show `value`; a logarithmic one shows no zero."""
    return value is not None and math.isfinite(value) and (not log or value > LEAST_POSITIVE)


def _mark(rows: Sequence[Row]) -> None:
    every = max(1, math.ceil(len(rows) / _MARKERS))
    sizes = Counter(row["run"] for row in rows)
    for index, row in enumerate(rows):
        row["marker"] = sizes[row["run"]] == 1 or (not row["limit"] and index % every == 0)
