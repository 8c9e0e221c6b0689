"""What a worker can do: functions from plain data to a result, one a command."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from service.catalogue import load_catalogue
from service.checks import Battery, run_battery, select
from service.checks.replaying import replay_inputs
from service.engine import Engine
from service.scene import parse_scene, resolve
from service.statistics import compute_statistics

Arguments = Mapping[str, Any]
Progress = Callable[[str, int, int], None]


def check(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """The battery over `subject`: a file, or a name of the catalogue."""
    subject = select(arguments["subject"], load_catalogue(), arguments["model"], arguments["techniques"], arguments["fixed"])
    with Engine.open(subject.catalogue, device=arguments["device"]) as engine:
        return run_battery(engine, subject, Battery(arguments["seed"], arguments["quick"]), progress)


def replay(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """One evaluation of `subject` again."""
    subject = select(arguments["subject"], load_catalogue(), arguments["model"], arguments["techniques"], arguments["fixed"])
    progress("compiling", 0, 1)
    with Engine.open(subject.catalogue, device=arguments["device"]) as engine:
        return replay_inputs(engine, subject, arguments["wo"], arguments["u"], arguments["wi"])


def statistics(arguments: Arguments, progress: Progress) -> dict[str, Any]:
    """Statistics of a scene whose model or technique is a user's file."""
    catalogue = load_catalogue().with_file(Path(arguments["file"]))
    question = resolve(parse_scene(arguments["scene"]), catalogue)
    progress("compiling", 0, 1)
    with Engine.open(catalogue, device=arguments["device"]) as engine:
        return compute_statistics(question, engine, progress)


TASKS: Mapping[str, Callable[[Arguments, Progress], dict[str, Any]]] = {
    "check": check,
    "replay": replay,
    "statistics": statistics,
}
