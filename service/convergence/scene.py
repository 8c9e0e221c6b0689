"""The scene of a convergence study: that of statistics, with a target error, replicates and estimators."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field, ValidationError

from service.errors import BadInput, Problem
from service.scene import (
    ALL_MODELS,
    MAX_ANGLES,
    MAX_NAMES,
    METHODS,
    Angle,
    AngleCount,
    Estimator,
    Method,
    Scene,
    scene_problems,
)


class ConvergenceScene(Scene):
    """A scene with what a study of errors needs beyond it.

    `estimator.samples` is the largest count of the curves, to the nearest power of two and at least 128: a slope needs
    four counts. `estimator.method`, where it is given, is the only estimator. `efficiency_over` names the parameters
    that the efficiency table sweeps; empty, these are all that the techniques read.
    """

    theta_o_deg: AngleCount | Annotated[list[Angle], Field(min_length=1, max_length=MAX_ANGLES)] = Field(
        default_factory=lambda: [0.0, 45.0, 80.0, 89.0]
    )
    estimator: Estimator = Estimator(method="mc", samples=2**20)
    target_error: float = Field(0.01, gt=0, lt=1, allow_inf_nan=False)
    replicates: int = Field(32, ge=32, le=1024)
    estimators: list[Method] = Field(default_factory=lambda: list(METHODS), min_length=1, max_length=MAX_NAMES)
    efficiency_over: list[str] = Field(default_factory=list, max_length=MAX_NAMES)

    @property
    def counts(self) -> list[int]:
        """Sample counts of the curves: 2^4 up to the power of two nearest to the samples asked for."""
        last = max(7, round(math.log2(self.estimator.samples)))
        return [2**k for k in range(4, last + 1)]


def parse_convergence_scene(data: Mapping[str, Any]) -> ConvergenceScene:
    """Check the form of a scene. BadInput names every wrong field."""
    given = dict(data)
    if given.get("model") == ALL_MODELS:
        raise BadInput(Problem("model", ALL_MODELS, "the name of one model"))
    estimator = given.get("estimator")
    if isinstance(estimator, Mapping):
        if estimator.get("method") is not None and "estimators" not in given:
            given["estimators"] = [estimator["method"]]
        given["estimator"] = {"samples": 2**20, **estimator}
    try:
        return ConvergenceScene.model_validate(given)
    except ValidationError as error:
        raise BadInput(scene_problems(error)) from None
