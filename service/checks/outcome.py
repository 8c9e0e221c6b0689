"""What a check says: its verdict with evidence, its power, and the inputs that show a failure again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from service.plain_data import plain_data

Status = Literal["pass", "fail", "not-applicable"]

NAMES = (
    "finite",
    "nonnegative",
    "unit-length",
    "hemisphere",
    "pdf-agreement",
    "pdf-normalisation",
    "chi-square",
    "jacobian",
    "coverage",
    "unbiased",
    "tail",
    "supremum",
    "reciprocity",
    "energy",
    "continuity",
)
"""Every check, in the order of a report."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one check. `power` says what it would have found; `replay` the inputs of the worst failure."""

    name: str
    status: Status
    message: str
    power: str = ""
    evidence: Mapping[str, Any] = field(default_factory=dict)
    replay: Mapping[str, Any] | None = None

    def as_data(self, technique: str | None) -> dict[str, Any]:
        """Plain data for a result; numbers that are not finite become None."""
        return {
            "name": self.name,
            "technique": technique,
            "status": self.status,
            "message": self.message,
            "evidence": plain_data(self.evidence),
            "power": self.power,
            "replay": plain_data(self.replay),
        }


def passed(name: str, message: str, power: str, **evidence: Any) -> Outcome:
    """A check that holds."""
    return Outcome(name, "pass", message, power, evidence)


def failed(name: str, message: str, power: str, replay: Mapping[str, Any] | None, **evidence: Any) -> Outcome:
    """A check that does not hold, with the inputs that show it."""
    return Outcome(name, "fail", message, power, evidence, replay)


def not_applicable(name: str, reason: str) -> Outcome:
    """A check that says nothing about this subject, and why."""
    return Outcome(name, "not-applicable", reason)
