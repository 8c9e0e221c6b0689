"""The directional albedo, and what of it a density leaves out, by quadrature over directions in double precision.

The coordinates are those of shaders/hemisphere.glsl: s = 1 - t has s^2 = 1 - z, so that the horizon is t = 0, the
normal t = 1, and neither loses digits; the azimuth counts from wo in turns. They are a technique like any other, whose
mean weight is the albedo.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.catalogue import hemisphere
from service.device_reference.pilot import COLUMNS, EVEN_ROWS, GRADED_AT_0, piloted_panels
from service.device_reference.sky import Sky, bright_points, directions, probability_of_lobe, reflected_and_density
from service.device_reference.weights import COARSE, DOUBTFUL, MOST_NODES, two_resolutions, uncertainty
from service.estimators.cubature import Goal, Integrals, Values, integrate
from service.estimators.panels import NARROWEST_DOUBLE, POINTS, SIDE, Array, Panels
from service.estimators.quadrature import LEAST_VARIANCE, Evaluator
from service.probe import Probe
from service.sampling import Cells

SEEN = 50
"""Directions of the pilot to expect where the model reflects, for a difference to be the technique's fault."""


@dataclass(frozen=True)
class Albedo:
    """Directional albedo of each cell, the part of it where the density is zero, and what both may be off by."""

    albedo: Array
    error: Array
    uncovered: Array
    uncovered_error: Array
    trusted: NDArray[np.bool_]
    seen: NDArray[np.bool_]  # whether the technique's pilot must have drawn the directions that carry the reflection


def albedos(probe: Probe, cells: Cells, sky: Sky) -> Albedo:
    """Integrate f cos over the hemisphere of every cell; wo and parameters are float64."""
    panels = piloted_panels(len(cells), (1,), bright_points(cells, sky), GRADED_AT_0)
    coarse, fine = _integrate(probe, cells, panels)
    albedo = fine.shift + fine.powers[0]
    error = uncertainty(albedo, coarse.shift + coarse.powers[0], fine.mean_error)
    scattered = 2 * np.pi * sky.scattered
    spread = scattered.std(axis=1) / math.sqrt(scattered.shape[1])
    missed = np.abs(scattered.mean(axis=1) - albedo) > DOUBTFUL * spread + 1e-9 * albedo
    lost, lost_error = np.zeros(len(cells)), np.zeros(len(cells))
    if np.any((sky.reflected > 0.0) & ~(sky.pdf > 0.0)):
        goal = Goal(COARSE, LEAST_VARIANCE, np.zeros(len(cells), bool), MOST_NODES, NARROWEST_DOUBLE)
        found = integrate(len(cells), False, goal, _Uncovered(probe, cells), panels)
        lost = found.shift + found.powers[0]
        lost_error = uncertainty(lost, lost, found.mean_error)
    seen = EVEN_ROWS * COLUMNS * probability_of_lobe(sky) >= SEEN
    return Albedo(albedo, error, lost, lost_error, ~missed & (fine.nonfinite == 0), seen)


def _integrate(probe: Probe, cells: Cells, panels: Panels) -> tuple[Integrals, Integrals]:
    engine, technique = probe.engine, hemisphere()
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
        wi = directions(t, square[..., 1].ravel(), self.cells.wo[cell])
        reflected, pdf = reflected_and_density(self.probe, self.cells, cell, wi)
        value = np.where(pdf > 0.0, 0.0, 4.0 * np.pi * (1.0 - t) * reflected)
        return Values(value.reshape(len(panels), -1), np.zeros(len(self.cells)))
