"""samplerscope stability"""

from __future__ import annotations

from typing import Any

import click

from service.catalogue import is_file
from service.cli.delivery import StageLine, deliver_with_reports
from service.cli.options import output_options, report_option, scene_data, scene_options
from service.cli.own_file import answer_for_file
from service.scene import parse_scene


@click.command()
@scene_options
@report_option
@output_options
def stability(
    reports: tuple[str, ...], format_: str | None, outputs: tuple[str, ...], device: str | None, **options: Any
) -> None:
    """Stiff and extreme cases: float32 against float64 where formulas break.

    Parameters that are set keep their values, the others run over the edges of their ranges. Exits with 1 where a value
    is not finite or far from the truth.
    """
    deliver_with_reports(lambda: _run(options, device), reports, format_, outputs)


def _run(options: dict[str, Any], device: str | None) -> dict[str, Any]:
    """A user's file runs in a process of its own; the catalogue here."""
    from service.isolation.tasks import TASKS, stay_open

    path, scene = options["model"], scene_data(**options)
    if is_file(path):
        return answer_for_file("stability", path, scene, device, StageLine)
    parse_scene(scene)
    with StageLine() as progress:
        return TASKS["stability"]({"file": None, "scene": scene, "device": device}, progress, stay_open)
