"""samplerscope explain"""

from __future__ import annotations

from functools import partial
from typing import Any

import click

from service.cli.delivery import ProgressLine, deliver
from service.cli.options import output_options, scene_data, scene_options
from service.cli.own_file import answer_for_files, scene_texts


@click.command(short_help="What a scene's shaders leave out, and what that saves.")
@partial(scene_options, helps={"--method": "Estimator: mc or qmc. Default: mc."})
@partial(output_options, formats="table, json, csv")
def explain(format_: str | None, outputs: tuple[str, ...], device: str | None, **options: Any) -> None:
    """What the shaders of a scene leave out, and what that saves: measured beside those that keep everything.

    The model and techniques may be .glsl files.
    """
    data = scene_data(**options)
    if files := scene_texts(data):
        deliver("explain", lambda: answer_for_files("explain", files, data, device), format_, outputs)
        return
    deliver("explain", lambda: explanation_of(data, device), format_, outputs)


def explanation_of(data: dict[str, Any], device: str | None) -> dict[str, Any]:
    """Open the device and explain the scene, with progress on stderr."""
    from service.catalogue import load_catalogue
    from service.engine import Engine
    from service.explain import compute_explanation, parse_explain_scene
    from service.scene import resolve

    question = resolve(parse_explain_scene(data), load_catalogue())
    with Engine.open(device=device) as engine, ProgressLine() as progress:
        return compute_explanation(question, engine, progress)
