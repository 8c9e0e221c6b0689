"""samplerscope figure NAME"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from service.cli.delivery import ProgressLine, deliver
from service.cli.options import given, integer, output_options

if TYPE_CHECKING:
    from service.figures import AnyChart


@click.command(short_help="A figure or table of a paper, by name.")
@click.argument("name")
@click.option("--samples", metavar="N", help="Samples for each angle, in place of the figure's own number.")
@click.option("--seed", metavar="N", help="Seed of the random numbers.")
@output_options
def figure(
    name: str,
    samples: str | None,
    seed: str | None,
    format_: str | None,
    outputs: tuple[str, ...],
    device: str | None,
) -> None:
    """A figure or table of a paper, by name: eon-3, eon-6, eon-7, eon-11, eon-13, eon-convergence, eon-table-1, kurt-2,
    kurt-3, kurt-sampling.
    """
    from service.papers import compute_figure, figure_scene, paper_figure

    paper = paper_figure(name)
    scene = figure_scene(paper, **given(samples=integer("samples", samples), seed=integer("seed", seed)))

    def draw(result: Mapping[str, Any]) -> AnyChart:
        from service import figures

        charts = {
            "statistics": figures.statistics_chart,
            "roughness": figures.roughness_chart,
            "convergence": figures.convergence_chart,
            "albedo": figures.albedo_chart,
            "slices": figures.slices_chart,
        }
        return charts[paper.chart](result, paper.title)

    def compute() -> dict[str, Any]:
        from service.engine import Engine

        with Engine.open(device=device) as engine, ProgressLine() as progress:
            return compute_figure(paper, scene, engine, progress)

    deliver(paper.kind, compute, format_, outputs, None if paper.chart == "timings" else draw)
