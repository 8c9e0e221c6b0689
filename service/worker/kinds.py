"""The kinds of question that are answered over HTTP: one entry each.

A kind's function takes (question, engine, progress) and returns a result whose `kind` is its name. It is imported by
the worker alone, when the first question of its kind arrives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from service.convergence.scene import ConvergenceScene, parse_convergence_scene
from service.explain.scene import draws, parse_explain_scene
from service.scene import Question, Scene, parse_scene

if TYPE_CHECKING:
    from service.engine import Engine
    from service.statistics import Progress

_TIMING_SAMPLES = 10**9
"""Some tens of seconds on the device."""

_EDGE_POINTS = 200_000
"""About what the edge grid of a model and a technique has, in float32 and again in float64."""


@dataclass(frozen=True)
class Kind:
    """One kind of question.

    `scene` is what its scenes are, `parse` makes one of plain data, `samples` is how many samples an answer draws.
    `function` is "module:name". A `resumable` one also takes `journal` (see service.statistics): it is interrupted at
    any launch, shares the device with others, and goes on where it was. One that is not `routed` is behind a figure
    only.
    """

    name: str
    title: str
    scene: type[Scene]
    parse: Callable[[Mapping[str, Any]], Scene]
    samples: Callable[[Question], int]
    function: str
    resumable: bool = False
    routed: bool = True

    @property
    def path(self) -> str:
        """The route."""
        return f"/v1/{self.name}"

    def compute(self, *arguments: Any, **more: Any) -> dict[str, Any]:
        """Call the function, which is imported now."""
        module, _, name = self.function.partition(":")
        result: dict[str, Any] = getattr(import_module(module), name)(*arguments, **more)
        return result


def _cells(question: Question) -> int:
    return len(question.series) * len(question.scene.angles_deg)


def _statistics_samples(question: Question) -> int:
    return _cells(question) * question.scene.estimator.samples


def _convergence_samples(question: Question) -> int:
    scene = question.scene
    assert isinstance(scene, ConvergenceScene)
    return _cells(question) * scene.counts[-1] * scene.replicates * len(scene.estimators)


def _stability_samples(question: Question) -> int:
    return _EDGE_POINTS * len({(plan.model, plan.technique) for plan in question.series})


def compute_catalogue_timings(question: Question, engine: Engine, progress: Progress) -> dict[str, Any]:
    """Timings are of the whole catalogue, whatever the question."""
    from service.convergence import compute_timings

    return compute_timings(engine, progress=progress)


KINDS: Mapping[str, Kind] = {
    kind.name: kind
    for kind in (
        Kind(
            name="statistics",
            title="Mean, variance and largest weight of techniques across view angles",
            scene=Scene,
            parse=parse_scene,
            samples=_statistics_samples,
            function="service.statistics:compute_statistics",
            resumable=True,
        ),
        Kind(
            name="convergence",
            title="Error against run time: which technique reaches a target first",
            scene=ConvergenceScene,
            parse=parse_convergence_scene,
            samples=_convergence_samples,
            function="service.convergence:compute_convergence",
        ),
        Kind(
            name="stability",
            title="Stiff and extreme cases: float32 against float64 where formulas break",
            scene=Scene,
            parse=parse_scene,
            samples=_stability_samples,
            function="service.stability:compute_stability",
        ),
        Kind(
            name="explain",
            title="What the shaders of a scene leave out, and what that saves",
            scene=Scene,
            parse=parse_explain_scene,
            samples=draws,
            function="service.explain:compute_explanation",
        ),
        Kind(
            name="slices",
            title="BRDFs in the plane of the view",
            scene=Scene,
            parse=parse_scene,
            samples=_cells,
            function="service.slices:compute_slices",
            routed=False,
        ),
        Kind(
            name="timings",
            title="What a call costs, for every model and technique",
            scene=Scene,
            parse=parse_scene,
            samples=lambda question: _TIMING_SAMPLES,
            function="service.worker.kinds:compute_catalogue_timings",
            routed=False,
        ),
    )
}

ROUTED = [kind for kind in KINDS.values() if kind.routed]
