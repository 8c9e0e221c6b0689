"""Slices of BRDFs, in every format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

Result = Mapping[str, Any]


def rows(result: Result) -> tuple[list[str], Iterator[list[Any]]]:
    """The columns and one row for each series and light angle."""
    names = list(dict.fromkeys(name for one in result["series"] for name in one["parameters"]))

    def each() -> Iterator[list[Any]]:
        for one in result["series"]:
            head = [one["model"], one["technique"], *(one["parameters"].get(name) for name in names)]
            for angle, value, density in zip(one["theta_i_deg"], one["value"], one["pdf"], strict=True):
                yield [*head, one["theta_o_deg"], one.get("phi_o_deg", 0.0), angle, value, density]

    columns = ["model", "technique", *names, "theta_o_deg", "phi_o_deg", "theta_i_deg", "value", "pdf"]
    return columns, each()


def arrays(result: Result) -> dict[str, np.ndarray]:
    """Float64 arrays of shape (series, light angles), and names and view angles of shape (series,)."""
    import numpy as np

    series = result["series"]
    names = {name: np.array([one[name] for one in series], dtype=np.str_) for name in ("model", "technique")}
    columns = ("theta_o_deg", "theta_i_deg", "value", "pdf")
    return names | {name: np.array([one[name] for one in series], dtype=np.float64) for name in columns}


def text(result: Result) -> str:
    """Tables at some light angles: f cos(theta_i) of each model, the density of each technique."""
    series = result["series"]
    angles = series[0]["theta_i_deg"]
    shown = range(0, len(angles), max(1, len(angles) // 12))
    lines = ["in 1/sr, over theta_i in degrees; positive angles are on the view's side"]
    for title, name, column in (("f cos(theta_i)", "model", "value"), ("density", "technique", "pdf")):
        lines += ["", f"{title:<22}{'theta_o':>8}" + "".join(f"{angles[k]:>8.0f}" for k in shown)]
        each = (f"{one[name]:<22}{one['theta_o_deg']:>8.4g}" + _values(one[column], shown) for one in series)
        lines += dict.fromkeys(each)  # a model's values are the same for every technique
    return "\n".join(lines) + "\n"


def _values(column: Sequence[float | None], shown: Sequence[int]) -> str:
    return "".join(f"{'-':>8}" if column[k] is None else f"{column[k]:>8.4f}" for k in shown)
