"""samplerscope stability"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from service.cli.delivery import StageLine, deliver
from service.cli.options import output_options, scene_data, scene_options
from service.scene import parse_scene

EXIT_FAILED = 1


@click.command()
@scene_options
@click.option(
    "--report", "reports", multiple=True, metavar="FILE", help="Report card as .html, .json or .md; repeatable."
)
@output_options
def stability(
    reports: tuple[str, ...], format_: str | None, outputs: tuple[str, ...], device: str | None, **options: Any
) -> None:
    """Stiff and extreme cases: float32 against float64 where formulas break.

    Parameters that are set keep their values, the others run over the edges of their ranges. Exits with 1 where a value
    is not finite or far from the truth.
    """
    from service.reports import require_report, write_report

    for path in reports:
        require_report(path)
    result: dict[str, Any] = {}

    def compute() -> dict[str, Any]:
        result.update(_run(options, device))
        for path in reports:
            write_report(result, path)
        return result

    deliver(compute, format_, outputs)
    if result["status"] == "fail":
        sys.exit(EXIT_FAILED)


def _run(options: dict[str, Any], device: str | None) -> dict[str, Any]:
    """A user's file runs in a process of its own; the catalogue here."""
    from service.catalogue import own_text
    from service.cli.options import is_file
    from service.isolation import run_isolated
    from service.isolation.tasks import TASKS, stay_open

    arguments: dict[str, Any] = {"file": None, "text": None, "scene": scene_data(**options), "device": device}
    with StageLine() as progress:
        if is_file(options["model"]):
            path = options["model"]
            return run_isolated("stability", arguments | {"file": path, "text": own_text(Path(path))}, progress)
        parse_scene(arguments["scene"])
        return TASKS["stability"](arguments, progress, stay_open)
