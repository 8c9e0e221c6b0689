"""Checks of single values: finite, non-negative, on the sphere, above the horizon, one density from both functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.checks.outcome import Outcome, failed, passed
from service.inputs import random_settings, replay, view_directions
from service.probe import Probe, Values
from service.stability.grid import EDGE_COSINES, EDGE_NUMBERS, edge_settings

Array = NDArray[Any]

UNIT_LENGTH = 4e-6
"""Allowed difference of the length from 1: 32 float32 roundings."""

DISAGREEMENT = 1e-3
"""Relative difference of the two densities, both in double precision, that counts as a disagreement."""

FLOAT32_MAX = float(np.finfo(np.float32).max)


@dataclass(frozen=True)
class Points:
    """Inputs, one a row, and what came out in both precisions."""

    wo: Array
    u: Array
    parameters: Array
    single: Values
    double: Values
    edges: int  # the first so many rows are the edges of every range


def draw_points(probe: Probe, count: int, rng: np.random.Generator) -> Points:
    """Draw at the edges of every range, and at random settings, views (half of them towards grazing) and numbers."""
    wo, u, parameters = _edge_inputs(probe, min(count // 2, 40_000), rng)
    edges = len(wo)
    theta = np.arccos(np.where(rng.random(count) < 0.5, rng.random(count), 10.0 ** rng.uniform(-6, 0, count)))
    values = random_settings(probe.declared, 256, rng)[rng.integers(0, 256, count)]
    wo = np.concatenate([wo, view_directions(theta, rng.uniform(0, 2 * np.pi, count))])
    # u on the grid that renderers use, 24 bits.
    numbers = np.floor(rng.random((count, 2)) * 2.0**24) * 2.0**-24
    u = np.concatenate([u, numbers]).astype(np.float32)
    parameters = np.concatenate([parameters, values])
    single = probe.draw(wo, u, parameters)
    return Points(wo, u, parameters, single, probe.draw(wo, u, parameters, "double"), edges)


def _edge_inputs(probe: Probe, limit: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    rows = edge_settings(probe.declared, limit=48, beyond=False)
    cosines = np.array([m for m in EDGE_COSINES if m >= 0.0])
    turns = np.array([0.0, 0.25, 0.5, 0.61, 1.0 - 2.0**-24])
    u1, u2, i, k, row = (
        a.ravel()
        for a in np.meshgrid(
            EDGE_NUMBERS,
            EDGE_NUMBERS,
            np.arange(len(cosines)),
            np.arange(len(turns)),
            np.arange(len(rows)),
            indexing="ij",
        )
    )
    if len(u1) > limit:
        kept = rng.choice(len(u1), limit, replace=False)
        u1, u2, i, k, row = u1[kept], u2[kept], i[kept], k[kept], row[kept]
    wo = view_directions(np.arccos(cosines[i]), 2 * np.pi * turns[k])
    wo[:, 2] = cosines[i].astype(np.float32)
    return wo, np.stack([u1, u2], axis=1).astype(np.float32), rows[row]


def _worst(where: Array, size: Array) -> int:
    return int(np.argmax(np.where(where, np.nan_to_num(size, nan=np.inf, posinf=np.inf), -np.inf)))


def _replay(probe: Probe, points: Points, i: int) -> dict[str, Any]:
    return replay(probe, points.wo[i], points.parameters[i], u=points.u[i])


def check_finite(probe: Probe, points: Points) -> Outcome:
    """No direction, density, value or weight is NaN or infinite, but where the true value has no float32."""
    power = (
        f"{len(points.wo):,} inputs, {points.edges:,} of them where ranges end; bits are looked at before anything else"
    )
    a, b = points.single, points.double
    bad: Array = ~np.asarray(np.isfinite(a.wi).all(axis=1))
    beyond: Array = np.zeros(len(bad), np.bool_)
    without_float32: Array = np.zeros(len(bad), np.bool_)
    at_rounded = _truth_at_rounded(probe, points)
    for name in ("pdf", "direction_pdf", "brdf", "weight"):
        single, double = getattr(a, name), getattr(b, name)
        # An infinite or huge truth has no float32; a NaN in double precision is no truth.
        excused = np.isinf(single) & (np.abs(double) > FLOAT32_MAX)
        if name in at_rounded:
            excused = excused | (np.isinf(single) & (np.abs(at_rounded[name]) > FLOAT32_MAX))
        if name == "weight":  # a ratio of values that have no float32 has none either
            excused = excused | (without_float32 & ~np.isfinite(single) & ~np.isnan(double))
        without_float32 = without_float32 | excused
        bad = bad | (~np.isfinite(single) & ~excused)
        beyond = beyond | excused
    names = [
        name
        for name in ("wi", "pdf", "direction_pdf", "brdf", "weight")
        if not np.isfinite(getattr(a, name)[bad]).all()
    ]
    count = int(bad.sum())
    if not count:
        return passed("finite", f"{len(bad):,} inputs give finite values", power, beyond_float32=int(beyond.sum()))
    i = int(np.argmax(bad))
    return failed(
        "finite",
        f"{count:,} of {len(bad):,} inputs give {', '.join(names)} that is not finite",
        power,
        _replay(probe, points, i),
        count=count,
        values=names,
        beyond_float32=int(beyond.sum()),
    )


def _truth_at_rounded(probe: Probe, points: Points) -> dict[str, Array]:
    """BRDF and density in float64 at the directions as float32 has them, where one of them is infinite there, else 0.

    A direction at the horizon may be rounded to where the value is too large for float32.
    """
    single = points.single
    asked = np.isfinite(single.wi).all(axis=1) & (np.isinf(single.brdf) | np.isinf(single.direction_pdf))
    if not asked.any():
        return {}
    truth = probe.evaluate(points.wo[asked], single.wi[asked], points.parameters[asked], "double")
    found = {name: np.zeros(len(asked)) for name in ("brdf", "direction_pdf")}
    for name, values in found.items():
        values[asked] = getattr(truth, name)
    return found


def check_nonnegative(probe: Probe, points: Points) -> Outcome:
    """BRDF, densities and weights are not below zero, rounding aside: the same code in double precision says so too."""
    power = f"{len(points.wo):,} inputs; a value counts where double precision confirms it"
    found: dict[str, Array] = {}
    for name in ("pdf", "direction_pdf", "brdf", "weight"):
        single, double = getattr(points.single, name), getattr(points.double, name)
        with np.errstate(invalid="ignore"):
            negative = (single < 0) & (double < -1e-12 * np.nanmax(np.abs(double[np.isfinite(double)]), initial=1e-300))
        if negative.any():
            found[name] = np.where(negative, -single, 0.0)
    if not found:
        return passed("nonnegative", "no value is negative", power)
    name, size = max(found.items(), key=lambda item: float(item[1].max()))
    i = int(np.argmax(size))
    return failed(
        "nonnegative",
        f"{', '.join(found)} below zero: {name} down to {-size[i]:.3g}, at {int((size > 0).sum()):,} inputs",
        power,
        _replay(probe, points, i),
        lowest={key: float(-value.max()) for key, value in found.items()},
    )


def check_unit_length(probe: Probe, points: Points) -> Outcome:
    """Directions that count (density above zero) have length 1."""
    power = f"{len(points.wo):,} inputs; lengths off by more than {UNIT_LENGTH:g}"
    wi = points.single.wi.astype(np.float64)
    counts = (points.single.pdf > 0) & np.isfinite(wi).all(axis=1)
    off = np.where(counts, np.abs(np.sqrt(np.sum(np.where(counts[:, None], wi, 0) ** 2, axis=1)) - 1.0), 0.0)
    i = int(np.argmax(off))
    if off[i] <= UNIT_LENGTH:
        return passed("unit-length", f"lengths are 1 within {off[i]:.2g}", power, largest_difference=float(off[i]))
    return failed(
        "unit-length",
        f"a direction has length {1 + off[i]:.6g} or {1 - off[i]:.6g}; {int((off > UNIT_LENGTH).sum()):,} are off",
        power,
        _replay(probe, points, i),
        largest_difference=float(off[i]),
    )


def check_hemisphere(probe: Probe, points: Points) -> Outcome:
    """No direction with a density lies below the horizon, unless the head says that it is meant to."""
    power = f"{len(points.wo):,} inputs; any share of directions below the horizon above {3 / len(points.wo):.1g}"
    below = (points.single.wi[:, 2] < 0) & (points.single.pdf > 0)
    share = float(below.mean())
    if probe.technique.head.below_horizon:
        return passed(
            "hemisphere", f"{share:.3g} of the directions lie below the horizon, as declared", power, share=share
        )
    if not below.any():
        return passed("hemisphere", "no direction lies below the horizon", power, share=0.0)
    i = _worst(below, -points.single.wi[:, 2])
    return failed(
        "hemisphere",
        f"{share:.3g} of the directions lie below the horizon (z down to {points.single.wi[i, 2]:.3g}), and the head "
        "does not say below_horizon = true",
        power,
        _replay(probe, points, i),
        share=share,
    )


def check_pdf_agreement(probe: Probe, points: Points) -> Outcome:
    """The density that comes with a direction is what `direction_pdf` says of that direction."""
    inside = slice(points.edges, None)
    power = (
        f"{len(points.wo) - points.edges:,} random inputs in double precision; a difference above {DISAGREEMENT:g} in "
        "more than 1 of 2,000"
    )
    pdf, other = points.double.pdf[inside], points.double.direction_pdf[inside]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        off = np.abs(other - pdf) / np.maximum(np.abs(pdf), np.abs(other))
    comparable = np.isfinite(off) & ((pdf > 0) | (other > 0)) & (np.minimum(np.abs(pdf), np.abs(other)) >= 0)
    # A density of 0 that comes with a direction means that the sample does not count; the other one may not know that.
    comparable &= pdf > 0
    wrong = comparable & (off > DISAGREEMENT)
    share = float(wrong.sum() / max(1, comparable.sum()))
    largest = float(np.max(off[comparable], initial=0.0))
    if share <= 1 / 2000:
        typical = float(np.median(off[comparable])) if comparable.any() else 0.0
        return passed("pdf-agreement", f"the densities agree within {typical:.2g} (median)", power, share=share)
    i = points.edges + _worst(wrong, off)
    return failed(
        "pdf-agreement",
        f"direction_pdf differs from the density of the sample for {share:.3g} of the directions, by up to "
        f"{largest:.3g}",
        power,
        _replay(probe, points, i),
        share=share,
        sample_pdf=float(points.double.pdf[i]),
        direction_pdf=float(points.double.direction_pdf[i]),
    )
