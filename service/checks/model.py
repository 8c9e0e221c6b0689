"""Checks of the model alone, in double precision: reciprocity and energy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.checks.effort import Effort
from service.checks.outcome import Outcome, failed, passed
from service.checks.sphere_quadrature import cut, grid, integrate
from service.inputs import inner_value, random_settings, replay, settings, view_directions
from service.probe import Probe
from service.verdict import ENERGY_LIMIT

Array = NDArray[Any]

RECIPROCITY = 1e-6
SHARE = 1e-3
DECLARED = 2e-4
"""Difference of the declared directional albedo from the integral, as a share of it, that counts."""

_NORMAL = np.array([0.0, 0.0, 1.0])
_VIEWS = np.radians([1.0, 30.0, 60.0, 75.0, 85.0, 89.0, 89.9])


def check_reciprocity(probe: Probe, points: int, rng: np.random.Generator) -> Outcome:
    """f(wi, wo) = f(wo, wi)."""
    wi, wo = (
        view_directions(np.arccos(rng.uniform(0.01, 1, points)), rng.uniform(0, 2 * np.pi, points)) for _ in range(2)
    )
    parameters = random_settings(probe.declared, 256, rng)[rng.integers(0, 256, points)]
    there = probe.evaluate(wo, wi, parameters, "double").brdf
    back = probe.evaluate(wi, wo, parameters, "double").brdf
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        off = np.abs(there - back) / np.maximum(np.abs(there), np.abs(back))
    # What is below 1e-30 of a usual value carries no light; its relative error is that of an exponent.
    counts = np.isfinite(off) & (np.maximum(np.abs(there), np.abs(back)) > 1e-30)
    wrong = counts & (off > RECIPROCITY)
    share = float(wrong.sum() / max(1, counts.sum()))
    largest = float(np.max(off[counts], initial=0.0))
    power = (
        f"{points:,} random pairs of directions; a relative difference above {RECIPROCITY:g} in more than {SHARE:.1%}"
    )
    if share <= SHARE:
        return passed(
            "reciprocity",
            f"f(wi, wo) = f(wo, wi) within {np.median(off[counts]) if counts.any() else 0:.1g} (median)",
            power,
            share=share,
        )
    i = int(np.argmax(np.where(wrong, off, -1)))
    return failed(
        "reciprocity",
        f"f(wi, wo) and f(wo, wi) differ by up to {largest:.3g}, at {share:.1%} of the pairs",
        power,
        replay(probe, wo[i], parameters[i], wi=wi[i]),
        share=share,
        there=float(there[i]),
        back=float(back[i]),
    )


def albedos(
    probe: Probe, theta_o: Array, parameters: Array, points: int, goal: float = 1e-5, order: int = 4
) -> tuple[Array, Array, Array]:
    """Directional albedos by quadrature, those that the model declares, and an error estimate; each (n,)."""
    wo = view_directions(theta_o, np.full(len(theta_o), 0.3))

    def reflected(wi: Array, cell: Array) -> Array:
        values = probe.evaluate(wo[cell], wi, parameters[cell], "double")
        f = np.where(np.isfinite(values.brdf), values.brdf, 0.0)
        return np.asarray(f * wi[:, 2])[None]

    boxes = cut(grid(len(wo), 2, 4, sphere=False), np.pi if order < 6 else np.pi / 32)
    found = integrate(boxes, reflected, (len(wo), 8), goal, points, order)
    declared = probe.evaluate(wo, wo, parameters, "double").albedo
    return found.total[0], declared, found.error[0]


def check_energy(probe: Probe, effort: Effort, rng: np.random.Generator) -> Outcome:
    """No view reflects more light than it gets, at any setting; a declared albedo is the integral."""
    values = np.concatenate(
        [settings(probe.declared, effort.energy_rows), random_settings(probe.declared, effort.energy_rows, rng)]
    )
    parameters = np.repeat(values, len(_VIEWS), axis=0)
    theta = np.tile(_VIEWS, len(values))
    albedo, declared, error = albedos(probe, theta, parameters, effort.energy_quadrature // 2)
    has_own = "directional_albedo" in probe.model.declared
    off = np.where(has_own & (albedo > 1e-6), np.abs(declared - albedo) - 2 * error, 0.0) / np.maximum(albedo, 1e-6)
    surely = albedo - error  # where lobes are too narrow for this quadrature it also errs upwards, by far
    for _ in range(effort.energy_rounds):
        theta, parameters, surely = _nearby(probe, theta, parameters, surely, effort, rng)
    power = (
        f"{len(values)} settings at {len(_VIEWS)} views, then {effort.energy_rounds} rounds of search around the "
        f"largest; an albedo above {ENERGY_LIMIT:g} that covers more than a hundredth of the ranges"
    )
    theta, parameters = (column[np.argsort(-surely)[:6]] for column in (theta, parameters))
    # A search for the largest value finds the largest error as well, so another rule has the last word.
    albedo, _, error = albedos(probe, theta, parameters, effort.energy_quadrature, 1e-7, order=6)
    top = int(np.argmax(albedo - error))
    evidence = {
        "largest_albedo": float(albedo[top]),
        "theta_o_deg": math.degrees(theta[top]),
        "parameters": parameters[top],
        "curve": _curve(probe, parameters[top]),
    }
    again = replay(probe, view_directions(theta[top : top + 1], np.zeros(1))[0], parameters[top], wi=_NORMAL)
    if albedo[top] - error[top] > ENERGY_LIMIT:
        return failed(
            "energy",
            f"the model reflects {albedo[top]:.5g} of the light, at {evidence['theta_o_deg']:.4g} degrees",
            power,
            again,
            **evidence,
        )
    worst = int(np.argmax(off))
    if off[worst] > DECLARED:
        row = np.repeat(values, len(_VIEWS), axis=0)[worst]
        angle = float(np.tile(_VIEWS, len(values))[worst])
        return failed(
            "energy",
            f"directional_albedo is off the integral of f cos by {off[worst]:.3g} of it, at "
            f"{math.degrees(angle):.4g} degrees",
            power,
            replay(probe, view_directions(np.array([angle]), np.zeros(1))[0], row, wi=_NORMAL),
            declared_difference=float(off[worst]),
            **evidence,
        )
    return passed("energy", f"the largest albedo found is {albedo[top]:.6g}", power, **evidence)


def _nearby(
    probe: Probe, theta: Array, parameters: Array, surely: Array, effort: Effort, rng: np.random.Generator
) -> tuple[Array, Array, Array]:
    """The four best settings and views, and new ones around them, with the albedo that each surely reaches."""
    best = np.argsort(-surely)[:4]
    count = 4 * effort.energy_rows
    parent = best[rng.integers(0, len(best), count)]
    angle = np.clip(theta[parent] + rng.normal(0, 0.05, count) * (rng.random(count) < 0.7), 0.0, np.radians(89.95))
    values = parameters[parent].astype(np.float64)
    for i, p in enumerate(probe.declared.values()):
        fresh = np.array([inner_value(p, x) for x in rng.random(count)])
        near = np.clip(values[:, i] + rng.normal(0, 0.08, count) * (p.max - p.min), p.min, p.max)
        scaled = np.clip(values[:, i] * np.exp(rng.normal(0, 0.3, count)), p.min, p.max)
        pick = rng.random(count)
        values[:, i] = np.where(
            pick < 0.4, values[:, i], np.where(pick < 0.6, near, np.where(pick < 0.8, scaled, fresh))
        )
    rows = values.astype(np.float32)
    found, _, error = albedos(probe, angle, rows, effort.energy_quadrature // 4)
    theta, parameters = np.concatenate([theta[best], angle]), np.concatenate([parameters[best], rows])
    return theta, parameters, np.concatenate([surely[best], found - error])


def _curve(probe: Probe, parameters: Array) -> dict[str, Any]:
    degrees = np.array([0, 15, 30, 45, 60, 70, 75, 80, 83, 86, 88, 89, 89.5])
    rows = np.repeat(parameters[None], len(degrees), axis=0)
    albedo, _, _ = albedos(probe, np.radians(degrees), rows, 200_000)
    return {"theta_o_deg": degrees, "albedo": albedo}
