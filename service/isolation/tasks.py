"""What a worker can do: functions from plain data to a result, one a command.

`arguments` carry the texts of a user's files, since a worker may not read files: `files` has them by the paths that
stand for their names. `seal(engine, pairs)` is called when the device is open and nothing of a file has run yet, with
the pairs of model and technique that the task is about.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from service.catalogue import Catalogue, Entry, load_catalogue
from service.checks.battery import Battery, run_battery
from service.checks.replaying import replay_inputs
from service.checks.selection import Subject, name_of, require_in_range, select, with_files
from service.convergence import compute_convergence, parse_convergence_scene
from service.engine import Engine
from service.errors import BadInput, Problem
from service.explain import compute_explanation, parse_explain_scene
from service.scene import Question, Scene, parse_scene, resolve
from service.stability import compute_stability
from service.statistics import Progress, compute_statistics

Arguments = Mapping[str, Any]
Parse = Callable[[Mapping[str, Any]], Scene]
Pairs = Sequence[tuple[Entry, Entry]]
Seal = Callable[[Engine, Pairs], None]


def stay_open(engine: Engine, pairs: Pairs) -> None:
    """The seal of a process that runs the catalogue only: none."""


def check(arguments: Arguments, progress: Progress, seal: Seal = stay_open) -> dict[str, Any]:
    """The battery over `subject`: a file, or a name of the catalogue."""
    subject = _subject(arguments)
    require_in_range(subject)
    progress("compiling", 0, 1)
    with Engine.open(subject.catalogue, device=arguments["device"]) as engine:
        seal(engine, [(subject.model, technique) for technique in subject.techniques])
        return run_battery(engine, subject, Battery(arguments["seed"], arguments["quick"]), progress)


def replay(arguments: Arguments, progress: Progress, seal: Seal = stay_open) -> dict[str, Any]:
    """One evaluation of `subject` again."""
    subject = _subject(arguments)
    progress("compiling", 0, 1)
    with Engine.open(subject.catalogue, device=arguments["device"]) as engine:
        seal(engine, [(subject.model, technique) for technique in subject.techniques])
        return replay_inputs(engine, subject, arguments["wo"], arguments["u"], arguments["wi"])


def _subject(arguments: Arguments) -> Subject:
    return select(
        arguments["subject"],
        load_catalogue(),
        arguments["model"],
        arguments["techniques"],
        arguments["fixed"],
        arguments["files"],
    )


def statistics(arguments: Arguments, progress: Progress, seal: Seal = stay_open) -> dict[str, Any]:
    """Statistics of a scene whose model or technique is a user's file."""
    return _of_scene(compute_statistics, parse_scene, arguments, progress, seal)


def stability(arguments: Arguments, progress: Progress, seal: Seal = stay_open) -> dict[str, Any]:
    """Stability of a scene whose model or technique may be a user's file."""
    return _of_scene(compute_stability, parse_scene, arguments, progress, seal)


def convergence(arguments: Arguments, progress: Progress, seal: Seal = stay_open) -> dict[str, Any]:
    """Error against run time of a scene whose model or technique is a user's file."""
    return _of_scene(compute_convergence, parse_convergence_scene, arguments, progress, seal)


def explain(arguments: Arguments, progress: Progress, seal: Seal = stay_open) -> dict[str, Any]:
    """What the shaders of a scene leave out, whose model or technique is a user's file."""

    def compute(question: Question, engine: Engine, progress: Progress) -> dict[str, Any]:
        pairs = [(plan.model, plan.technique) for plan in question.series]
        return compute_explanation(question, engine, progress, compiled=lambda: seal(engine, pairs))

    return _of_scene(compute, parse_explain_scene, arguments, progress, stay_open)


def _of_scene(
    compute: Callable[..., dict[str, Any]], parse: Parse, arguments: Arguments, progress: Progress, seal: Seal
) -> dict[str, Any]:
    catalogue, scene = _with_files(arguments)
    question = resolve(parse(scene), catalogue)
    progress("compiling", 0, 1)
    with Engine.open(catalogue, device=arguments["device"]) as engine:
        seal(engine, [(plan.model, plan.technique) for plan in question.series])
        return compute(question, engine, progress)


def _with_files(arguments: Arguments) -> tuple[Catalogue, dict[str, Any]]:
    """The catalogue with the files that a scene is about, and the scene with their names in the place of paths."""
    scene, files, catalogue = dict(arguments["scene"]), arguments["files"], load_catalogue()
    given, asked = scene["model"], scene.get("techniques") or []
    names: list[str] = [asked] if isinstance(asked, str) else asked
    if given in files:
        # A file of a technique runs on the model it is made for, a model with the techniques for models.
        subject = select(given, catalogue, files=files)
        catalogue, scene["model"] = subject.catalogue, subject.model.name
        names = names or [technique.name for technique in subject.techniques]
    else:
        catalogue = with_files(catalogue, files)
    if names:
        names = scene["techniques"] = [name_of(name, catalogue, files) for name in names]
    if given in files:
        entry = catalogue.file_of(given)
        if "model" not in entry.head.provides and entry.name not in names:
            raise BadInput(Problem("techniques", ",".join(names), f"a list with {entry.name}, which is in {given}"))
    return catalogue, scene


WITH_TRUTH = frozenset({"statistics", "convergence"})
"""Tasks whose answers are set beside a float64 truth."""

TASKS: Mapping[str, Callable[[Arguments, Progress, Seal], dict[str, Any]]] = {
    "check": check,
    "replay": replay,
    "statistics": statistics,
    "stability": stability,
    "convergence": convergence,
    "explain": explain,
}
