"""samplerscope stats"""

from __future__ import annotations

from typing import Any

import click

from service.cli.delivery import ProgressLine, deliver
from service.cli.options import output_options, scene_data, scene_options
from service.cli.own_file import answer_for_files, scene_texts
from service.scene import Scene, parse_scene


@click.command(short_help="Mean, variance and largest weight, with error bars and verdict.")
@scene_options
@output_options
def stats(format_: str | None, outputs: tuple[str, ...], device: str | None, **options: Any) -> None:
    """Mean, variance and largest weight of techniques across view angles. The model and techniques may be .glsl
    files.
    """
    data = scene_data(**options)
    if files := scene_texts(data):
        deliver("statistics", lambda: answer_for_files("statistics", files, data, device), format_, outputs)
        return
    scene = parse_scene(data)
    deliver("statistics", lambda: statistics_of(scene, device), format_, outputs)


def statistics_of(scene: Scene, device: str | None) -> dict[str, Any]:
    """Open the device and answer the scene, with progress on stderr."""
    from service.catalogue import load_catalogue
    from service.engine import Engine
    from service.scene import resolve
    from service.statistics import compute_statistics

    question = resolve(scene, load_catalogue())
    with Engine.open(device=device) as engine, ProgressLine() as progress:
        return compute_statistics(question, engine, progress)
