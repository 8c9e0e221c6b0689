"""Regions of the edge grid by name, and the exceptions in them: points further off than 8 ulp, with the reason."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.inputs import bits
from service.plain_data import plain_data
from service.probe import Probe
from service.stability.grid import EDGE_TURNS, NEXT_TO_SEAMS
from service.stability.survey import DIRECTION_ULP, SMALLEST, Comparison, Points, last_place

Array = NDArray[Any]

ULP_LIMIT = 8.0
WRONG = "unstable: far from the true value, and no rounding of inputs explains it"
LOST = 1e-3
"""A relative error above this, which the rounding of inputs does not explain, is a failure and no mere exception."""


@dataclass(frozen=True)
class Exceptional:
    """Points of one quantity beyond the limit that share a reason.

    At the worst of them `effect` is the change of the truth by rounded inputs and `direction_effect` that by a rounded
    direction, in ulp; None where no direction is drawn, or the quantity does not depend on it.
    """

    quantity: str
    reason: str
    points: int
    worst: int
    ulp: float
    effect: float
    direction_effect: float | None
    relative: float


def region_masks(probe: Probe, points: Points) -> Iterator[tuple[str, Array]]:
    """Names of regions and which points lie in them; a point lies in several."""
    inside = points.inside
    mu = points.wo[:, 2]
    yield "view along the normal", inside & (mu >= 0.9999999)
    yield "oblique view", inside & (mu >= 1e-2) & (mu < 0.9999999)
    yield "grazing view", inside & (mu > 0) & (mu < 1e-2)
    yield "view at the horizon", inside & (mu == 0)
    yield "azimuth at quarter turns", inside & np.isin(points.turn, (0.25, 0.5, 0.75, 0.0))
    yield "azimuth next to seams", inside & np.isin(points.turn, NEXT_TO_SEAMS)
    yield "azimuth of the scene", inside & ~np.isin(points.turn, EDGE_TURNS)
    if points.drawn:
        u = points.value
        yield "u1 at its ends", inside & ((u[:, 0] < 1e-6) | (u[:, 0] > 0.999999))
        yield "u2 at its ends", inside & ((u[:, 1] < 1e-6) | (u[:, 1] > 0.999999))
    else:
        for name in dict.fromkeys(points.special.tolist()):
            yield f"wi: {name}", inside & (points.special == name)
    for i, (name, p) in enumerate(probe.declared.items()):
        span = p.max - p.min
        if span > 0:
            value = points.parameters[:, i].astype(np.float64)
            yield f"{name} at {p.min:g}", inside & (value == np.float32(p.min))
            yield f"{name} next to {p.min:g}", inside & (value > np.float32(p.min)) & (value < p.min + 2e-3 * span)
            yield f"{name} towards {p.max:g}", inside & (value > p.max - 2e-3 * span)
    yield "parameters one step beyond their range", ~inside


def describe_regions(probe: Probe, points: Points, comparisons: list[Comparison]) -> list[dict[str, Any]]:
    """A region of the result for each mask: counts, the worst error, and the input where it is."""
    out = []
    what = "drawn" if points.drawn else "given"
    for name, mask in region_masks(probe, points):
        if not mask.any():
            continue
        worst = max(comparisons, key=lambda c: float(np.max(c.ulp, where=mask, initial=0.0)))
        i = int(np.argmax(np.where(mask, worst.ulp, -1.0)))
        out.append(
            {
                "name": name,
                "technique": probe.technique.name,
                "wi": what,
                "points": int(mask.sum()),
                "nonfinite": int(np.any([c.nonfinite & mask for c in comparisons], axis=0).sum()),
                "beyond_float32": int(np.any([c.beyond & mask for c in comparisons], axis=0).sum()),
                "above_limit": int(np.any([(c.ulp > ULP_LIMIT) & mask for c in comparisons], axis=0).sum()),
                "worst_ulp": float(worst.ulp[i]),
                "worst": place(probe, points, worst, i),
            }
        )
    return out


def place(probe: Probe, points: Points, comparison: Comparison, i: int) -> dict[str, Any]:
    """The input, the value and the truth of one point."""
    wo = points.wo[i]
    inputs: dict[str, Any] = {
        "theta_o_deg": math.degrees(math.acos(min(1.0, float(wo[2])))),
        "phi_o_deg": 360 * float(points.turn[i]),
        "wo_bits": bits(wo),
        "parameters": dict(zip(probe.names, points.parameters[i].tolist(), strict=True)),
        "model": probe.model.name,
        "technique": probe.technique.name,
    }
    inputs["u_bits" if points.drawn else "wi_bits"] = bits(points.value[i])
    return {
        "quantity": comparison.quantity,
        "inputs": inputs,
        "value": plain_data(comparison.value[i]),
        "expected": plain_data(comparison.truth[i]),
    }


def _in_places(effect: Array, unit: Array) -> Array:
    """A change of the true value in units of its last place, which may be beyond what float64 holds: then 1e300."""
    with np.errstate(over="ignore"):
        return np.minimum(effect / unit, 1e300)


def exceptions(
    points: Points, comparison: Comparison, effect: Array, at_horizon: Array, of_direction: Array | None = None
) -> list[Exceptional]:
    """Points beyond the limit inside all ranges, by reason: stiff inputs, horizon, stiff direction, digits lost, wrong.

    effect: the change of the true value by one rounding of each input, (n,). at_horizon: whether the true direction
    that is drawn lies within a few roundings of the horizon, (n,). of_direction: the change of the true value by one
    rounding of each component of the direction that is drawn, (n,).
    """
    if comparison.quantity == "direction":
        unit, size = np.full(len(points), DIRECTION_ULP), np.ones(len(points))
    else:
        unit, size = last_place(comparison.truth), np.maximum(np.abs(comparison.truth), SMALLEST)
    allowed = _in_places(effect, unit)
    over = points.inside & (comparison.ulp > ULP_LIMIT)
    relative = comparison.ulp * unit / size
    stiff = over & (comparison.ulp <= ULP_LIMIT * (1.0 + allowed))
    border = over & ~stiff & at_horizon
    by_direction = None if of_direction is None else _in_places(of_direction, unit)
    blurred = (
        over
        & ~stiff
        & ~border
        & (comparison.ulp <= ULP_LIMIT * (1.0 + (0.0 if by_direction is None else by_direction)))
    )
    lost = over & ~stiff & ~border & ~blurred & (relative <= LOST)
    reasons = (
        ("stiff: rounding the inputs changes the true value by as much", stiff),
        ("the direction drawn lies at the horizon, where rounding decides whether it counts", border),
        ("stiff in the direction drawn: rounding it to float32 changes the true value by as much", blurred),
        ("digits lost in rounding of intermediate values", lost),
        (WRONG, over & ~stiff & ~border & ~blurred & ~lost),
    )
    out = []
    for reason, mask in reasons:
        if mask.any():
            i = int(np.argmax(np.where(mask, comparison.ulp, -1.0)))
            out.append(
                Exceptional(
                    quantity=comparison.quantity,
                    reason=reason,
                    points=int(mask.sum()),
                    worst=i,
                    ulp=float(comparison.ulp[i]),
                    effect=float(allowed[i]),
                    direction_effect=None if by_direction is None else float(by_direction[i]),
                    relative=float(relative[i]),
                )
            )
    return out
