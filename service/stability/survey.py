"""The edge grid evaluated in float32 and in float64, and the differences in units of the last place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.probe import Probe, Values
from service.stability.grid import EDGE_COSINES, EDGE_NUMBERS, EDGE_TURNS, STEP, edge_settings

Array = NDArray[Any]

MOST_POINTS = 400_000
FLOAT32_MAX = float(np.finfo(np.float32).max)
DIRECTION_ULP = STEP
"""Spacing of float32 just below 1, the unit for components of a unit vector."""

SMALLEST = 2.0**-100
"""Errors of values below it are counted in units of its last place: intermediate values of theirs are denormal."""

_COLUMNS = ("wo", "value", "parameters", "turn", "special", "inside")


@dataclass(frozen=True)
class Points:
    """Inputs of an edge grid: wo (n, 3), u (n, 2) or wi (n, 3), parameters (n, p), all float32, and what they are near.

    `turn` is the view's azimuth in turns; `special` names the direction wi ("" where it is drawn); `inside` says that
    every parameter is in its range.
    """

    wo: Array
    value: Array
    parameters: Array
    turn: Array
    special: Array
    inside: Array
    drawn: bool

    def __len__(self) -> int:
        return len(self.wo)

    def __getitem__(self, where: Any) -> Points:
        return replace(self, **{name: getattr(self, name)[where] for name in _COLUMNS})

    def evaluate(self, probe: Probe, precision: Any) -> Values:
        """Draw or evaluate them all."""
        run = probe.draw if self.drawn else probe.evaluate
        return run(self.wo, self.value, self.parameters, precision)


@dataclass(frozen=True)
class Comparison:
    """One quantity at every point: value (float32), truth (float64), the error in ulp, and points apart.

    nonfinite: not finite where the truth is. beyond: the truth exceeds the float32 maximum, or is infinite itself.
    """

    quantity: str
    value: Array
    truth: Array
    ulp: Array
    nonfinite: Array
    beyond: Array


def edge_points(
    probe: Probe, given: Mapping[str, list[float]], drawn: bool, turns_beside: Sequence[float] = ()
) -> Points:
    """The edge grid of a pair, and the same at azimuths beside its own, in turns.

    Parameters in `given` take those values, the others their edges and one step beyond.
    """
    rows, inside = _settings(probe, given)
    cosines, turns = np.array(EDGE_COSINES), np.array(list(dict.fromkeys((*EDGE_TURNS, *turns_beside))))
    numbers = np.array(EDGE_NUMBERS)
    seconds = len(numbers) ** 2 if drawn else len(_SPECIAL)
    shape = (len(cosines), len(turns), seconds, len(rows))
    total = int(np.prod(shape))
    # Every n-th point of a grid that is too large; n is made coprime to its last axis so that no value is left out.
    step = max(1, -(-total // MOST_POINTS))
    while step > 1 and np.gcd(step, len(rows)) > 1:
        step += 1
    i, k, j, row = np.unravel_index(np.arange(0, total, step), shape)
    wo = _view(cosines[i], turns[k])
    if drawn:
        value = np.stack([numbers[j // len(numbers)], numbers[j % len(numbers)]], axis=1).astype(np.float32)
        special = np.full(len(wo), "")
    else:
        names = np.array(list(_SPECIAL))
        value, special = _special_directions(wo, j), names[j]
    return Points(wo, value, rows[row], turns[k], special, inside[row], drawn)


def _settings(probe: Probe, given: Mapping[str, list[float]]) -> tuple[Array, Array]:
    declared = probe.declared
    rows = edge_settings(declared, limit=400, beyond=True)
    for name, values in given.items():
        if name in declared:
            column = list(declared).index(name)
            rows = np.concatenate([_with_column(rows, column, value) for value in values])
            rows = np.unique(rows, axis=0)
    low = np.array([p.min for p in declared.values()], np.float32)
    high = np.array([p.max for p in declared.values()], np.float32)
    return rows, np.asarray(((rows >= low) & (rows <= high)).all(axis=1))


def _with_column(rows: Array, column: int, value: float) -> Array:
    out = rows.copy()
    out[:, column] = value
    return out


def _view(cosine: Array, turn: Array) -> Array:
    """wo in float32, formed in double precision; quarter turns are exact."""
    sine = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    quarter = np.mod(4 * turn, 1) == 0
    x = np.where(quarter, np.round(np.cos(2 * np.pi * turn)), np.cos(2 * np.pi * turn))
    y = np.where(quarter, np.round(np.sin(2 * np.pi * turn)), np.sin(2 * np.pi * turn))
    return np.stack([sine * x, sine * y, cosine], axis=1).astype(np.float32)


_SPECIAL = (
    "normal",
    "horizon",
    "horizon behind",
    "just above the horizon",
    "mirror",
    "retro",
    "inside",
    "inside behind",
)


def _special_directions(wo: Array, which: Array) -> Array:
    w = wo.astype(np.float64)
    length = np.sqrt(w[:, 0] ** 2 + w[:, 1] ** 2)
    x = np.where(length > 0, w[:, 0] / np.where(length > 0, length, 1), 1.0)
    y = np.where(length > 0, w[:, 1] / np.where(length > 0, length, 1), 0.0)
    up, zero = np.ones(len(w)), np.zeros(len(w))
    s = np.sqrt(0.5)
    tiny = np.full(len(w), 1e-7)
    candidates = np.stack(
        [
            np.stack([zero, zero, up], 1),
            np.stack([x, y, zero], 1),
            np.stack([-x, -y, zero], 1),
            np.stack([-y, x, tiny], 1),
            np.stack([-w[:, 0], -w[:, 1], w[:, 2]], 1),
            w,
            np.stack([s * (0.8 * x - 0.6 * y), s * (0.8 * y + 0.6 * x), s * up], 1),
            np.stack([0.8 * (-0.6 * x - 0.8 * y), 0.8 * (-0.6 * y + 0.8 * x), 0.6 * up], 1),
        ]
    )
    return np.asarray(candidates[which, np.arange(len(w))], np.float32)


def compare(
    points: Points, single: Values, double: Values, given: tuple[str, ...], at_rounded: Values | None = None
) -> list[Comparison]:
    """The quantities of these points: of drawn ones direction, pdf and weight, else those in `given`.

    at_rounded: the true values at the float32 directions that were drawn. Density and BRDF are asked there: they may
    exceed the float32 maximum where those at the exact direction do not.
    """
    if points.drawn:
        pdf, brdf, weight = (_scalar(name, single, double) for name in ("pdf", "brdf", "weight"))
        if at_rounded is not None:
            pdf = _apart(pdf, np.isinf(single.pdf) & (np.abs(at_rounded.direction_pdf) > FLOAT32_MAX))
            brdf = _apart(brdf, np.isinf(single.brdf) & (np.abs(at_rounded.brdf) > FLOAT32_MAX))
        # A ratio of values that have no float32 has none either.
        weight = _apart(weight, pdf.beyond | brdf.beyond)
        return [_direction(single.wi, double.wi), pdf, weight]
    return [_scalar(name, single, double) for name in given]


def _apart(c: Comparison, beyond: Array) -> Comparison:
    """The comparison with these points, too, counted as beyond float32."""
    beyond = c.beyond | beyond
    return replace(c, beyond=beyond, nonfinite=c.nonfinite & ~beyond, ulp=np.where(beyond, 0.0, c.ulp))


def _scalar(name: str, single: Values, double: Values) -> Comparison:
    value, truth = getattr(single, name), getattr(double, name)
    with np.errstate(invalid="ignore", over="ignore"):
        beyond = (np.abs(truth) > FLOAT32_MAX) | np.isinf(truth)
        nonfinite = ~np.isfinite(value) & ~beyond
        ulp = np.abs(value.astype(np.float64) - truth) / last_place(truth)
    ulp = np.where(np.isfinite(value) & np.isfinite(truth) & ~beyond, ulp, 0.0)
    return Comparison(name, value, truth, ulp, nonfinite, beyond)


def last_place(truth: Array) -> Array:
    """Spacing of float32 at these values, float64."""
    size = np.clip(np.nan_to_num(np.abs(truth), posinf=FLOAT32_MAX), SMALLEST, 0.5 * FLOAT32_MAX)
    return np.asarray(np.spacing(size.astype(np.float32)).astype(np.float64))


def _direction(single: Array, double: Array) -> Comparison:
    finite: Array = np.asarray(np.isfinite(single).all(axis=1))
    both = finite & np.asarray(np.isfinite(double).all(axis=1))
    off = np.max(np.abs(np.where(both[:, None], single.astype(np.float64) - double, 0.0)), axis=1)
    return Comparison("direction", single, double, off / DIRECTION_ULP, ~finite, np.zeros(len(finite), bool))
