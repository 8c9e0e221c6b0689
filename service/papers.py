"""Figures of papers, as scenes: the numbers behind `samplerscope figure NAME`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from service.errors import BadInput, Problem
from service.scene import Scene, parse_scene


@dataclass(frozen=True)
class PaperFigure:
    """A figure of a paper: its scene, and how it is drawn (a chart of `service.figures`)."""

    title: str
    scene: Mapping[str, Any]
    chart: Literal["statistics", "roughness"]


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
}


def paper_figure(name: str) -> PaperFigure:
    """The figure of this name; BadInput lists the names there are."""
    if name not in FIGURES:
        raise BadInput(Problem("figure", name, "one of " + ", ".join(FIGURES)))
    return FIGURES[name]


def figure_scene(figure: PaperFigure, **estimator: int) -> Scene:
    """The scene of a figure, with its samples or seed replaced where they are given."""
    return parse_scene({**figure.scene, "estimator": {**figure.scene["estimator"], **estimator}})
