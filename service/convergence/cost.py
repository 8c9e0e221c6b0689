"""What one call costs: device time of loops whose inputs change from call to call.

Loops to be compared run in turn, round after round, because the machine drifts; each round is set to the same pace
before medians are taken. The empty loop, which only draws the inputs, is a loop like the others and is subtracted.
"""

from __future__ import annotations

import math
import struct
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.catalogue import Entry
from service.engine import Engine
from service.sampling import TIMEOUT_S, IncompleteRun

Array = NDArray[np.float64]
Task = Literal["empty", "eval", "sample", "pdf"]
_TASKS: Mapping[Task, int] = {"empty": 0, "eval": 1, "sample": 2, "pdf": 3}

LANES = 64
GROUPS = 16
CALLS = 128
"""Calls of each lane: 131,072 in a dispatch, about a millisecond. Other programs seldom interrupt so short a one."""
REPEATS = 101
SPLINTER = 0.05  # ns; no interval of a cost goes below it, where timing noise would make it negative


@dataclass(frozen=True)
class Loop:
    """What is timed: `eval` of a model, `sample` (with evaluation) or `pdf` of a technique, or the `empty` loop."""

    model: Entry
    technique: Entry
    task: Task


@dataclass(frozen=True)
class Cost:
    """ns a call on one driver thread: medians over repeats, with quartiles and an interval of the median of 95 %."""

    call_ns: float
    quartiles_ns: tuple[float, float]
    interval_ns: tuple[float, float]
    empty_ns: float
    repeats: int


def measure_costs(
    engine: Engine,
    loops: Sequence[Loop],
    repeats: int = REPEATS,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[list[Cost], float]:
    """The cost of every loop, without that of the empty loop, and the milliseconds that building them took.

    call_ns = device time x driver threads / calls. Raises IncompleteRun where the driver ended a loop early.
    """
    begin = time.perf_counter()
    empties: dict[tuple[str, ...], Loop] = {}
    for loop in loops:
        empties.setdefault(_parameters(engine, loop), Loop(loop.model, loop.technique, "empty"))
    everything = [*empties.values(), *loops]
    with ExitStack() as stack:
        runs = [_prepared(engine, loop, stack) for loop in everything]
        for run in runs:
            run(0)
        built_ms = 1e3 * (time.perf_counter() - begin)
        raw = np.empty((repeats, len(runs)))
        for repeat in range(repeats):
            for at, run in enumerate(runs):
                raw[repeat, at] = run(repeat + 1)
            progress(repeat + 1, repeats)
    paced = _same_pace(raw)
    at_empty = {names: at for at, names in enumerate(empties)}
    costs = []
    for at, loop in enumerate(loops):
        costs.append(_cost(paced[:, len(empties) + at], paced[:, at_empty[_parameters(engine, loop)]]))
    return costs, built_ms


def _parameters(engine: Engine, loop: Loop) -> tuple[str, ...]:
    return tuple(engine.catalogue.parameters_of(loop.model, loop.technique))


def _prepared(engine: Engine, loop: Loop, stack: ExitStack) -> Callable[[int], float]:
    """A function that runs the loop once and gives ns a call on one thread."""
    pipeline = engine.pipeline(loop.model, loop.technique, "cost", {0: _TASKS[loop.task]})
    declared = list(engine.catalogue.parameters_of(loop.model, loop.technique).values())
    ranges = stack.enter_context(engine.device.buffer((max(1, len(declared)), 2), np.float32))
    for row, parameter in zip(ranges.array, declared, strict=False):  # a buffer has at least one row
        row[:] = parameter.min, parameter.max - parameter.min
    results = stack.enter_context(engine.device.buffer((GROUPS * LANES, 2), np.float32))
    threads = engine.device.info.threads or 1

    def run(number: int) -> float:
        constants = struct.pack("<2I", CALLS, number)
        spent = engine.device.run(pipeline, [ranges, results], (GROUPS, 1, 1), constants, timeout_s=TIMEOUT_S)
        if np.any(results.array[:, 1] != CALLS):
            raise IncompleteRun(f"the driver ended a loop after {results.array[:, 1].min():.0f} of {CALLS} calls")
        return spent.total_ns * threads / (CALLS * GROUPS * LANES)

    return run


def _same_pace(raw: Array) -> Array:
    """Rounds scaled to the same geometric mean, that of the median round: what the machine's drift moves together."""
    pace = np.log(raw).mean(axis=1)
    return np.asarray(raw * np.exp(np.median(pace) - pace)[:, None])


def _cost(values: Array, empty: Array) -> Cost:
    """The difference of two medians; the half widths of their intervals add in squares, each half by itself."""
    at_empty = float(np.median(empty))
    low, median, high = (np.quantile(values, [0.25, 0.5, 0.75]) - at_empty).tolist()
    (below, above), (empty_below, empty_above) = _median_errors(values), _median_errors(empty)
    interval = (median - math.hypot(below, empty_above), median + math.hypot(above, empty_below))
    least = max(median, SPLINTER)
    return Cost(least, (low, high), (max(interval[0], SPLINTER), max(interval[1], least)), at_empty, len(values))


def _median_errors(values: Array) -> tuple[float, float]:
    """How far the median's interval reaches below and above it."""
    first, last = median_interval(len(values))
    ordered, median = np.sort(values), float(np.median(values))
    return median - float(ordered[first]), float(ordered[last]) - median


def median_interval(count: int) -> tuple[int, int]:
    """Indices into sorted values between which the true median lies with at least 95 % (binomial order statistics)."""
    tail, rank = 0.0, 0
    while rank < (count - 1) // 2 and (tail + math.comb(count, rank) / 2**count) <= 0.025:
        tail += math.comb(count, rank) / 2**count
        rank += 1
    return max(0, rank - 1), count - 1 - max(0, rank - 1)
