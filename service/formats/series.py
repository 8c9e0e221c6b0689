"""How to read the series of a statistics result: its columns, what is swept, and which of its cells have no limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

Column = list[Any]

STATISTICS = (
    "mean",
    "mean_stderr",
    "variance",
    "variance_stderr",
    "max_weight",
    "zero_fraction",
    "nonfinite",
    "samples",
)
"""The columns of a series, in the order they are written."""

REFERENCE = (
    *("mean", "mean_uncertainty", "mean_error"),
    *("albedo", "albedo_uncertainty"),
    *("variance", "variance_uncertainty", "variance_error", "variance_stderr"),
    "max_weight",
)
"""The columns of a series' reference, in the order they are written."""


@dataclass(frozen=True)
class Series:
    """One series of a statistics result: one technique at one set of parameter values, over view angles."""

    raw: Mapping[str, Any]

    @property
    def model(self) -> str:
        """Name of the model."""
        return str(self.raw["model"])

    @property
    def technique(self) -> str:
        """Name of the technique."""
        return str(self.raw["technique"])

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Values of the parameters of model and technique."""
        return dict(self.raw.get("parameters") or {})

    @property
    def theta_o_deg(self) -> list[float]:
        """View angles in degrees."""
        return list(self.raw["theta_o_deg"])

    @property
    def method(self) -> str:
        """The estimator that was used: mc, qmc or quadrature."""
        return str((self.raw.get("estimator") or {}).get("method") or "mc")

    @property
    def verdict(self) -> Mapping[str, Any]:
        """The verdict as it stands in the result."""
        return self.raw.get("verdict") or {}

    @property
    def status(self) -> str:
        """`ok` or the name of the first finding."""
        return str(self.verdict.get("status", ""))

    @property
    def findings(self) -> Sequence[Mapping[str, Any]]:
        """The findings of the verdict, worst first."""
        return list(self.verdict.get("findings") or [])

    def values(self, name: str) -> Column | None:
        """The column `name`, one value an angle (one value for all is repeated); None where it is absent."""
        return self._column(self.raw.get(name))

    def reference(self, name: str) -> Column | None:
        """The column `name` of the reference; None where it is absent."""
        return self._column((self.raw.get("reference") or {}).get(name))

    def _column(self, value: Any) -> Column | None:
        if value is None:
            return None
        if isinstance(value, Sequence) and not isinstance(value, str):
            return list(value)
        return [value] * len(self.raw["theta_o_deg"])

    def finding(self, name: str) -> Mapping[str, Any] | None:
        """The finding `name`, or None where the verdict has none; a bare status counts as one."""
        for finding in self.findings:
            if finding.get("name") == name:
                return finding
        return {"name": name} if self.status == name else None

    @property
    def tail_strength(self) -> Column | None:
        """Strength of the weight's tail at each angle, from the evidence of an infinite variance."""
        evidence = (self.finding("infinite-variance") or {}).get("evidence") or {}
        column = self._column(evidence.get("tail_strength"))
        return column if column is not None and len(column) == len(self.theta_o_deg) else None

    def _held(self, name: str) -> list[bool] | None:
        """At which angles the finding `name` holds by its own evidence; None where that does not list them."""
        held = ((self.finding(name) or {}).get("evidence") or {}).get("theta_o_deg")
        return [angle in held for angle in self.theta_o_deg] if isinstance(held, list | tuple) else None

    @cached_property
    def infinite_variance(self) -> list[bool]:
        """Angles at which the variance is infinite: the sampled value there has no limit.

        Where the verdict names an infinite variance, it is at the angles that the finding lists. A finding that lists
        none holds where the reference is null or the tail has a strength; without either, where the standard error is
        null; without that too, everywhere.
        """
        count = len(self.theta_o_deg)
        if self.finding("infinite-variance") is None:
            return [False] * count
        held = self._held("infinite-variance")
        if held is not None:
            return held
        strength, truth = self.tail_strength, self.reference("variance")
        if strength is None and truth is None:
            error = self.values("variance_stderr") or [None] * count
            found = [value is None for value in error]
        else:
            by_tail = [bool(value) for value in strength or [None] * count]
            by_truth = [value is None for value in truth or [0.0] * count]
            found = [tail or null for tail, null in zip(by_tail, by_truth, strict=True)]
        return found if any(found) else [True] * count

    @cached_property
    def unbounded_weight(self) -> list[bool]:
        """Angles at which the weight has no upper bound: the sampled maximum there has no limit."""
        infinite = self.infinite_variance
        if self.finding("unbounded-weight") is None and not any(infinite):
            return infinite
        truth = self.reference("max_weight")
        if truth is not None:
            return [value is None for value in truth]
        if self.finding("unbounded-weight") is None:
            return infinite
        return self._held("unbounded-weight") or [True] * len(infinite)

    def no_limit(self, statistic: str) -> list[bool]:
        """At which angles the sampled `statistic` has no limit, however many samples are drawn."""
        cells = {"variance": self.infinite_variance, "max_weight": self.unbounded_weight}
        return cells.get(statistic, [False] * len(self.theta_o_deg))


def read(result: Mapping[str, Any]) -> list[Series]:
    """The series of a statistics result."""
    return [Series(raw) for raw in result.get("series") or []]


def parameter_names(series: Sequence[Series]) -> list[str]:
    """The names of all parameters, in the order they first appear."""
    return list(dict.fromkeys(name for one in series for name in one.parameters))


def swept(series: Sequence[Series]) -> list[str]:
    """What distinguishes series of one technique: `model`, names of parameters, `phi_o_deg`."""
    groups: dict[tuple[str, str], list[Series]] = {}
    for one in series:
        groups.setdefault((one.model, one.technique), []).append(one)

    def varies(name: str) -> bool:
        return any(len({swept_value(one, name) for one in group}) > 1 for group in groups.values())

    names = ["model"] if len({one.model for one in series}) > 1 else []
    return names + [name for name in (*parameter_names(series), "phi_o_deg") if varies(name)]


def swept_value(one: Series, name: str) -> str:
    """The value of a swept parameter as it is printed; `-` where the series does not have it."""
    value = one.raw.get(name) if name in ("model", "phi_o_deg") else one.parameters.get(name)
    if isinstance(value, Sequence) and not isinstance(value, str):
        value = value[0] if value else None
    if isinstance(value, int | float) and not isinstance(value, bool):
        return f"{value:.6g}"
    return "-" if value is None else str(value)
