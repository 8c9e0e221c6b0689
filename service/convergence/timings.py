"""The paper's Table 1 for the whole catalogue: what evaluation, sampling and density of every entry cost."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from service.catalogue import Catalogue, Entry
from service.convergence.cost import CALLS, GROUPS, LANES, REPEATS, Cost, Loop, Task, measure_costs
from service.engine import Engine

PUBLISHED = (
    {"model": "lambert", "eval_ns": 1.4, "sample_ns": {"cosine": 67.2}},
    {"model": "fon", "eval_ns": 6.3, "sample_ns": {"cosine": 67.2}},
    {"model": "qon", "eval_ns": 6.3, "sample_ns": {"cosine": 67.4}},
    {"model": "oren-nayar-full", "eval_ns": 141.7, "sample_ns": {"cosine": 211.218}},
    {"model": "eon-approx", "eval_ns": 20.8, "sample_ns": {"cosine": 105.8, "cltc-mis": 217.0}},
    {"model": "eon", "eval_ns": 108.7, "sample_ns": {"cosine": 193.5, "cltc-mis": 297.0}},
)
"""ns on one thread of an AMD 3970X, from GLSL ported to C++. Its "CLTC sample" is Listing 4, the mixture."""
SOURCE = "Portsmouth, Kutz, Hill 2024 (EON), Table 1"


def compute_timings(
    engine: Engine, repeats: int = REPEATS // 2, progress: Callable[[str, int, int], None] = lambda *_: None
) -> dict[str, Any]:
    """A result of kind `timings`: a row for each model, and one for each technique that declares it."""
    begin = time.perf_counter()
    loops = _loops(engine.catalogue)
    found, built_ms = measure_costs(engine, loops, repeats, lambda done, total: progress("timing", done, total))
    return {
        "kind": "timings",
        "rows": [_row(loop, cost) for loop, cost in zip(loops, found, strict=True)],
        "source": SOURCE,
        "left_out": [],
        "run": engine.run_block(
            begin,
            threads=engine.device.info.threads,
            repeats=repeats,
            calls=CALLS * GROUPS * LANES,
            compile_ms=built_ms,
        ),
    }


def _loops(catalogue: Catalogue) -> list[Loop]:
    """Evaluation once a model, sampling once a pair, density once a technique: it does not depend on the model."""
    loops: list[Loop] = []
    timed: set[str] = set()
    for model in catalogue.models.values():
        techniques = [catalogue.technique(name) for name in catalogue.techniques_for(model.name)]
        loops.append(Loop(model, _simplest(techniques), "eval"))
        loops += [Loop(model, technique, "sample") for technique in techniques]
        fresh = [technique for technique in techniques if technique.name not in timed]
        loops += [Loop(model, technique, "pdf") for technique in fresh]
        timed |= {technique.name for technique in fresh}
    return loops


def _simplest(techniques: list[Entry]) -> Entry:
    """The technique with the fewest parameters: an evaluation needs none of them."""
    return min(techniques, key=lambda technique: len(technique.head.parameters) + len(technique.head.uses))


def _row(loop: Loop, cost: Cost) -> dict[str, Any]:
    return {
        "model": loop.model.name,
        "technique": None if loop.task == "eval" else loop.technique.name,
        "task": loop.task,
        "call_ns": cost.call_ns,
        "call_ns_quartiles": list(cost.quartiles_ns),
        "call_ns_interval": list(cost.interval_ns),
        "empty_ns": cost.empty_ns,
        "paper_ns": _published(loop.model.name, loop.technique.name, loop.task),
    }


def _published(model: str, technique: str, task: Task) -> float | None:
    for row in PUBLISHED:
        if row["model"] == model:
            samples = row["sample_ns"]
            assert isinstance(samples, dict)
            value = row["eval_ns"] if task == "eval" else samples.get(technique) if task == "sample" else None
            return None if value is None else float(str(value))
    return None
