"""samplerscope stats"""

from __future__ import annotations

from typing import Any

import click

from service.catalogue import is_file
from service.cli.delivery import ProgressLine, deliver
from service.cli.options import output_options, scene_data, scene_options
from service.cli.own_file import answer_for_file
from service.scene import Scene, parse_scene


@click.command()
@scene_options
@output_options
def stats(format_: str | None, outputs: tuple[str, ...], device: str | None, **options: Any) -> None:
    """Mean, variance and largest weight of techniques across view angles. The model may be a .glsl file."""
    path = options["model"]
    if is_file(path):
        deliver(lambda: answer_for_file("statistics", path, scene_data(**options), device), format_, outputs)
        return
    scene = parse_scene(scene_data(**options))
    deliver(lambda: statistics_of(scene, device), format_, outputs)


def statistics_of(scene: Scene, device: str | None) -> dict[str, Any]:
    """Open the device and answer the scene, with progress on stderr."""
    from service.catalogue import load_catalogue
    from service.engine import Engine
    from service.scene import resolve
    from service.statistics import compute_statistics

    question = resolve(scene, load_catalogue())
    with Engine.open(device=device) as engine, ProgressLine() as progress:
        return compute_statistics(question, engine, progress)
