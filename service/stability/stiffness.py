"""Condition numbers: how much a small change of an input changes a result, by differences in double precision."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.inputs import random_settings
from service.probe import Probe
from service.stability.survey import Points

Array = NDArray[Any]

STEP = 1e-6
ROUNDING = 2.0**-24
"""Half the spacing of float32, relative: the change that rounding an input makes."""


@dataclass(frozen=True)
class Condition:
    """The worst condition number of one quantity with respect to one input, its median, and where the worst is."""

    quantity: str
    input: str
    median: float
    worst: float
    inputs: dict[str, Any]


def condition_numbers(probe: Probe, count: int, seed: int = 0) -> list[Condition]:
    """|x df/dx / f| of brdf, densities and direction (there |x dwi/dx|), for x = mu, u1, u2 and every parameter.

    The worst and the median are over `count` random inputs, many of them towards grazing and small numbers.
    """
    rng = np.random.default_rng(seed)
    mu = np.where(rng.random(count) < 0.5, rng.uniform(0.001, 1, count), 10.0 ** rng.uniform(-6, 0, count))
    turn = rng.random(count)
    u = np.where(rng.random((count, 2)) < 0.7, rng.random((count, 2)), 10.0 ** rng.uniform(-7, 0, (count, 2)))
    rows = random_settings(probe.declared, 256, rng)[rng.integers(0, 256, count)].astype(np.float64)
    given = _directions(rng, count)
    middle = _evaluate(probe, mu, turn, u, rows, given)
    out = []
    for name, low, high, size in _changes(probe, mu, u, rows):
        a, b = (_evaluate(probe, change[0], turn, change[1], change[2], given) for change in (low, high))
        for quantity in ("brdf", "direction_pdf", "pdf", "direction"):
            if name in ("u1", "u2") and quantity in ("brdf", "direction_pdf"):
                continue
            kappa = _ratio(quantity, middle[quantity], a[quantity], b[quantity], size)
            out.append(_condition(quantity, name, kappa, mu, turn, u, rows, probe))
    return out


def _directions(rng: np.random.Generator, count: int) -> Array:
    z = np.where(rng.random(count) < 0.7, rng.uniform(0.001, 1, count), 10.0 ** rng.uniform(-5, 0, count))
    phi = rng.uniform(0, 2 * np.pi, count)
    sine = np.sqrt((1 - z) * (1 + z))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=1)


def _changes(probe: Probe, mu: Array, u: Array, rows: Array) -> Iterator[tuple[str, Any, Any, Array]]:
    """Each input with its two changed versions (mu, u, rows) and the relative distance between them."""
    down, up = 1 - STEP, 1 + STEP
    both = np.full(len(mu), 2 * STEP)
    yield "mu", (mu * down, u, rows), (np.minimum(mu * up, 1.0), u, rows), (np.minimum(mu * up, 1.0) - mu * down) / mu
    for i in range(2):
        low, high = u.copy(), u.copy()
        low[:, i] *= down
        high[:, i] = np.minimum(high[:, i] * up, 1 - 2.0**-53)
        yield f"u{i + 1}", (mu, low, rows), (mu, high, rows), both
    for i, (name, p) in enumerate(probe.declared.items()):
        low, high = rows.copy(), rows.copy()
        low[:, i] = np.maximum(low[:, i] * down, p.min) if p.min >= 0 else low[:, i] * down
        high[:, i] = np.minimum(high[:, i] * up, p.max) if p.min >= 0 else high[:, i] * up
        with np.errstate(divide="ignore", invalid="ignore"):
            size = np.abs((high[:, i] - low[:, i]) / rows[:, i])
        yield name, (mu, u, low), (mu, u, high), np.where(rows[:, i] == 0, np.inf, size)


def _evaluate(probe: Probe, mu: Array, turn: Array, u: Array, rows: Array, given: Array) -> dict[str, Array]:
    sine = np.sqrt((1 - mu) * (1 + mu))
    wo = np.stack([sine * np.cos(2 * np.pi * turn), sine * np.sin(2 * np.pi * turn), mu], axis=1)
    drawn, values = probe.draw(wo, u, rows, "double"), probe.evaluate(wo, given, rows, "double")
    return {"brdf": values.brdf, "direction_pdf": values.direction_pdf, "pdf": drawn.pdf, "direction": drawn.wi}


def _ratio(quantity: str, middle: Array, low: Array, high: Array, size: Array) -> Array:
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        if quantity == "direction":
            return np.asarray(np.sqrt(np.sum((high - low) ** 2, axis=1)) / size)
        return np.asarray(np.abs(high - low) / np.abs(middle) / size)


def _condition(
    quantity: str, name: str, kappa: Array, mu: Array, turn: Array, u: Array, rows: Array, probe: Probe
) -> Condition:
    kappa = np.where(np.isfinite(kappa), kappa, 0.0)
    i = int(np.argmax(kappa))
    inputs = {
        "theta_o_deg": math.degrees(math.acos(float(mu[i]))),
        "phi_o_deg": 360 * float(turn[i]),
        "u": u[i].tolist(),
        "parameters": dict(zip(probe.names, rows[i].tolist(), strict=True)),
    }
    return Condition(quantity, name, float(np.median(kappa)), float(kappa[i]), inputs)


def rounding_effect(probe: Probe, points: Points) -> dict[str, Array]:
    """By how much the true values change when every input changes by one rounding, summed over inputs, (n,) each.

    What is left after rounding of correct inputs cannot be blamed on the code. Keys are those of the comparison.
    """
    base = points.evaluate(probe, "double")
    total: dict[str, Array] = {}
    columns = [("wo", k) for k in range(3)] + [("value", k) for k in range(points.value.shape[1])]
    columns += [("parameters", k) for k in range(points.parameters.shape[1])]
    for field, k in columns:
        changed = {name: getattr(points, name).astype(np.float64) for name in ("wo", "value", "parameters")}
        changed[field][:, k] *= 1 + (ROUNDING if field != "value" or not points.drawn else -ROUNDING)
        run = probe.draw if points.drawn else probe.evaluate
        moved = run(changed["wo"], changed["value"], changed["parameters"], "double")
        for name in ("pdf", "weight", "brdf", "direction_pdf", "albedo"):
            change = np.abs(getattr(moved, name) - getattr(base, name))
            total[name] = total.get(name, 0.0) + np.where(np.isfinite(change), change, 0.0)
        change = np.max(np.abs(moved.wi - base.wi), axis=1)
        total["direction"] = total.get("direction", 0.0) + np.where(np.isfinite(change), change, 0.0)
    return total


def direction_rounding_effect(probe: Probe, points: Points) -> dict[str, Array]:
    """By how much true density and weight change when a component of the direction drawn moves by 2^-24, summed, (n,).

    A direction is handed on in float32. A narrow lobe, or one seen from grazing, changes within the spacing of its
    components: no code that takes a rounded direction can know the density where the exact one lies.
    """
    wi = points.evaluate(probe, "double").wi
    base = probe.evaluate(points.wo, wi, points.parameters, "double")
    total = {name: np.zeros(len(points)) for name in ("pdf", "weight")}
    for k in range(3):
        moved_wi = wi.copy()
        moved_wi[:, k] += ROUNDING
        moved = probe.evaluate(points.wo, moved_wi, points.parameters, "double")
        for name, of_given in (("pdf", "direction_pdf"), ("weight", "weight")):
            change = np.abs(getattr(moved, of_given) - getattr(base, of_given))
            total[name] += np.where(np.isfinite(change), change, 0.0)
    return total
