"""Slices of BRDFs: values in the plane of the view, over the angle of the light, as the device evaluates them."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.engine import Engine
from service.probe import Probe
from service.scene import Question, radians
from service.statistics import Progress

LIGHTS = 181


def compute_slices(question: Question, engine: Engine, progress: Progress = lambda *_: None) -> dict[str, Any]:
    """f cos(theta_i) of each model of a question, for each view angle: a result of kind `slices`.

    The light's angle runs from -90 to 90 degrees within the plane of the view; it is positive on the view's side.
    Models that have none of the scene's parameters are left out.
    """
    begin = time.perf_counter()
    theta_i_deg = np.linspace(-90.0, 90.0, LIGHTS)
    asked = set(question.scene.parameters)
    models = {plan.model.name: plan for plan in question.series if asked & set(plan.model.head.parameters) or not asked}
    series = []
    for done, (name, plan) in enumerate(models.items()):
        progress(name, done, len(models))
        parameters = {key: plan.parameters[key] for key in plan.model.head.parameters}
        for angle in question.scene.angles_deg:
            values, _ = values_in_plane(engine, name, parameters, radians(angle), np.radians(theta_i_deg))
            cosines = np.maximum(np.cos(np.radians(theta_i_deg)), 0.0)
            series.append(
                {
                    "model": name,
                    "parameters": parameters,
                    "theta_o_deg": angle,
                    "theta_i_deg": theta_i_deg.tolist(),
                    "value": (values * cosines).tolist(),
                }
            )
    info = engine.device.info
    run = {"device": info.name, "driver": info.driver_version, "elapsed_ms": 1e3 * (time.perf_counter() - begin)}
    scene = question.scene.model_dump(mode="json")
    return {"kind": "slices", "scene": scene, "series": series, "left_out": [], "run": run}


def values_in_plane(
    engine: Engine, model: str, parameters: Mapping[str, float], theta_o: float, theta_i: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """BRDF in 1/sr for directions in the x-z plane, of which x > 0 is the view's side, and the model's own albedo.

    Angles are radians; the albedo is 0 where the model declares none.
    """
    probe = Probe(engine, engine.catalogue.model(model), engine.catalogue.technique("cosine"))
    wo = np.array([[math.sin(theta_o), 0.0, math.cos(theta_o)]])
    wi = np.stack([np.sin(theta_i), np.zeros_like(theta_i), np.cos(theta_i)], axis=1)
    found = probe.evaluate(wo, wi, np.array([[parameters[name] for name in probe.names]]))
    return found.brdf.astype(np.float64), float(found.albedo[0])
