"""samplerscope converge"""

from __future__ import annotations

from functools import partial
from typing import Any

import click

from service.cli.delivery import ProgressLine, deliver
from service.cli.options import given, integer, names, number, output_options, scene_data, scene_options
from service.cli.own_file import answer_for_files, scene_texts
from service.convergence.scene import ConvergenceScene, parse_convergence_scene


@click.command(short_help="Error against run time: which technique is quiet first.")
@partial(
    scene_options,
    helps={
        "--model": "A name or a .glsl file. Default: eon.",
        "--angles": "N view angles from 0 to 89.91 degrees.",
        "--theta-o-deg": "View angles in degrees, 0 to below 90. Default: 0,45,80,89.",
        "--method": "Out of mc, qmc, quadrature, separated by commas. Default: all.",
        "--samples": "Largest count of the curves, to the nearest power of 2, 128 at least. Default: 1048576.",
        "--statistics": None,
        "--tolerance": None,
        "--no-error-bars": None,
        "--no-reference": None,
    },
)
@click.option("--target-error", metavar="X", help="Relative error whose time is asked for. Default: 0.01.")
@click.option("--replicates", metavar="N", help="Independent replicates of each curve. Default: 32.")
@click.option("--efficiency-over", metavar="NAME,...", help="What the efficiency table sweeps. Default: all read.")
@output_options
def converge(
    target_error: str | None,
    replicates: str | None,
    efficiency_over: str | None,
    method: str | None,
    format_: str | None,
    outputs: tuple[str, ...],
    device: str | None,
    **options: Any,
) -> None:
    """Error against run time: which technique reaches a target first, and which estimator measures it first. The model
    and techniques may be .glsl files.

    The other options of a scene (--statistics, --tolerance, --no-error-bars, --no-reference) are accepted and play no
    part.
    """
    data = scene_data(method=None, **options) | given(
        target_error=number("target_error", target_error),
        replicates=integer("replicates", replicates),
        estimators=names(method),
        efficiency_over=names(efficiency_over),
    )
    if files := scene_texts(data):
        deliver("convergence", lambda: answer_for_files("convergence", files, data, device), format_, outputs)
        return
    scene = parse_convergence_scene(data)
    deliver("convergence", lambda: convergence_of(scene, device), format_, outputs)


def convergence_of(scene: ConvergenceScene, device: str | None) -> dict[str, Any]:
    """Open the device and answer the scene, with progress on stderr."""
    from service.catalogue import load_catalogue
    from service.convergence import compute_convergence
    from service.engine import Engine
    from service.scene import resolve

    question = resolve(scene, load_catalogue())
    with Engine.open(device=device) as engine, ProgressLine() as progress:
        return compute_convergence(question, engine, progress)
