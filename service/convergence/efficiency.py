"""Efficiency, 1 / (relative variance x time of a call), across view angles and parameters: who wins, by how much."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from service.catalogue import Parameter
from service.convergence.cost import Cost
from service.convergence.scene import ConvergenceScene
from service.convergence.truth import Array, relative_variances
from service.engine import Engine
from service.errors import BadInput, Problem
from service.scene import Question, SeriesPlan

ANGLES_DEG = [0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0, 89.0, 89.9]
STEPS = 5  # values of a parameter that is not set in the scene, over its range
LEAST_RELATIVE_VARIANCE = 1e-9  # below it a weight is constant up to rounding, and one call is enough


def efficiency_table(question: Question, engine: Engine, costs: Mapping[str, Cost]) -> dict[str, Any]:
    """The table over ANGLES_DEG and the parameters that the techniques read; arrays are (rows, techniques, angles).

    `efficiency` is in 1/s: the inverse of relative variance times the seconds of a call. It is null where the variance
    is infinite. `winner` and `lead` (over the second) are (rows, angles), null where there is no first or no second.
    """
    scene: ConvergenceScene = question.scene.model_copy(update={"theta_o_deg": ANGLES_DEG})  # type: ignore[assignment]
    plans: dict[str, SeriesPlan] = {}
    for plan in question.series:
        plans.setdefault(plan.technique.name, plan)
    rows = _rows(question, engine)
    columns = []
    for name, plan in plans.items():
        declared = engine.catalogue.parameters_of(plan.model, plan.technique)
        mine = [{key: row.get(key, plan.parameters[key]) for key in declared} for row in rows]
        variance, mean = relative_variances(replace(plan, parameters=mine[0]), scene, engine, mine)
        # Where no sample met the lobe the mean is 0, and nothing is known of the relative variance.
        seen = mean > 0.0
        relative = np.where(seen, variance / np.where(seen, mean, 1.0) ** 2, np.inf)
        relative = np.maximum(relative, LEAST_RELATIVE_VARIANCE)
        columns.append(1e9 / (relative * costs[name].call_ns))
    table = np.stack(columns, axis=1)
    names = list(plans)
    return {
        "parameters": rows,
        "techniques": names,
        "theta_o_deg": ANGLES_DEG,
        "efficiency": [[[_value(x) for x in angles] for angles in row] for row in table],
        "winner": [[_winner(names, column) for column in row.T] for row in table],
        "lead": [[_lead(column) for column in row.T] for row in table],
    }


def _winner(names: Sequence[str], efficiencies: Array) -> str | None:
    return names[int(np.argmax(efficiencies))] if efficiencies.max() > 0 else None


def _lead(efficiencies: Array) -> float | None:
    ordered = np.sort(efficiencies)[::-1]
    return float(ordered[0] / ordered[1]) if len(ordered) > 1 and ordered[1] > 0 else None


def _value(x: float) -> float | None:
    return float(x) if x > 0 else None


def require_swept(question: Question, engine: Engine) -> None:
    """Raise BadInput where `efficiency_over` names what is no parameter."""
    asked, declared = cast(ConvergenceScene, question.scene).efficiency_over, _declared(question, engine)
    if not set(asked) <= set(declared):
        raise BadInput(Problem("efficiency_over", ", ".join(asked), "parameters out of " + ", ".join(declared)))


def _declared(question: Question, engine: Engine) -> dict[str, Parameter]:
    found = {**question.series[0].model.head.parameters}
    for plan in question.series:
        found |= engine.catalogue.parameters_of(plan.model, plan.technique)
    return found


def _rows(question: Question, engine: Engine) -> list[dict[str, float]]:
    """The sets of parameter values of the table.

    Parameters that the scene sets have its values. What the techniques read, or what `efficiency_over` names, takes
    STEPS values over its range.
    """
    scene = cast(ConvergenceScene, question.scene)
    read = {name for plan in question.series for name in (*plan.technique.head.uses, *plan.technique.head.parameters)}
    axes: dict[str, Sequence[float]] = {}
    declared = _declared(question, engine)
    if scene.efficiency_over:
        read = set(scene.efficiency_over)
    for name, parameter in declared.items():
        if name in question.scene.parameters:
            axes[name] = question.scene.parameters[name]
        elif name in read:
            axes[name] = np.linspace(parameter.min, parameter.max, STEPS).tolist()
        else:
            axes[name] = [parameter.default]
    # A parameter set to one value is swept all the same where techniques read it: the question is where each wins.
    for name in read & set(axes):
        if len(axes[name]) == 1:
            parameter = declared[name]
            axes[name] = sorted({*np.linspace(parameter.min, parameter.max, STEPS).tolist(), *axes[name]})
    return [dict(zip(axes, values, strict=True)) for values in itertools.product(*axes.values())]
