"""Where in a technique's square the directions lie that carry a model's light, by Newton's method from the pilot.

A lobe that the technique hits with a probability of 10^-9 is a spot of the square that no pilot finds; from the side of
the directions it is found easily.
"""

from __future__ import annotations

import numpy as np

from service.device_reference.drawn import Drawn, u_of
from service.device_reference.pilot import Points, shares
from service.device_reference.sky import Sky
from service.estimators.panels import Array, Integers
from service.probe import Probe
from service.sampling import Cells

BRIGHTEST = 64
"""Directions of each cell by their light, and as many again by what they add to the second moment."""

STEPS = 8
DIFFERENCE = 1e-6
LAST = 1.0 - 2.0**-53


def preimages(probe: Probe, cells: Cells, drawn: Drawn, sky: Sky) -> Points:
    """Points of the square about which the first panels have to be small."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        light = shares(sky.area * sky.reflected)
        noise = shares(np.where(sky.pdf > 0.0, sky.area * sky.reflected * (sky.reflected / sky.pdf), 0.0))
    chosen = np.concatenate([np.argsort(-of, axis=1)[:, :BRIGHTEST] for of in (light, noise)], axis=1)
    target = np.take_along_axis(sky.wi, chosen[..., None], axis=1)
    importance = 0.5 * np.take_along_axis(light + noise, chosen, axis=1)
    start = _nearest(drawn, target)
    part, square = drawn.part[start], drawn.square[start]
    for _ in range(STEPS):
        square = _step(probe, cells, drawn.splits, part, square, target)
    cell = np.repeat(np.arange(len(cells)), chosen.shape[1])
    return Points(cell, part.ravel(), square[..., 0].ravel(), square[..., 1].ravel(), importance.ravel())


def _nearest(drawn: Drawn, target: Array) -> Integers:
    sound = np.isfinite(drawn.wi).all(axis=-1) & (drawn.pdf > 0.0)
    out = []
    for wi, usable, wanted in zip(drawn.wi, sound, target, strict=True):
        out.append(np.argmax(wanted @ np.where(usable[:, None], wi, 0.0).T, axis=1))
    return np.array(out)


def _step(probe: Probe, cells: Cells, splits: Array, part: Integers, square: Array, target: Array) -> Array:
    """One step of Gauss and Newton, that keeps u1 within a factor of 4 and u2 within a tenth."""
    t, u2 = square[..., 0], square[..., 1]
    here = _directions(probe, cells, splits, part, square)
    small = DIFFERENCE * np.maximum(np.minimum(t, 1.0 - t), 1e-12)
    along_t = (_directions(probe, cells, splits, part, np.stack([t + small, u2], -1)) - here) / small[..., None]
    along_u2 = (_directions(probe, cells, splits, part, np.stack([t, u2 + DIFFERENCE], -1)) - here) / DIFFERENCE
    aa, ab, bb = ((x * y).sum(-1) for x, y in ((along_t, along_t), (along_t, along_u2), (along_u2, along_u2)))
    a, b = ((x * (target - here)).sum(-1) for x in (along_t, along_u2))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        determinant = aa * bb - ab * ab
        move_t, move_u2 = (a * bb - b * ab) / determinant, (b * aa - a * ab) / determinant
    known = np.isfinite(move_t) & np.isfinite(move_u2)
    moved = np.clip(t + np.where(known, move_t, 0.0), 0.25 * t, np.minimum(4.0 * t, 1.0 - 0.25 * (1.0 - t)))
    turned = np.mod(u2 + np.clip(np.where(known, move_u2, 0.0), -0.1, 0.1), 1.0)
    return np.stack([np.minimum(moved, LAST), turned], axis=-1)


def _directions(probe: Probe, cells: Cells, splits: Array, part: Integers, square: Array) -> Array:
    u = u_of(part, square, splits[:, None]).reshape(-1, 2)
    count = square.shape[1]
    wo, parameters = (np.repeat(a, count, axis=0) for a in (cells.wo, cells.parameters))
    return np.asarray(probe.draw(wo, u, parameters, "double").wi.reshape(*square.shape[:2], 3))
