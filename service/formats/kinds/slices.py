"""Slices of BRDFs, in every format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

Result = Mapping[str, Any]


def rows(result: Result) -> tuple[list[str], Iterator[list[Any]]]:
    """Return the columns and one row for each model, view angle and light angle."""

    def each() -> Iterator[list[Any]]:
        for one in result["series"]:
            for angle, value in zip(one["theta_i_deg"], one["value"], strict=True):
                yield [one["model"], one["theta_o_deg"], angle, value]

    return ["model", "theta_o_deg", "theta_i_deg", "value"], each()


def arrays(result: Result) -> dict[str, np.ndarray]:
    """Return float64 arrays of shape (series, light angles), and models and view angles of shape (series,)."""
    import numpy as np

    series = result["series"]
    return {
        "model": np.array([one["model"] for one in series], dtype=np.str_),
        "theta_o_deg": np.array([one["theta_o_deg"] for one in series]),
        "theta_i_deg": np.array([one["theta_i_deg"] for one in series]),
        "value": np.array([one["value"] for one in series]),
    }


def text(result: Result) -> str:
    """Return a table of f cos(theta_i) at some light angles, a line for each model and view angle."""
    series = result["series"]
    shown = range(0, len(series[0]["theta_i_deg"]), max(1, len(series[0]["theta_i_deg"]) // 12))
    head = f"{'model':<22}{'theta_o':>8}" + "".join(f"{series[0]['theta_i_deg'][k]:>8.0f}" for k in shown)
    lines = ["f cos(theta_i) in 1/sr, over theta_i in degrees; positive angles are on the view's side", "", head]
    for one in series:
        values = "".join(f"{one['value'][k]:>8.4f}" for k in shown)
        lines.append(f"{one['model']:<22}{one['theta_o_deg']:>8.4g}{values}")
    return "\n".join(lines) + "\n"
