"""What a worker can do: functions from plain data to a result, one a command."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from service.catalogue import load_catalogue
from service.checks.battery import Battery, run_battery
from service.checks.replaying import replay_inputs
from service.checks.selection import select
from service.convergence import compute_convergence, parse_convergence_scene
from service.engine import Engine
from service.scene import Scene, parse_scene, resolve
from service.stability import compute_stability
from service.statistics import compute_statistics

Arguments = Mapping[str, Any]
Progress = Callable[[str, int, int], None]
Parse = Callable[[Mapping[str, Any]], Scene]


def check(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """The battery over `subject`: a file, or a name of the catalogue."""
    subject = select(
        arguments["subject"], load_catalogue(), arguments["model"], arguments["techniques"], arguments["fixed"]
    )
    with Engine.open(subject.catalogue, device=arguments["device"]) as engine:
        return run_battery(engine, subject, Battery(arguments["seed"], arguments["quick"]), progress)


def replay(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """One evaluation of `subject` again."""
    subject = select(
        arguments["subject"], load_catalogue(), arguments["model"], arguments["techniques"], arguments["fixed"]
    )
    progress("compiling", 0, 1)
    with Engine.open(subject.catalogue, device=arguments["device"]) as engine:
        return replay_inputs(engine, subject, arguments["wo"], arguments["u"], arguments["wi"])


def statistics(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """Statistics of a scene whose model or technique is a user's file."""
    return _of_scene(compute_statistics, parse_scene, arguments, progress)


def stability(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """Stability of a scene whose model or technique may be a user's file."""
    return _of_scene(compute_stability, parse_scene, arguments, progress)


def convergence(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """Error against run time of a scene whose model or technique is a user's file."""
    return _of_scene(compute_convergence, parse_convergence_scene, arguments, progress)


def _of_scene(
    compute: Callable[..., dict[str, Any]], parse: Parse, arguments: Arguments, progress: Progress
) -> dict[str, Any]:
    catalogue = load_catalogue()
    if arguments["file"] is not None:
        catalogue = catalogue.with_file(Path(arguments["file"]))
    question = resolve(parse(arguments["scene"]), catalogue)
    progress("compiling", 0, 1)
    with Engine.open(catalogue, device=arguments["device"]) as engine:
        return compute(question, engine, progress)


def file_scene(path: str, scene: Mapping[str, Any], parse: Parse = parse_scene) -> dict[str, Any]:
    """A scene whose model is given as a path: by name, with the techniques that go with the file.

    `parse` checks the form of a scene of its kind. A file of a technique runs on the model it is made for.
    Raises as reading the file and checking the scene do.
    """
    subject = select(path, load_catalogue())
    techniques = scene.get("techniques") or [technique.name for technique in subject.techniques]
    out = {**scene, "model": subject.model.name, "techniques": techniques}
    resolve(parse(out), subject.catalogue)
    return out


TASKS: Mapping[str, Callable[[Arguments, Progress], dict[str, Any]]] = {
    "check": check,
    "replay": replay,
    "statistics": statistics,
    "stability": stability,
    "convergence": convergence,
}
