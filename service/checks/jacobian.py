"""The density against the Jacobian of (u1, u2) -> direction, by differences in double precision."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.checks.outcome import Outcome, failed, not_applicable, passed
from service.inputs import random_settings, replay, view_directions
from service.probe import Probe

Array = NDArray[Any]

STEP = 1e-6
TOLERANCE = 1e-3
"""Relative difference of p |d wi/du| from 1; differences are good to about 1e-8 of it."""

SHARE = 5e-3
"""Share of points that may be off: those whose differences straddle a crease of the mapping."""


ROUGH = 1e-2
"""Relative difference of the areas at STEP and at half of it, above which the mapping has no derivative there."""


def check_jacobian(probe: Probe, points: int, rng: np.random.Generator) -> Outcome:
    """The density is one over the area that a small square of (u1, u2) covers, summed over all preimages.

    Where code makes further random numbers out of (u1, u2), as rejection sampling does, there is no such area. The
    preimages there cannot be summed, and all that can be found is less density than one smooth preimage gives.
    """
    if probe.technique.head.mixture:
        return not_applicable("jacobian", "one direction comes from several branches (mixture = true)")
    count = min(points, 1 << 14)
    theta = np.arccos(rng.uniform(0.02, 1, count))
    wo = view_directions(theta, rng.uniform(0, 2 * np.pi, count))
    parameters = random_settings(probe.declared, 128, rng)[rng.integers(0, 128, count)]
    u = rng.uniform(0.001, 0.999, (count, 2))
    pdf, area, wi = densities_and_areas(probe, wo, u, parameters)
    counts = (pdf > 0) & (area > 0) & np.isfinite(pdf * area)
    rough = counts & ~(np.abs(densities_and_areas(probe, wo, u, parameters, STEP / 2)[1] - area) <= ROUGH * area)
    has_rough = rough.sum() > SHARE * count
    off = np.where(counts & ~(rough & has_rough), np.abs(pdf * area - 1.0), 0.0)
    wrong = np.flatnonzero((off > TOLERANCE) & ~(has_rough & (pdf * area > 1.0)))
    if has_rough and len(wrong) <= SHARE * count:
        return not_applicable(
            "jacobian", f"directions are no smooth function of (u1, u2) at {rough.sum() / count:.0%} of the inputs"
        )
    if len(wrong) > SHARE * count:
        # More density than one preimage gives: look for the others before calling it wrong.
        excess = wrong[pdf[wrong] * area[wrong] > 1 + TOLERANCE][:32]
        if len(excess) and len(excess) == min(32, len(wrong)):
            sums = np.array([_density_of_preimages(probe, wo[i], wi[i], parameters[i]) for i in excess])
            if np.mean(np.abs(sums / pdf[excess] - 1.0) < 0.01) > 0.9:
                wrong = wrong[:0]
    power = (
        f"{count:,} random inputs in double precision; a difference above {TOLERANCE:g} in more than "
        f"{SHARE:.1%} of them"
    )
    share = len(wrong) / count
    if share <= SHARE:
        typical = float(np.median(off[counts])) if counts.any() else 0.0
        return passed(
            "jacobian", f"the density is the inverse of the Jacobian within {typical:.1g} (median)", power, share=share
        )
    i = int(wrong[np.argsort(off[wrong])[len(wrong) // 2]])
    return failed(
        "jacobian",
        f"the density times the Jacobian is {pdf[i] * area[i]:.5g} instead of 1 (median of the "
        f"{share:.1%} that are off)",
        power,
        replay(probe, wo[i], parameters[i], u=u[i]),
        share=share,
        pdf=float(pdf[i]),
        one_over_jacobian=float(1 / area[i]),
    )


def densities_and_areas(
    probe: Probe, wo: Array, u: Array, parameters: Array, step: float = STEP
) -> tuple[Array, Array, Array]:
    """Density (n,), |d wi/du1 x d wi/du2| (n,) by central differences, and wi (n, 3)."""
    shifts = np.array([[step, 0], [-step, 0], [0, step], [0, -step]])
    middle = probe.draw(wo, u, parameters, "double")
    a, b, c, d = (probe.draw(wo, u + shift, parameters, "double").wi for shift in shifts)
    cross = np.cross(a - b, c - d) / (4 * step * step)
    return middle.pdf, np.sqrt(np.sum(cross * cross, axis=1)), middle.wi


def _density_of_preimages(probe: Probe, wo: Array, wi: Array, parameters: Array) -> float:
    """Sum of one over the Jacobian at all (u1, u2) that give wi: starts on a grid, polished by Newton's method."""
    side = 48
    grid = (np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2) + 0.5) / side
    found = probe.draw(wo, grid, parameters, "double").wi
    distance = np.sum((found - wi) ** 2, axis=1).reshape(side, side)
    padded = np.pad(distance, 1, constant_values=np.inf)
    around = [padded[1 + i : 1 + i + side, 1 + j : 1 + j + side] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    u = grid[(distance <= np.min(around, axis=0)).ravel()]
    for _ in range(12):
        w = probe.draw(wo, u, parameters, "double").wi
        du = np.stack([_slope(probe, wo, u, parameters, axis) for axis in (0, 1)], axis=-1)
        known = np.isfinite(du).all(axis=(1, 2)) & np.isfinite(w).all(axis=1)
        u, du, w = u[known], du[known], w[known]
        if not len(u):
            return 0.0
        step = (np.linalg.pinv(du) @ (wi - w)[..., None])[..., 0]
        u = np.clip(u + np.clip(step, -0.02, 0.02), 1e-9, 1 - 1e-9)
    w = probe.draw(wo, u, parameters, "double").wi
    u = u[np.sum((w - wi) ** 2, axis=1) < 1e-16]
    distinct: list[Array] = []
    for one in u:
        if all(np.max(np.abs(one - other)) > 1e-5 for other in distinct):
            distinct.append(one)
    if not distinct:
        return 0.0
    _, area, _ = densities_and_areas(probe, wo, np.array(distinct), parameters)
    return float(np.sum(1.0 / area))


def _slope(probe: Probe, wo: Array, u: Array, parameters: Array, axis: int) -> Array:
    shift = np.zeros(2)
    shift[axis] = STEP
    high, low = (probe.draw(wo, u + sign * shift, parameters, "double").wi for sign in (1, -1))
    return np.asarray((high - low) / (2 * STEP))
