"""What a question will cost, learned from what questions did cost.

Before anything was measured a sample counts 40 ns and a cell of the reference 10 ms; every answer corrects that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from service.reference_store import missing_references
from service.scene import Question

_SAMPLE_NS = 40.0
_REFERENCE_CELL_MS = 10.0
_CELL_MS = 0.02
_SERIES_MS = 5.0
_NEWEST = 0.3


@dataclass(frozen=True)
class Estimate:
    """Samples to draw in all, and seconds until the answer on a free device."""

    samples: int
    seconds: float


def samples_of(question: Question) -> int:
    """Samples that a question draws in all its cells."""
    return len(question.series) * len(question.scene.angles_deg) * question.scene.estimator.samples


class Costs:
    """Nanoseconds a sample for every model and technique, and a factor for every kind of question."""

    def __init__(self) -> None:
        self._sample_ns: dict[tuple[str, str], float] = {}
        self._factor: dict[str, float] = {}

    def estimate(self, kind: str, question: Question) -> Estimate:
        """Estimate an answer. Reads which references are stored: not for the event loop."""
        scene = question.scene
        cells = len(scene.angles_deg)
        draws_ms = sum(
            cells * scene.estimator.samples * self._ns(plan.model.name, plan.technique.name) / 1e6 + _SERIES_MS
            for plan in question.series
        )
        missing = missing_references(question) if scene.reference else 0
        steady_ms = draws_ms * self._factor.get(kind, 1.0) + cells * len(question.series) * _CELL_MS
        return Estimate(samples_of(question), (steady_ms + missing * _REFERENCE_CELL_MS) / 1e3)

    def learn(self, costs: Sequence[Sequence[Any]]) -> None:
        """Take in what series cost: (model, technique, samples, device milliseconds) each."""
        for model, technique, samples, device_ms in costs:
            if samples >= 100_000:
                fresh = 1e6 * device_ms / samples
                known = self._sample_ns.get((model, technique), fresh)
                self._sample_ns[model, technique] = known + _NEWEST * (fresh - known)

    def learn_kind(self, kind: str, estimate: Estimate, busy_ms: float) -> None:
        """Take in how long a question of another kind than statistics took, as a multiple of its statistics."""
        factor = self._factor.get(kind, 1.0)
        share = busy_ms / 1e3 / max(estimate.seconds, 1e-3)
        self._factor[kind] = min(1e4, max(1e-2, factor * (1 + _NEWEST * (share - 1))))

    def _ns(self, model: str, technique: str) -> float:
        return self._sample_ns.get((model, technique), _SAMPLE_NS)
