"""The pilot: a few thousand samples of each cell, spread over the whole square of the technique."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from service.device_reference.pilot import stratified
from service.estimators.panels import Array, Integers, first_panels
from service.estimators.quadrature import Evaluator
from service.probe import Probe
from service.sampling import Cells


@dataclass(frozen=True)
class Drawn:
    """The pilot: points of the square and what the technique makes of them, (cells, n); wi (cells, n, 3)."""

    part: Integers  # (n,)
    square: Array  # (n, 2)
    measure: Array  # of a point, (cells, n); a cell's sum is 1
    weight: Array  # not finite where the sample is bad
    pdf: Array
    wi: Array
    splits: Array  # of u1, (cells,)


def draw(probe: Probe, cells: Cells) -> Drawn:
    """Draw the pilot of every cell; wo and parameters are float64."""
    split = "u1_split" in probe.technique.declared
    parts, splits = (0, 1) if split else (1,), np.zeros(len(cells))
    if split:
        pipeline = probe.engine.pipeline(probe.model, probe.technique, "quadrature", precision="double")
        with Evaluator(probe.engine.device, pipeline, cells, "double") as evaluate:
            splits = evaluate(first_panels(len(cells), split)).splits
    square, area = stratified()
    part = np.repeat(parts, len(square))
    square, area = np.tile(square, (len(parts), 1)), np.tile(area, len(parts))
    u = u_of(part, square, splits[:, None])
    count = len(square)
    found = probe.draw(
        np.repeat(cells.wo, count, axis=0), u.reshape(-1, 2), np.repeat(cells.parameters, count, axis=0), "double"
    )
    measure = np.where(part == 1, 1.0 - splits[:, None], splits[:, None]) * area
    shape = (len(cells), count)
    weight, pdf, wi = found.weight.reshape(shape), found.pdf.reshape(shape), found.wi.reshape(*shape, 3)
    return Drawn(part, square, measure, weight, pdf, wi, splits)


def u_of(part: Integers, square: Array, splits: Array) -> Array:
    """(u1, u2) of points (..., 2) of the square, for splits that broadcast with their part."""
    u1 = np.where(part == 1, splits + (1.0 - splits) * square[..., 0], splits * square[..., 0])
    return np.stack(np.broadcast_arrays(u1, square[..., 1]), axis=-1)
