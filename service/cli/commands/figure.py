"""samplerscope figure NAME"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from service.cli.commands.stats import statistics_of
from service.cli.delivery import deliver
from service.cli.options import given, integer, output_options

if TYPE_CHECKING:
    from service.figures import AnyChart


@click.command()
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
    """A figure of a paper, by name: eon-11, eon-13."""
    from service.papers import figure_scene, paper_figure

    paper = paper_figure(name)
    scene = figure_scene(paper, **given(samples=integer("samples", samples), seed=integer("seed", seed)))

    def draw(result: Mapping[str, Any]) -> AnyChart:
        from service import figures

        charts = {"statistics": figures.statistics_chart, "roughness": figures.roughness_chart}
        return charts[paper.chart](result, paper.title)

    deliver(lambda: statistics_of(scene, device), format_, outputs, draw)
