"""Continuity of BRDF and density across seams of the azimuth and at ends of parameter ranges, in double precision."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.checks.outcome import Outcome, failed, passed
from service.inputs import random_settings, replay
from service.probe import Probe

Array = NDArray[Any]

JUMP = 1e-3
"""A jump counts above this share of the value, where it does not shrink with the distance."""

FAINT = 1e-9
"""Values below it (1/sr) carry no light; they are compared absolutely."""

SHARE = 5e-3
_SEAMS = (0.0, 0.25, 0.5, 0.75)
_FAR, _NEAR = 1e-7, 1e-10


def check_continuity(probe: Probe, points: int, rng: np.random.Generator) -> Outcome:
    """No jump where the view's azimuth passes a quarter turn, nor where one parameter reaches an end of its range."""
    count = min(points, 1 << 12)
    seams = [(f"azimuth {360 * turn:g} degrees", *_across_seam(probe, turn, count, rng)) for turn in _SEAMS]
    ends = [
        (f"{name} = {getattr(p, end):g}", *_at_end(probe, i, end, count, rng))
        for i, (name, p) in enumerate(probe.declared.items())
        for end in ("min", "max")
        if p.max > p.min
    ]
    found = seams + ends
    power = (
        f"{count:,} random inputs at {len(_SEAMS)} azimuths and {len(ends)} ends of ranges; "
        f"a jump above {JUMP:g} of the value in more than {SHARE:.1%}"
    )
    worst = max(found, key=lambda item: float((item[1] > JUMP).mean()))
    share = float((worst[1] > JUMP).mean())
    jumps = {name: float((jump > JUMP).mean()) for name, jump, *_ in found}
    if share <= SHARE:
        return passed("continuity", f"no jump at {len(found)} places", power, share_of_jumps=jumps)
    place, jump, wo, wi, parameters = worst
    i = int(np.argmax(jump))
    return failed(
        "continuity",
        f"a jump of up to {jump[i]:.3g} of the value at {place}, for {share:.1%} of the directions",
        power,
        replay(probe, wo[i], parameters[i], wi=wi[i]),
        share_of_jumps=jumps,
    )


def _random_directions(rng: np.random.Generator, count: int) -> Array:
    return _directions(rng.uniform(0.02, 0.98, count), rng.uniform(0, 2 * np.pi, count))


def _directions(z: Array, phi: Array) -> Array:
    sine = np.sqrt(1 - z * z)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=1)


def _jump(before: Array, after: Array) -> Array:
    """Relative difference; a NaN on one side only is a jump."""
    scale = np.maximum(np.abs(before), np.abs(after))
    with np.errstate(invalid="ignore"):
        relative = np.abs(before - after) / np.maximum(scale, FAINT)
    return np.where(np.isnan(before) != np.isnan(after), 1.0, np.nan_to_num(relative, nan=0.0, posinf=1.0))


def _across_seam(probe: Probe, turn: float, count: int, rng: np.random.Generator) -> tuple[Array, Array, Array, Array]:
    """Jump between the two sides of a seam; one that shrinks with the distance is a slope, and counts as none."""
    z, wi = rng.uniform(0.02, 0.98, count), _random_directions(rng, count)
    parameters = random_settings(probe.declared, 64, rng)[rng.integers(0, 64, count)]
    sizes = []
    for distance in (_FAR, _NEAR):
        sides = [
            probe.evaluate(_directions(z, np.full(count, 2 * np.pi * turn + sign * distance)), wi, parameters, "double")
            for sign in (-1, 1)
        ]
        sizes.append([_jump(getattr(sides[0], name), getattr(sides[1], name)) for name in ("brdf", "direction_pdf")])
    stays = [np.where(near > 0.5 * far, near, 0.0) for far, near in zip(*sizes, strict=True)]
    return np.maximum(*stays), _directions(z, np.full(count, 2 * np.pi * turn)), wi, parameters


def _at_end(
    probe: Probe, column: int, end: str, count: int, rng: np.random.Generator
) -> tuple[Array, Array, Array, Array]:
    """Jump between a parameter's end and its limit: as close as double precision goes, 1e-290 next to 0.

    The others are inside their ranges. Where two reach an end together a limit need not exist: the shares of two lobes
    whose reflectances are both 0 are what the file says they are.
    """
    p = list(probe.declared.values())[column]
    wo, wi = _random_directions(rng, count), _random_directions(rng, count)
    parameters = random_settings(probe.declared, 64, rng, at_ends=0.0)[rng.integers(0, 64, count)].astype(np.float64)
    value = getattr(p, end)
    inward = 1.0 if end == "min" else -1.0
    near = inward * 1e-290 if value == 0.0 else value + inward * 1e-13 * max(abs(value), p.max - p.min)
    at, beside = parameters.copy(), parameters.copy()
    at[:, column], beside[:, column] = value, near
    here, there = (probe.evaluate(wo, wi, rows, "double") for rows in (at, beside))
    jump = np.maximum(_jump(here.brdf, there.brdf), _jump(here.direction_pdf, there.direction_pdf))
    return jump, wo, wi, at
