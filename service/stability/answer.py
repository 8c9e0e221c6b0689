"""The answer to a question of stability: every technique of a scene over the edge grid."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.catalogue import Entry
from service.engine import Engine
from service.inputs import replay_command
from service.plain_data import plain_data
from service.probe import Probe, Values
from service.scene import Question
from service.stability import regions
from service.stability.stiffness import condition_numbers, direction_rounding_effect, rounding_effect
from service.stability.survey import Comparison, Points, compare, edge_points
from service.statistics import Progress

Array = NDArray[Any]
CONDITION_POINTS = 1 << 14
AT_HORIZON = 16 * 2.0**-24


def compute_stability(question: Question, engine: Engine, progress: Progress = lambda *_: None) -> dict[str, Any]:
    """A result of kind `stability`: the edge grid of each technique, its exceptions, and the stiffest places.

    Parameters that the scene names keep those values; the others run over the edges of their ranges. Azimuths of the
    scene join those of the edge grid; its view angles, samples and statistics play no part. Fails where a value is not
    finite, or far off without a reason.
    """
    begin = time.perf_counter()
    scene = question.scene
    pairs = list(dict.fromkeys((plan.model, plan.technique) for plan in question.series))
    found: dict[str, list[dict[str, Any]]] = {"regions": [], "exceptions": [], "stiffness": [], "checks": []}
    for done, (model, technique) in enumerate(pairs):
        progress(f"{technique.name}: edge grid", done, len(pairs))
        turns = [azimuth / 360 % 1.0 for azimuth in scene.phi_o_deg or []] if model.head.anisotropic else []
        one = survey_pair(engine, model, technique, scene.parameters, turns, first=done == 0)
        given = next((entry.origin for entry in (technique, model) if entry.own), technique.name)
        for check in one["checks"]:
            if check["replay"] is not None:
                check["replay"]["command"] = replay_command(given, check["replay"], engine.catalogue)
        for name, items in one.items():
            found[name] += items
    return {
        "kind": "stability",
        "scene": scene.model_dump(mode="json"),
        "status": "fail" if any(check["status"] == "fail" for check in found["checks"]) else "pass",
        **found,
        "left_out": [],
        "run": engine.run_block(begin),
    }


def survey_pair(
    engine: Engine,
    model: Entry,
    technique: Entry,
    given: Mapping[str, list[float]],
    turns: Sequence[float] = (),
    *,
    first: bool,
) -> dict[str, list[dict[str, Any]]]:
    """Regions, exceptions, stiffness and the check of one model and technique; `turns` are azimuths beside the edges.

    What the model alone answers is the same for every technique: it is compared with the first one only.
    """
    of_the_model = ("brdf", "albedo")[: 1 + ("directional_albedo" in model.declared)] if first else ()
    quantities = (*of_the_model, "direction_pdf")
    probe = Probe(engine, model, technique)
    probe.compile()
    areas, listed, counts = [], [], {"points": 0, "nonfinite": 0, "wrong": 0}
    first_bad: dict[str, Any] | None = None
    for drawn in (True, False):
        points = edge_points(probe, given, drawn, turns)
        truth = points.evaluate(probe, "double")
        single = points.evaluate(probe, "float")
        comparisons = compare(points, single, truth, quantities, _truth_at_rounded(probe, points, single))
        areas += regions.describe_regions(probe, points, comparisons)
        entries, bad = _exceptions(probe, points, comparisons, truth.wi[:, 2])
        listed += entries
        counts["points"] += len(points)
        nonfinite = np.any([c.nonfinite for c in comparisons], axis=0)
        counts["nonfinite"] += int(nonfinite.sum())
        counts["wrong"] += sum(entry["points"] for entry in entries if entry["reason"] == regions.WRONG)
        if nonfinite.any():
            i = int(np.argmax(nonfinite))
            first_bad = first_bad or regions.place(probe, points, next(c for c in comparisons if c.nonfinite[i]), i)
        first_bad = first_bad or bad
    conditions = [
        plain_data(asdict(c)) | {"technique": technique.name} for c in condition_numbers(probe, CONDITION_POINTS)
    ]
    return {
        "regions": areas,
        "exceptions": listed,
        "stiffness": conditions,
        "checks": [_check(technique.name, counts, first_bad)],
    }


def _truth_at_rounded(probe: Probe, points: Points, single: Values) -> Values | None:
    """The true values at the float32 directions that were drawn; None where none of density and BRDF is infinite."""
    if not points.drawn or not (np.isinf(single.pdf) | np.isinf(single.brdf)).any():
        return None
    return probe.evaluate(points.wo, single.wi, points.parameters, "double")


def _exceptions(
    probe: Probe, points: Points, comparisons: list[Comparison], height: Array
) -> tuple[list[dict[str, Any]], dict[str, Any] | None]:
    """The list of exceptions, and the place of one that is wrong, if any."""
    listed: list[dict[str, Any]] = []
    wrong: dict[str, Any] | None = None
    over = points.inside & np.any([c.ulp > regions.ULP_LIMIT for c in comparisons], axis=0)
    if not over.any():
        return listed, wrong
    kept, at_horizon = points[over], points.drawn & (np.abs(height[over]) < AT_HORIZON)
    effects = rounding_effect(probe, kept)
    of_direction = direction_rounding_effect(probe, kept) if points.drawn else {}
    for c in comparisons:
        part = Comparison(c.quantity, c.value[over], c.truth[over], c.ulp[over], c.nonfinite[over], c.beyond[over])
        for e in regions.exceptions(kept, part, effects[c.quantity], at_horizon, of_direction.get(c.quantity)):
            where = regions.place(probe, kept, part, e.worst)
            listed.append(
                {
                    "technique": probe.technique.name,
                    "quantity": e.quantity,
                    "reason": e.reason,
                    "points": e.points,
                    "worst_ulp": e.ulp,
                    "by_rounded_inputs_ulp": e.effect,
                    "by_rounded_direction_ulp": e.direction_effect,
                    "relative_error": e.relative,
                    "worst": where,
                }
            )
            if e.reason == regions.WRONG:
                wrong = wrong or where
    return plain_data(listed), wrong


def _check(technique: str, counts: Mapping[str, int], bad: Mapping[str, Any] | None) -> dict[str, Any]:
    failed = counts["nonfinite"] or counts["wrong"]
    found = f"{counts['nonfinite']:,} not finite, {counts['wrong']:,} unstable"
    limit = f"within {regions.ULP_LIMIT:g} ulp, or listed with its reason"
    return {
        "name": "stability",
        "technique": technique,
        "status": "fail" if failed else "pass",
        "message": f"{counts['points']:,} points of the edge grid: {found}",
        "evidence": dict(counts),
        "power": f"float32 against the same code in float64; {limit}",
        "replay": plain_data(bad["inputs"]) if failed and bad else None,
    }
