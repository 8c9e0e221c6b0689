"""What a worker does: answer a question, encode a stored result, prove that the device computes right, bring the page's
plotting library.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from service import formats
from service.engine import Engine
from service.isolation import Bounds, run_isolated
from service.papers import FIGURES
from service.plotting_library import plotting_library
from service.sampling import Checkpoint
from service.scene import Question, parse_scene, resolve
from service.statistics import compute_statistics, partial_series
from service.worker import checkpoints
from service.worker.kinds import KINDS
from service.worker.protocol import Message

PARTIAL_EVERY_S = 0.1
"""Partial statistics are sent no more often than this, and always at the end of a series."""

CHECKPOINT_BYTES_A_SECOND = 20e6
"""Most that is sent as checkpoints: that of 64 angles goes after every launch, larger ones after some."""

Answer = tuple[dict[str, Any], tuple[bytes, ...]]


class Stopped(BaseException):
    """The server asked for the end of a task. Not an Exception: no handler on the way may swallow it."""


@dataclass
class Toil:
    """A task being done: what was asked, the engine, a way to speak, the numbers of the tasks to stop, and what lets
    other tasks go first.
    """

    task: Message
    engine: Engine | None
    speak: Callable[..., None]
    stops: set[int] = field(default_factory=set)
    give_way: Callable[[], None] = lambda: None

    def say(self, say: str, *blobs: bytes, **head: Any) -> None:
        """Send a message about this task."""
        self.speak(say, blobs, id=self.task.head["id"], **head)

    def check_stop(self) -> None:
        """Let others go first where the server sent some, and raise Stopped where this task is to end."""
        self.give_way()
        if self.task.head["id"] in self.stops:
            raise Stopped


def do_task(toil: Toil) -> Answer:
    """Do a task; what it returns is the message that says so. Raises Stopped, and whatever the work raises."""
    work = {"answer": _answer, "encode": _encode, "probe": _probe, "own": _own, "library": _library}
    return work[toil.task.head["do"]](toil)


def _answer(toil: Toil) -> Answer:
    """Compute the result of a scene, as JSON."""
    head = toil.task.head
    assert toil.engine is not None
    kind = KINDS[head["kind"]]
    question = resolve(kind.parse(head["scene"]), toil.engine.catalogue)
    progress = _Progress(toil, question)
    more = {"journal": progress.journal} if kind.resumable else {}
    begin = time.perf_counter()
    before, toil.engine.pause = toil.engine.pause, toil.check_stop
    try:
        result = kind.compute(question, toil.engine, progress.advance, **more)
    finally:
        toil.engine.pause = before
    computed = time.perf_counter()
    content = formats.encode(result, "json")
    run = result.get("run", {})
    timings = {
        "compile": run.get("compile_ms", 0.0),
        "device": run.get("device_ms", 0.0),
        "compute": 1e3 * (computed - begin),
        "encode": 1e3 * (time.perf_counter() - computed),
    }
    return {"timings": timings, "costs": _costs(result)}, (content,)


def _costs(result: dict[str, Any]) -> list[list[Any]]:
    """What the series of statistics cost: model, technique, samples drawn in all, milliseconds on the device."""
    if result["kind"] != "statistics":
        return []
    return [
        [one["model"], one["technique"], _total(one["samples"], len(one["theta_o_deg"])), one["device_ms"]]
        for one in result["series"]
    ]


def _total(samples: Any, angles: int) -> int:
    return sum(samples) if isinstance(samples, list) else samples * angles


class _Progress:
    """Tells the server how far a question is, and keeps its checkpoints there: one for each run of each series."""

    def __init__(self, toil: Toil, question: Question) -> None:
        self._toil = toil
        self._question = question
        self._known = dict(zip(toil.task.head.get("runs", []), toil.task.blobs, strict=True))
        self._watched = toil.task.head.get("partial", False)
        self._shown = 0.0
        self._kept = 0.0
        self._told = self._begun = time.monotonic()

    def advance(self, name: str, done: int, total: int) -> None:
        self._toil.check_stop()
        now = time.monotonic()
        if self._watched or now - self._told >= PARTIAL_EVERY_S:
            self._told = now
            self._toil.say("progress", technique=name, done=done, total=total)

    def journal(self, series: int) -> _Journal:
        return _Journal(self, series)

    def known(self, run: str) -> Checkpoint | None:
        return checkpoints.unpack(self._known[run]) if run in self._known else None

    def keep(self, run: str, series: int, checkpoint: Checkpoint) -> None:
        head: dict[str, Any] = {"run": run}
        now = time.monotonic()
        if not self._watched and now - self._begun < PARTIAL_EVERY_S:
            return  # so short a task is sooner done again than told of
        due = now - self._kept >= checkpoints.size(checkpoint) / CHECKPOINT_BYTES_A_SECOND
        scene = self._question.scene
        complete = checkpoint.sums.drawn.sum() >= scene.estimator.samples * len(scene.angles_deg)
        if self._watched and (complete or (due and now - self._shown >= PARTIAL_EVERY_S)):
            self._shown = now
            plan = self._question.series[series]
            head["partial"] = {"number": series} | partial_series(plan, scene, checkpoint.sums)
        if due or complete or "partial" in head:
            self._kept = now
            self._toil.say("checkpoint", checkpoints.pack(checkpoint), **head)


class _Journal:
    """The journal of one series: its runs are numbered as they begin."""

    def __init__(self, progress: _Progress, series: int) -> None:
        self._progress = progress
        self._series = series
        self._runs = 0

    @property
    def _run(self) -> str:
        return f"{self._series}.{self._runs}"

    def begin(self) -> Checkpoint | None:
        self._runs += 1
        return self._progress.known(self._run)

    def save(self, checkpoint: Checkpoint) -> None:
        self._progress.keep(self._run, self._series, checkpoint)


def _encode(toil: Toil) -> Answer:
    """A stored JSON result in another format."""
    head = toil.task.head
    begin = time.perf_counter()
    paper = FIGURES.get(head.get("figure") or "")

    def draw(result: Any) -> Any:
        from service import figures

        assert paper is not None
        return getattr(figures, f"{paper.chart}_chart")(result, paper.title)

    drawn = paper is not None and paper.chart != "timings"
    content = formats.encode(json.loads(toil.task.blobs[0]), head["format"], draw if drawn else None)
    return {"timings": {"encode": 1e3 * (time.perf_counter() - begin)}}, (content,)


def _library(toil: Toil) -> Answer:
    """The plotting library of the page, as one ES module."""
    return {}, (plotting_library(),)


def _own(toil: Toil) -> Answer:
    """A question about a user's own file, which never runs in this process."""
    head = toil.task.head
    bounds = Bounds(total_s=head["limit_s"], strict=True)

    def advance(name: str, done: int, total: int) -> None:
        toil.say("progress", technique=name, done=done, total=total)

    begin = time.perf_counter()
    result = run_isolated(head["task"], head["arguments"], advance, bounds, toil.check_stop)
    computed = time.perf_counter()
    content = formats.encode(result, "json")
    timings = {"compute": 1e3 * (computed - begin), "encode": 1e3 * (time.perf_counter() - computed)}
    return {"timings": timings}, (content,)


def _probe(toil: Toil) -> Answer:
    """One dispatch whose result is known: the cosine technique weighs exactly 1 on a white Lambertian surface."""
    assert toil.engine is not None
    scene = parse_scene(
        {
            "model": "lambert",
            "techniques": ["cosine"],
            "theta_o_deg": [45.0],
            "estimator": {"samples": 1024},
            "reference": False,
        }
    )
    begin = time.perf_counter()
    (series,) = compute_statistics(resolve(scene, toil.engine.catalogue), toil.engine)["series"]
    found = {name: series[name][0] for name in ("mean", "variance", "max_weight", "nonfinite")}
    known = {"mean": 1.0, "variance": 0.0, "max_weight": 1.0, "nonfinite": 0}
    return {
        "right": found == known,
        "found": found,
        "known": known,
        "timings": {"device": series["device_ms"], "probe": 1e3 * (time.perf_counter() - begin)},
    }, ()
