"""Which scenes can be explained: those whose shaders draw samples."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.errors import BadInput, Problem
from service.explain.timing import LAUNCH_SAMPLES, ROUNDS
from service.left_out import features_left_out
from service.scene import Question, Scene, parse_scene


def parse_explain_scene(data: Mapping[str, Any]) -> Scene:
    """Check the form of a scene as `service.scene.parse_scene` does; BadInput as well for an estimator that draws none.

    `estimator.samples`, `estimator.seed` and `reference` have no influence.
    """
    scene = parse_scene(data)
    estimator = scene.estimator
    if estimator.method not in ("mc", "qmc") or estimator.tolerance is not None:
        name = "tolerance" if estimator.tolerance is not None else "method"
        given = estimator.tolerance if estimator.tolerance is not None else estimator.method
        raise BadInput(Problem(f"estimator.{name}", given, "method mc or qmc, without a tolerance, for explain"))
    return scene


def draws(question: Question) -> int:
    """About how many samples the measurement draws."""
    shaders = {
        (plan.model.name, plan.technique.name, features): len(features) + 2
        for plan in question.series
        for features in [tuple(feature.name for feature in features_left_out(plan, question.scene))]
    }
    return sum(shaders.values()) * ROUNDS * LAUNCH_SAMPLES
