"""Questions about a user's own file, answered in a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from service.cli.delivery import ProgressLine


def answer_for_file(
    task: str, path: str, scene: dict[str, Any], device: str | None, line: type[ProgressLine] = ProgressLine
) -> dict[str, Any]:
    """Answer a scene whose model or technique is the file at `path`, with progress on stderr in the form of `line`.

    Raises BadInput for a file that cannot be read, and what `service.isolation.run_isolated` does.
    """
    from service.catalogue import own_text
    from service.isolation import run_isolated

    arguments = {"file": path, "text": own_text(Path(path)), "scene": scene, "device": device}
    with line() as progress:
        return run_isolated(task, arguments, progress)
