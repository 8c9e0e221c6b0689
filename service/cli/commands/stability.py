"""samplerscope stability"""

from __future__ import annotations

from functools import partial
from typing import Any

import click

from service.cli.delivery import StageLine, deliver_with_reports
from service.cli.options import output_options, report_option, scene_data, scene_options
from service.cli.own_file import answer_for_files, scene_texts
from service.scene import parse_scene

IDLE = dict.fromkeys(
    (
        "--zip",
        "--angles",
        "--theta-o-deg",
        "--statistics",
        "--method",
        "--tolerance",
        "--samples",
        "--seed",
        "--no-error-bars",
        "--no-reference",
    )
)
"""Options of a scene that play no part: the edge grid has its own directions, and draws nothing at random."""


@click.command(short_help="Where float32 leaves the truth: stiff and extreme cases.")
@partial(scene_options, helps=IDLE)
@report_option
@partial(output_options, formats="table, json, csv")
def stability(
    reports: tuple[str, ...], format_: str | None, outputs: tuple[str, ...], device: str | None, **options: Any
) -> None:
    """Stiff and extreme cases: float32 against float64 where formulas break.

    Parameters that are set keep their values, the others run over the edges of their ranges. Exits with 1 where a value
    is not finite or far from the truth. The model and techniques may be .glsl files.

    The other options of a scene (view angles, samples, statistics and so on) are accepted and play no part.
    """
    deliver_with_reports("stability", lambda: _run(options, device), reports, format_, outputs)


def _run(options: dict[str, Any], device: str | None) -> dict[str, Any]:
    """A user's file runs in a process of its own; the catalogue here."""
    scene = scene_data(**options)
    if files := scene_texts(scene):
        return answer_for_files("stability", files, scene, device, StageLine)
    from service.isolation.tasks import TASKS, stay_open

    parse_scene(scene)
    with StageLine() as progress:
        return TASKS["stability"]({"files": {}, "scene": scene, "device": device}, progress, stay_open)
