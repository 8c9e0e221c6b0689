"""The directional albedo, and what of it a density leaves out, by quadrature over directions in double precision.

The coordinates are those of shaders/hemisphere.glsl: s = 1 - t has s^2 = 1 - z, so that the horizon is t = 0, the
normal t = 1, and neither loses digits; the azimuth counts from wo in turns. They are a technique like any other, whose
mean weight is the albedo.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.catalogue import SHADERS, Entry, read_entry
from service.device_reference.pilot import COLUMNS, EVEN_ROWS, GRADED_AT_0, Points, piloted_panels, shares
from service.device_reference.weights import COARSE, DOUBTFUL, MOST_NODES, Drawn, two_resolutions, uncertainty
from service.estimators.cubature import Goal, Integrals, Values, integrate
from service.estimators.panels import NARROWEST_DOUBLE, POINTS, SIDE, Array, Integers, Panels
from service.estimators.quadrature import LEAST_VARIANCE, Evaluator
from service.probe import Probe
from service.sampling import Cells

SCATTERED = 64
"""Strata a side of the points all over the hemisphere, one at random in each."""

DRAWN = 2048
"""Directions of the technique that help to find lobes, for each cell."""

RINGS, SPOKES = 18, 12
"""Points about the mirror and the retro direction: rings of half the radius each, down to 2^-18."""


SEEN = 50
"""Directions of the pilot to expect where the model reflects, for a difference to be the technique's fault."""

LOBE = 0.9
"""Share of the reflected light that makes up a lobe."""


@dataclass(frozen=True)
class Albedo:
    """Directional albedo of each cell, the part of it where the density is zero, and what both may be off by."""

    albedo: Array
    error: Array
    uncovered: Array
    uncovered_error: Array
    trusted: NDArray[np.bool_]
    seen: NDArray[np.bool_]  # whether the technique's pilot must have drawn the directions that carry the reflection


def albedos(probe: Probe, cells: Cells, drawn: Drawn) -> Albedo:
    """Integrate f cos over the hemisphere of every cell; wo and parameters are float64."""
    wi = np.concatenate([_scattered(cells), _of_technique(drawn), _about_peaks(cells)], axis=1)
    area = _areas(drawn, wi.shape[1])
    cell = np.repeat(np.arange(len(cells)), wi.shape[1])
    reflected, pdf = (a.reshape(len(cells), -1) for a in _evaluate(probe, cells, cell, wi.reshape(-1, 3)))
    panels = piloted_panels(len(cells), (1,), _points(cells, cell, wi, area * reflected), GRADED_AT_0)
    coarse, fine = _integrate(probe, cells, panels)
    albedo = fine.shift + fine.powers[0]
    error = uncertainty(albedo, coarse.shift + coarse.powers[0], fine.mean_error)
    scattered = (2 * np.pi * reflected)[:, : SCATTERED**2]
    spread = scattered.std(axis=1) / SCATTERED
    missed = np.abs(scattered.mean(axis=1) - albedo) > DOUBTFUL * spread + 1e-9 * albedo
    lost, lost_error = np.zeros(len(cells)), np.zeros(len(cells))
    if np.any((reflected > 0.0) & ~(pdf > 0.0)):
        goal = Goal(COARSE, LEAST_VARIANCE, np.zeros(len(cells), bool), MOST_NODES, NARROWEST_DOUBLE)
        found = integrate(len(cells), False, goal, _Uncovered(probe, cells), panels)
        lost = found.shift + found.powers[0]
        lost_error = uncertainty(lost, lost, found.mean_error)
    seen = EVEN_ROWS * COLUMNS * _probability_of_lobe(area * reflected, area * pdf) >= SEEN
    return Albedo(albedo, error, lost, lost_error, ~missed & (fine.nonfinite == 0), seen)


@cache
def _hemisphere() -> Entry:
    return read_entry((SHADERS / "hemisphere.glsl").read_text(encoding="utf-8"), "hemisphere.glsl")


def _integrate(probe: Probe, cells: Cells, panels: Panels) -> tuple[Integrals, Integrals]:
    engine, technique = probe.engine, _hemisphere()
    pipeline = engine.pipeline(probe.model, technique, "quadrature", precision="double")
    columns = [probe.names.index(name) for name in engine.catalogue.parameters_of(probe.model, technique)]
    own = replace(cells, parameters=cells.parameters[:, columns])
    with Evaluator(engine.device, pipeline, own, "double") as evaluate:
        return two_resolutions(evaluate, panels, np.zeros(len(cells), bool))


@dataclass(frozen=True)
class _Uncovered:
    """4 pi (1 - t) f z at the nodes of panels, 0 where the technique has a density."""

    probe: Probe
    cells: Cells

    def __call__(self, panels: Panels) -> Values:
        grid = np.stack([np.repeat(POINTS, SIDE), np.tile(POINTS, SIDE)], axis=1)
        square = panels.corner[:, None, :2] + panels.corner[:, None, 2:] * grid
        t, cell = square[..., 0].ravel(), np.repeat(panels.cell, len(grid))
        wi = _directions(t, square[..., 1].ravel(), self.cells.wo[cell])
        reflected, pdf = _evaluate(self.probe, self.cells, cell, wi)
        value = np.where(pdf > 0.0, 0.0, 4.0 * np.pi * (1.0 - t) * reflected)
        return Values(value.reshape(len(panels), -1), np.zeros(len(self.cells)))


