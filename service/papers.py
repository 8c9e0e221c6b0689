"""Figures and tables of papers, as scenes: the numbers behind `samplerscope figure NAME`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from service.engine import Engine
from service.errors import BadInput, Problem
from service.scene import Scene, parse_scene, resolve
from service.statistics import Progress, compute_statistics


@dataclass(frozen=True)
class PaperFigure:
    """A figure of a paper: its scene, and how it is drawn (a chart of `service.figures`).

    `convergence` is a chart of the scene's errors; `timings` is a table of the whole catalogue, without a chart.
    """

    title: str
    scene: Mapping[str, Any]
    chart: Literal["statistics", "roughness", "convergence", "timings"]


FIGURES: Mapping[str, PaperFigure] = {
    "eon-11": PaperFigure(
        title="Throughput weight of EON at roughness 1, six techniques (EON paper, figure 11)",
        scene={
            "model": "eon",
            "parameters": {"roughness": [1.0]},
            "techniques": ["cosine", "uniform", "ltc-nonnegative", "ltc", "cltc", "cltc-mis"],
            "theta_o_deg": {"count": 64},
            "estimator": {"samples": 1_000_000},
        },
        chart="statistics",
    ),
    "eon-13": PaperFigure(
        title="Throughput weight of EON across roughness, cosine and CLTC + uniform (EON paper, figure 13)",
        scene={
            "model": "eon",
            "parameters": {"roughness": [0.0, 0.25, 0.5, 0.75, 1.0]},
            "techniques": ["cosine", "cltc-mis"],
            "theta_o_deg": {"count": 64},
            "statistics": ["variance", "max_weight"],
            "estimator": {"samples": 1_000_000},
        },
        chart="roughness",
    ),
    "eon-convergence": PaperFigure(
        title="Error against run time for EON at roughness 1: six techniques, three estimators",
        scene={
            "model": "eon",
            "parameters": {"roughness": [1.0]},
            "techniques": ["cosine", "uniform", "ltc-nonnegative", "ltc", "cltc", "cltc-mis"],
            "theta_o_deg": [0.0, 45.0, 80.0, 89.0],
            "estimator": {"samples": 2**20},
        },
        chart="convergence",
    ),
    "eon-table-1": PaperFigure(
        title="What a call costs, for every model and technique (EON paper, table 1)",
        scene={"model": "eon", "estimator": {}},
        chart="timings",
    ),
}


def paper_figure(name: str) -> PaperFigure:
    """The figure of this name; BadInput lists the names there are."""
    if name not in FIGURES:
        raise BadInput(Problem("figure", name, "one of " + ", ".join(FIGURES)))
    return FIGURES[name]


def figure_scene(figure: PaperFigure, **estimator: int) -> Scene:
    """The scene of a figure, with its samples or seed replaced where they are given."""
    scene = {**figure.scene, "estimator": {**figure.scene["estimator"], **estimator}}
    if figure.chart == "convergence":
        from service.convergence.scene import parse_convergence_scene

        return parse_convergence_scene(scene)
    return parse_scene(scene)


def compute_figure(figure: PaperFigure, scene: Scene, engine: Engine, progress: Progress) -> dict[str, Any]:
    """The result behind a figure: statistics, convergence or timings, by what is drawn."""
    if figure.chart == "timings":
        from service.convergence import compute_timings

        return compute_timings(engine, progress=progress)
    question = resolve(scene, engine.catalogue)
    if figure.chart == "convergence":
        from service.convergence import compute_convergence

        return compute_convergence(question, engine, progress)
    return compute_statistics(question, engine, progress)
