"""Figures and tables of papers, as scenes: the numbers behind `samplerscope figure NAME`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from service.average_albedo import with_average_albedo
from service.engine import Engine
from service.errors import BadInput, Problem
from service.scene import Scene, parse_scene, resolve
from service.statistics import Progress, compute_statistics


@dataclass(frozen=True)
class PaperFigure:
    """A figure of a paper: its scene, and how it is drawn (a chart of `service.figures`).

    `convergence` is a chart of the scene's errors; `timings` is a table of the whole catalogue, without a chart;
    `slices` are values of BRDFs. `average_over` is a swept parameter over which average albedos are shown as well.
    """

    title: str
    scene: Mapping[str, Any]
    chart: Literal["statistics", "roughness", "convergence", "timings", "albedo", "slices"]
    average_over: str | None = None

    @property
    def kind(self) -> str:
        """The kind of its result."""
        return self.chart if self.chart in ("convergence", "timings", "slices") else "statistics"


_SLOPES = [0.1, 0.2, 0.5, 1.0, 2.0]
_MEAN_ONLY = {"statistics": ["mean"], "estimator": {"samples": 100_000}}

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
    "eon-3": PaperFigure(
        title="Oren-Nayar variants at albedo 0.8, sigma 45 degrees or roughness 0.5 (EON paper, figure 3)",
        scene={
            "model": "all",
            "parameters": {"sigma": [math.pi / 4], "roughness": [0.5], "albedo": [0.8]},
            "techniques": ["cosine"],
            "theta_o_deg": [0, 30, 60, 75],
            "estimator": {},
        },
        chart="slices",
    ),
    "eon-6": PaperFigure(
        title="Albedos of QON (EON paper, figure 6)",
        scene={
            "model": "qon",
            "parameters": {"sigma": [k * math.pi / 10 for k in range(6)]},
            "techniques": ["cosine"],
            **_MEAN_ONLY,
        },
        chart="albedo",
        average_over="sigma",
    ),
    "eon-7": PaperFigure(
        title="Albedos of FON (EON paper, figure 7)",
        scene={
            "model": "fon",
            "parameters": {"roughness": [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]},
            "techniques": ["cosine"],
            **_MEAN_ONLY,
        },
        chart="albedo",
        average_over="roughness",
    ),
    "kurt-2": PaperFigure(
        title="Albedo of the physically plausible model, eq. 9, f0 = 1 (Kurt et al. 2010, figure 2)",
        scene={
            "model": "kurt-plausible",
            "parameters": {"mx": _SLOPES, "my": _SLOPES},
            "zip": [["mx", "my"]],
            "techniques": ["beckmann-half-vector"],
            **_MEAN_ONLY,
        },
        chart="albedo",
    ),
    "kurt-3": PaperFigure(
        title="Albedo of the model for fitting, eq. 10, f0 = 1 (Kurt et al. 2010, figure 3)",
        scene={
            "model": "kurt",
            "parameters": {"alpha": [0.0, 0.25, 0.5, 1.0], "mx": _SLOPES, "my": _SLOPES},
            "zip": [["mx", "my"]],
            "techniques": ["beckmann-half-vector"],
            **_MEAN_ONLY,
        },
        chart="albedo",
    ),
    "kurt-sampling": PaperFigure(
        title="Techniques for the model of Kurt et al. 2010, kd = ks = 0.5, m = 0.3 (in place of its figure 11)",
        scene={
            "model": "kurt",
            "parameters": {"kd": [0.5], "ks": [0.5], "alpha": [0.25]},
            "techniques": ["cosine", "uniform", "beckmann-half-vector", "half-vector-cosine"],
            "estimator": {"samples": 1_000_000},
        },
        chart="statistics",
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
    if figure.chart == "slices":
        from service.slices import compute_slices

        return compute_slices(question, engine, progress)
    if figure.chart == "convergence":
        from service.convergence import compute_convergence

        return compute_convergence(question, engine, progress)
    result = compute_statistics(question, engine, progress)
    return result if figure.average_over is None else with_average_albedo(result, figure.average_over)
