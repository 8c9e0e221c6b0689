"""Where a model reflects: its values at directions all over the hemisphere, of the technique, and about the peaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.device_reference.drawn import Drawn
from service.device_reference.pilot import Points, shares
from service.estimators.panels import Array, Integers
from service.probe import Probe
from service.sampling import Cells

SCATTERED = 64
"""Strata a side of the points all over the hemisphere, one at random in each."""

DRAWN = 2048
"""Directions of the technique that help to find lobes, for each cell."""

RINGS, SPOKES = 18, 32
"""Points about the mirror and the retro direction: rings of half the radius each, down to 2^-18."""

LOBE = 0.9
"""Share of the reflected light that makes up a lobe."""


@dataclass(frozen=True)
class Sky:
    """Directions (cells, n, 3), the solid angle that each stands for, f cos and the density there, (cells, n)."""

    wi: Array
    area: Array
    reflected: Array
    pdf: Array

    @property
    def scattered(self) -> Array:
        """f cos at directions that are spread evenly, one in each stratum."""
        return self.reflected[:, : SCATTERED**2]


def survey(probe: Probe, cells: Cells, drawn: Drawn) -> Sky:
    """Look at every cell; wo and parameters are float64."""
    wi = np.concatenate([_scattered(cells), _of_technique(drawn), _about_peaks(cells)], axis=1)
    cell = np.repeat(np.arange(len(cells)), wi.shape[1])
    reflected, pdf = (a.reshape(len(cells), -1) for a in reflected_and_density(probe, cells, cell, wi.reshape(-1, 3)))
    return Sky(wi, _areas(drawn), reflected, pdf)


def reflected_and_density(probe: Probe, cells: Cells, cell: Integers, wi: Array) -> tuple[Array, Array]:
    """f cos and the density at directions (n, 3), each (n,); f is not asked below the horizon."""
    found = probe.evaluate(cells.wo[cell], wi, cells.parameters[cell], "double")
    return np.where(wi[:, 2] > 0.0, found.brdf * wi[:, 2], 0.0), found.direction_pdf


def directions(t: Array, u2: Array, wo: NDArray[np.floating[Any]]) -> Array:
    """Directions of the coordinates of shaders/hemisphere.glsl, for one view wo each."""
    s = 1.0 - t
    sine, turned = s * np.sqrt(2.0 - s * s), 2.0 * np.pi * u2 + np.arctan2(wo[:, 1], wo[:, 0])
    return np.stack([sine * np.cos(turned), sine * np.sin(turned), t * (2.0 - t)], axis=-1)


def _scattered(cells: Cells) -> Array:
    """Directions of equal area in every cell, (cells, n, 3)."""
    row, column = np.divmod(np.arange(SCATTERED**2), SCATTERED)
    square = (np.stack([row, column], axis=1) + np.random.default_rng(2).random((len(row), 2))) / SCATTERED
    t = 1.0 - np.sqrt(square[:, 0])
    return np.stack(
        [directions(t, square[:, 1], np.broadcast_to(wo, (len(t), 3)).astype(np.float64)) for wo in cells.wo]
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


def _areas(drawn: Drawn) -> Array:
    """Solid angle that each of the pilot's directions stands for, (cells, n)."""
    step = max(1, drawn.pdf.shape[1] // DRAWN)
    pdf, measure = drawn.pdf[:, ::step], drawn.measure[:, ::step]
    scattered = np.full((len(pdf), SCATTERED**2), 2 * np.pi / SCATTERED**2)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        of_technique = np.where(pdf > 0.0, step * measure / pdf, 0.0)
    rings = np.tile(_rings()[2], (len(pdf), 2))
    return np.concatenate([scattered, of_technique, rings], axis=1)


def _sets(values: Array) -> list[Array]:
    """Columns of the scattered points, of those of the technique, and of the rings."""
    clean = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    return np.split(clean, [SCATTERED**2, values.shape[1] - 2 * RINGS * SPOKES], axis=1)


def probability_of_lobe(sky: Sky) -> Array:
    """Probability by the technique's density of the directions that carry most of the light, (cells,).

    By the set of points that has seen the most light.
    """
    sets = _sets(sky.area * sky.reflected)
    most = np.argmax([part.sum(axis=1) for part in sets], axis=0)
    out = []
    for light, mass in zip(sets, _sets(sky.area * sky.pdf), strict=True):
        order = np.argsort(-light, axis=1)
        cumulative = np.cumsum(np.take_along_axis(shares(light), order, axis=1), axis=1)
        held = np.take_along_axis(mass, order, axis=1) * (cumulative <= LOBE)
        out.append(held.sum(axis=1))
    return np.asarray(np.stack(out)[most, np.arange(len(most))])


def bright_points(cells: Cells, sky: Sky) -> Points:
    """The directions of a survey as points of the square of shaders/hemisphere.glsl, by the light they carry."""
    cell = np.repeat(np.arange(len(cells)), sky.wi.shape[1])
    importance = np.concatenate([shares(part) for part in _sets(sky.area * sky.reflected)], axis=1)
    flat = sky.wi.reshape(-1, 3)
    squared = flat[:, 0] ** 2 + flat[:, 1] ** 2
    t = 1.0 - np.sqrt(squared / (1.0 + np.maximum(flat[:, 2], 0.0)))
    turned = np.arctan2(flat[:, 1], flat[:, 0]) - np.arctan2(cells.wo[cell, 1], cells.wo[cell, 0])
    u2 = np.mod(turned / (2 * np.pi), 1.0)
    return Points(cell, np.ones(len(cell), np.int64), np.clip(t, 0.0, 1.0), u2, importance.ravel())
