"""Statistics of the throughput weight over view angles, in every format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from service.formats.series import REFERENCE, STATISTICS, Series, parameter_names, read

if TYPE_CHECKING:
    import numpy as np

    from service.figures import AnyChart

Result = Mapping[str, Any]


def rows(result: Result) -> tuple[list[str], Iterator[list[Any]]]:
    """The columns and one row for each series and angle; what was not computed has no column."""
    series = read(result)
    parameters = parameter_names(series)
    statistics = [name for name in STATISTICS if any(one.values(name) is not None for one in series)]
    references = [name for name in REFERENCE if any(one.reference(name) is not None for one in series)]
    angles = ["theta_o_deg", *(["phi_o_deg"] if any(one.values("phi_o_deg") is not None for one in series) else [])]
    fixed = {"model", "technique", "status", *angles, *statistics, *(f"reference_{name}" for name in references)}
    columns = [
        "model",
        "technique",
        *(f"parameter_{name}" if name in fixed else name for name in parameters),
        *angles,
        *statistics,
        *(f"reference_{name}" for name in references),
        "status",
    ]

    def each() -> Iterator[list[Any]]:
        for one in series:
            empty = [None] * len(one.theta_o_deg)
            head = [one.model, one.technique, *(one.parameters.get(name) for name in parameters)]
            values = [one.values(name) or empty for name in (*angles, *statistics)]
            values += [one.reference(name) or empty for name in references]
            for row in zip(*values, strict=True):
                yield [*head, *row, one.status]

    return columns, each()


def arrays(result: Result) -> dict[str, np.ndarray]:
    """Float64 arrays of shape (series, angles), names of shape (series,) and JSON strings.

    A null is NaN; counts are int64 where no count is null. Parameters are `parameter_NAME` of shape (series,).
    """
    import numpy as np

    from service.formats import strict_json

    series = read(result)
    out = {
        "model": np.array([one.model for one in series], dtype=np.str_),
        "technique": np.array([one.technique for one in series], dtype=np.str_),
        "status": np.array([one.status for one in series], dtype=np.str_),
        "verdict": np.array([strict_json.line(one.verdict) for one in series], dtype=np.str_),
    }
    for name in parameter_names(series):
        out[f"parameter_{name}"] = np.array([_number(one.parameters.get(name)) for one in series])
    for name in ("theta_o_deg", "phi_o_deg", *STATISTICS):
        _stack(out, name, [one.values(name) for one in series], series)
    for name in REFERENCE:
        _stack(out, f"reference_{name}", [one.reference(name) for one in series], series)
    for name in ("scene", "left_out", "run"):
        out[name] = np.array(strict_json.line(result.get(name)), dtype=np.str_)
    return out


def _stack(out: dict[str, np.ndarray], name: str, columns: list[list[Any] | None], series: list[Series]) -> None:
    import numpy as np

    if all(column is None for column in columns):
        return
    stacked = np.full((len(series), max(len(one.theta_o_deg) for one in series)), np.nan)
    for row, column in zip(stacked, columns, strict=True):
        if column is not None:
            row[: len(column)] = [_number(value) for value in column]
    counts = name in ("nonfinite", "samples") and bool(np.isfinite(stacked).all())
    out[name] = stacked.astype(np.int64) if counts else stacked


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def chart(result: Result) -> AnyChart:
    """Variance, max weight and mean weight over the view angle, side by side."""
    from service.figures import statistics_chart

    return statistics_chart(result)


def text(result: Result) -> str:
    """The tables and the summary for a terminal of 120 columns."""
    from service.formats.table import statistics_table

    return statistics_table(result)
