"""Slices: BRDFs and densities in the plane of the view, over the angle of the light, as the device evaluates them."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.engine import Engine
from service.plain_data import finite_or_none
from service.probe import Probe
from service.scene import Question, SeriesPlan
from service.statistics import Progress

LIGHTS = 181


def compute_slices(question: Question, engine: Engine, progress: Progress = lambda *_: None) -> dict[str, Any]:
    """f cos(theta_i) and the density of each series of a question, for each view angle: a result of kind `slices`.

    Both are in 1/sr. The light's angle runs from -90 to 90 degrees within the plane of the view; it is positive on the
    view's side. A density that is not finite is null. Models that have none of the scene's parameters are left out.
    """
    begin = time.perf_counter()
    asked = set(question.scene.parameters)
    plans = [plan for plan in question.series if asked & set(plan.model.head.parameters) or not asked]
    series = []
    for done, plan in enumerate(plans):
        progress(plan.technique.name, done, len(plans))
        series += _series(plan, question.scene.angles_deg, engine)
    scene = question.scene.model_dump(mode="json")
    return {"kind": "slices", "scene": scene, "series": series, "left_out": [], "run": engine.run_block(begin)}


def _series(plan: SeriesPlan, angles_deg: Sequence[float], engine: Engine) -> list[dict[str, Any]]:
    """One series of the result for each view angle; all are evaluated together."""
    theta_i_deg = np.linspace(-90.0, 90.0, LIGHTS)
    azimuth = math.radians(plan.azimuth_deg)
    wo = _in_plane(np.radians(angles_deg), azimuth)
    wi = _in_plane(np.radians(theta_i_deg), azimuth)
    probe = Probe(engine, plan.model, plan.technique)
    found = probe.evaluate(
        np.repeat(wo, LIGHTS, axis=0),
        np.tile(wi, (len(angles_deg), 1)),
        np.array([[plan.parameters[name] for name in probe.names]]),
    )
    cosines = np.maximum(np.cos(np.radians(theta_i_deg)), 0.0)
    values = found.brdf.astype(np.float64).reshape(-1, LIGHTS) * cosines
    densities = found.direction_pdf.astype(np.float64).reshape(-1, LIGHTS)
    names = {"model": plan.model.name, "technique": plan.technique.name}
    head: dict[str, Any] = {**names, "parameters": dict(plan.parameters)}
    if plan.phi_o_deg is not None:
        head["phi_o_deg"] = plan.phi_o_deg
    return [
        {
            **head,
            "theta_o_deg": angle,
            "theta_i_deg": theta_i_deg.tolist(),
            "value": finite_or_none(value),
            "pdf": finite_or_none(density),
        }
        for angle, value, density in zip(angles_deg, values, densities, strict=True)
    ]


def _in_plane(theta: NDArray[np.float64], azimuth: float) -> NDArray[np.float64]:
    """Directions (n, 3) at these angles to the normal, in the vertical plane of an azimuth; radians."""
    sines = np.sin(theta)
    return np.stack([sines * math.cos(azimuth), sines * math.sin(azimuth), np.cos(theta)], axis=1)
