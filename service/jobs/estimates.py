"""What a question will cost, learned from what questions did cost.

Before anything was measured a sample counts 40 ns and a cell of the reference 10 ms; every answer corrects that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from service.reference_store import missing_references
from service.scene import Question
from service.worker.kinds import KINDS

_SAMPLE_NS = 40.0
_REFERENCE_CELL_MS = 10.0
_CELL_MS = 0.02
_SERIES_MS = 5.0
_LEAST_SAMPLES = 100_000
_NEWEST = 0.3
"""Share of the newest measurement in what is known."""


@dataclass(frozen=True)
class Estimate:
    """Samples to draw in all, and seconds until the answer on a free device."""

    samples: int
    seconds: float


class Costs:
    """Nanoseconds a sample: of every model and technique for statistics, of each other kind as a whole."""

    def __init__(self) -> None:
        self._sample_ns: dict[tuple[str, ...], float] = {}

    def estimate(self, kind: str, question: Question) -> Estimate:
        """Estimate an answer. Reads which references are stored: not for the event loop."""
        samples = KINDS[kind].samples(question)
        a_series = samples / len(question.series)
        draws_ms = 0.0
        for plan in question.series:
            pair = (plan.model.name, plan.technique.name)
            known = self._sample_ns.get((kind,), self._sample_ns.get(pair, _SAMPLE_NS))
            draws_ms += a_series * known / 1e6 + _SERIES_MS
        cells = len(question.series) * len(question.scene.angles_deg)
        missing = missing_references(question) if question.scene.reference else 0
        return Estimate(samples, (draws_ms + cells * _CELL_MS + missing * _REFERENCE_CELL_MS) / 1e3)

    def learn(self, kind: str, samples: int, head: Mapping[str, Any]) -> None:
        """Take in what an answer cost, as the worker said it: `costs` of the series of statistics, `busy_ms` in all."""
        if kind != "statistics":
            self._blend((kind,), samples, head["busy_ms"])
        for model, technique, drawn, device_ms in head["costs"]:
            self._blend((model, technique), drawn, device_ms)

    def _blend(self, name: tuple[str, ...], samples: int, took_ms: float) -> None:
        if samples >= _LEAST_SAMPLES:
            fresh = 1e6 * took_ms / samples
            known = self._sample_ns.get(name, fresh)
            self._sample_ns[name] = known + _NEWEST * (fresh - known)
