"""Questions about a user's own files, answered in a process of its own."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from service.catalogue import is_file, own_text
from service.cli.delivery import ProgressLine


def own_texts(given: Iterable[str | None]) -> dict[str, str]:
    """The texts of those that are files, by path. Raises BadInput for one that cannot be read."""
    return {path: own_text(Path(path)) for path in given if path is not None and is_file(path)}


def scene_texts(scene: dict[str, Any]) -> dict[str, str]:
    """The texts of the files that a scene has in the place of its model and techniques, by path; raises BadInput."""
    return own_texts([scene["model"], *scene.get("techniques", [])])


def answer_for_files(
    task: str, files: dict[str, str], scene: dict[str, Any], device: str | None, line: type[ProgressLine] = ProgressLine
) -> dict[str, Any]:
    """Answer a scene whose model or techniques are among `files` (texts by path), with progress on stderr.

    Raises what `service.isolation.run_isolated` does.
    """
    from service.isolation import run_isolated

    with line() as progress:
        return run_isolated(task, {"files": files, "scene": scene, "device": device}, progress)
