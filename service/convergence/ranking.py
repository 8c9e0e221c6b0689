"""Who reaches the target first, angle by angle, and whether that can be told at all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

RUN_TO_RUN = 1.1
"""Two runs on one machine may differ by this factor in the ratio of two costs, which one run's own spread does not
show; times closer than this are not distinguishable, whatever their intervals."""


@dataclass(frozen=True)
class Contender:
    """A technique at one angle: its time to the target with an interval, in ms; None where there is none."""

    technique: str
    time_ms: float | None
    interval_ms: tuple[float, float] | None


def rank(contenders: Sequence[Contender]) -> dict[str, Any]:
    """Order by time to the target, the fastest first.

    `distinguishable` is true where no two neighbours have times that overlap; `tied` names the neighbours that do, and
    `unranked` those without a time: they never reach the target, or have an infinite variance. `lead` is the second
    time over the first.
    """
    able = sorted((c for c in contenders if c.time_ms is not None), key=lambda c: (c.time_ms, c.technique))
    tied = [[a.technique, b.technique] for a, b in pairwise(able) if not separate(a, b)]
    times = [c.time_ms for c in able if c.time_ms is not None]
    return {
        "order": [c.technique for c in able],
        "distinguishable": len(able) > 1 and not tied,
        "tied": tied,
        "unranked": [c.technique for c in contenders if c.time_ms is None],
        "lead": times[1] / times[0] if len(times) > 1 else None,
    }


def separate(faster: Contender, slower: Contender) -> bool:
    """Whether the intervals of two times, the faster first, lie apart by more than runs differ."""
    if faster.interval_ms is None or slower.interval_ms is None:
        return False
    return faster.interval_ms[1] * RUN_TO_RUN < slower.interval_ms[0]


def product_interval(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    """An interval for the product of two positive quantities that are independent, each with its interval.

    Half widths of the logarithms add in squares, each half by itself.
    """
    middle = [math.sqrt(low * high) for low, high in (a, b)]
    spread = math.hypot(*(math.log(high / low) / 2 for low, high in (a, b)))
    value = middle[0] * middle[1]
    return value / math.exp(spread), value * math.exp(spread)