def _evaluate(probe: Probe, cells: Cells, cell: Integers, wi: Array) -> tuple[Array, Array]:
    """f cos and the density at directions (n, 3), each (n,); f is not asked below the horizon."""
    found = probe.evaluate(cells.wo[cell], wi, cells.parameters[cell], "double")
    return np.where(wi[:, 2] > 0.0, found.brdf * wi[:, 2], 0.0), found.direction_pdf


def _directions(t: Array, u2: Array, wo: NDArray[np.floating[Any]]) -> Array:
    s = 1.0 - t
    sine, turned = s * np.sqrt(2.0 - s * s), 2.0 * np.pi * u2 + np.arctan2(wo[:, 1], wo[:, 0])
    return np.stack([sine * np.cos(turned), sine * np.sin(turned), t * (2.0 - t)], axis=-1)


def _scattered(cells: Cells) -> Array:
    """Directions of equal area in every cell, (cells, n, 3)."""
    row, column = np.divmod(np.arange(SCATTERED**2), SCATTERED)
    square = (np.stack([row, column], axis=1) + np.random.default_rng(2).random((len(row), 2))) / SCATTERED
    t = 1.0 - np.sqrt(square[:, 0])
    return np.stack(
        [_directions(t, square[:, 1], np.broadcast_to(wo, (len(t), 3)).astype(np.float64)) for wo in cells.wo]
    )


def _of_technique(drawn: Drawn) -> Array:
    step = max(1, drawn.pdf.shape[1] // DRAWN)
    wi, pdf = drawn.wi[:, ::step], drawn.pdf[:, ::step]
    sound = np.isfinite(wi).all(axis=-1) & (pdf > 0.0) & (wi[..., 2] > 0.0)
    return np.where(sound[..., None], wi, np.array([0.0, 0.0, -1.0]))


def _rings() -> tuple[Array, Array, Array]:
    """Radius, angle and area of the points about a peak, (n,) each."""
    radius = np.repeat(0.5 ** np.arange(1, RINGS + 1), SPOKES)
    angle = np.tile(2 * np.pi * (np.arange(SPOKES) + 0.5) / SPOKES, RINGS)
    return radius, angle, radius**2 * np.log(2.0) * 2 * np.pi / SPOKES


def _about_peaks(cells: Cells) -> Array:
    """Directions about the mirror and the retro direction of every view, (cells, 2 n, 3); those below it stay there."""
    radius, angle, _ = _rings()
    out = []
    for wo in cells.wo:
        azimuth = np.arctan2(wo[1], wo[0])
        across = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        for peak in (wo * np.array([-1.0, -1.0, 1.0]), wo):
            along = np.cross(across, peak)
            wi = peak + radius[:, None] * (np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * along)
            out.append(wi / np.linalg.norm(wi, axis=1, keepdims=True))
    return np.array(out).reshape(len(cells), -1, 3)


def _areas(drawn: Drawn, count: int) -> Array:
    """Solid angle that each of the pilot's directions stands for, (cells, n)."""
    step = max(1, drawn.pdf.shape[1] // DRAWN)
    pdf, measure = drawn.pdf[:, ::step], drawn.measure[:, ::step]
    scattered = np.full((len(pdf), SCATTERED**2), 2 * np.pi / SCATTERED**2)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        of_technique = np.where(pdf > 0.0, step * measure / pdf, 0.0)
    rings = np.tile(_rings()[2], (len(pdf), 2))
    return np.concatenate([scattered, of_technique, rings], axis=1)[:, :count]


def _sets(values: Array) -> list[Array]:
    """Columns of the scattered points, of those of the technique, and of the rings."""
    clean = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    return np.split(clean, [SCATTERED**2, values.shape[1] - 2 * RINGS * SPOKES], axis=1)


def _probability_of_lobe(carried: Array, drawn: Array) -> Array:
    """Probability by the technique's density of the directions that carry most of the light, (cells,).

    By the set of points that has seen the most light.
    """
    sets = _sets(carried)
    most = np.argmax([part.sum(axis=1) for part in sets], axis=0)
    out = []
    for light, mass in zip(sets, _sets(drawn), strict=True):
        order = np.argsort(-light, axis=1)
        cumulative = np.cumsum(np.take_along_axis(shares(light), order, axis=1), axis=1)
        held = np.take_along_axis(mass, order, axis=1) * (cumulative <= LOBE)
        out.append(held.sum(axis=1))
    return np.asarray(np.stack(out)[most, np.arange(len(most))])


def _points(cells: Cells, cell: Integers, wi: Array, carried: Array) -> Points:
    importance = np.concatenate([shares(part) for part in _sets(carried)], axis=1)
    flat = wi.reshape(-1, 3)
    squared = flat[:, 0] ** 2 + flat[:, 1] ** 2
    t = 1.0 - np.sqrt(squared / (1.0 + np.maximum(flat[:, 2], 0.0)))
    turned = np.arctan2(flat[:, 1], flat[:, 0]) - np.arctan2(cells.wo[cell, 1], cells.wo[cell, 0])
    u2 = np.mod(turned / (2 * np.pi), 1.0)
    return Points(cell, np.ones(len(cell), np.int64), np.clip(t, 0.0, 1.0), u2, importance.ravel())
