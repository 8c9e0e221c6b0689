"""The estimator `quadrature`: adaptive cubature of the technique's (u1, u2) square, weights evaluated on the device."""

from __future__ import annotations

import struct
import time
from collections.abc import Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lavapipe import Buffer, Device, Pipeline
from service.engine import Engine
from service.estimators.cubature import Goal, Integrals, Values, integrate
from service.estimators.estimate import Estimate
from service.estimators.panels import NODES, POINTS, SIDE, Array, Panels
from service.moments import Statistics, central_moments
from service.sampling import CELL, TIMEOUT_S, Cells, IncompleteRun
from service.scene import Estimator, SeriesPlan
from service.structure import Structure
from service.variant import Precision

DEFAULT_TOLERANCE = 1e-4
LEAST_VARIANCE = 1e-9
"""A variance below this is to be right absolutely, not relatively."""
MOST_NODES = 1 << 17
"""Nodes for one cell, at the most, unless `samples` allows more."""
Bools = NDArray[np.bool_]
_PANELS_PER_GROUP = 8  # the same constant stands in shaders/quadrature.comp
_CHUNK = 16384  # panels in a dispatch: a million nodes
_ALL = Structure()


@dataclass(frozen=True)
class _Layout:
    """How the shader's buffers look in a precision.

    A panel is the cell's number and its part, then the corner.
    """

    real: np.dtype[Any]
    panel: np.dtype[Any]
    cell: np.dtype[Any]


_LAYOUTS: Mapping[Precision, _Layout] = {
    "float": _Layout(np.dtype("<f4"), np.dtype([("cell", "<u4", 4), ("corner", "<f4", 4)]), CELL),
    "double": _Layout(
        np.dtype("<f8"),
        np.dtype({"names": ["cell", "corner"], "formats": ["4<u4", "4<f8"], "offsets": [0, 32], "itemsize": 64}),
        np.dtype({"names": ["wo"], "formats": ["3<f8"], "itemsize": 64}),
    ),
}


def quadrature(
    plan: SeriesPlan,
    engine: Engine,
    cells: Cells,
    estimator: Estimator,
    finite_variance: Bools,
    with_variance: bool,
    structure: Structure = _ALL,
) -> Estimate:
    """Mean and variance to the tolerance of the estimator, as estimated by the rule itself.

    finite_variance: which cells have a variance, shape (cells,), True where nothing is known. with_variance: whether
    the variance is asked for at all; if not, only the mean has to reach the tolerance.
    """
    begin = time.perf_counter()
    constants = structure.shared_constants(plan.model, [plan.technique])
    pipeline = engine.pipeline(plan.model, plan.technique, "quadrature", constants)
    tolerance = estimator.tolerance or DEFAULT_TOLERANCE
    goal = Goal(tolerance, LEAST_VARIANCE, finite_variance & with_variance, max(MOST_NODES, estimator.samples // 8))
    with Evaluator(engine.device, pipeline, cells) as evaluate:
        built_ms = 1e3 * (time.perf_counter() - begin)
        found = integrate(len(cells), "u1_split" in plan.technique.declared, goal, evaluate)
        bad = [_bad_input(found, evaluate.splits, at) for at in range(len(cells))]
    return Estimate(
        estimator=estimator.model_copy(
            update={"method": "quadrature", "samples": int(found.nodes.max()), "tolerance": tolerance}
        ),
        statistics=_statistics(found, finite_variance & ~found.growing),
        zero_fraction=np.clip(found.zero, 0.0, 1.0),
        largest=found.largest,
        nonfinite=found.nonfinite,
        negative=found.negative,
        bad_inputs=bad,
        unreached=~found.converged,
        divergent=found.growing & goal.variance,
        evaluations=int(found.nodes.sum()),
        device_ns=evaluate.device_ns,
        built_ms=built_ms,
    )


def _statistics(found: Integrals, finite_variance: Bools) -> Statistics:
    second, fourth = central_moments(found.powers)
    variance = np.where(finite_variance, second, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        kurtosis = np.where(variance > 0, fourth / variance**2, 1.0)
    return Statistics(
        mean=found.shift + found.powers[0],
        mean_stderr=found.mean_error,
        variance=variance,
        variance_stderr=np.where(finite_variance, found.variance_error, np.nan),
        kurtosis=np.where(finite_variance, kurtosis, np.nan),
    )


def _bad_input(found: Integrals, splits: Array, at: int) -> tuple[int, NDArray[np.float32]] | None:
    if not found.nonfinite[at]:
        return None
    t, u2 = found.bad_panel.corner[at, :2]
    u1 = splits[at] + (1.0 - splits[at]) * t if found.bad_panel.part[at] == 1 else splits[at] * t
    return 0, np.array([u1, u2], np.float32)


class Evaluator:
    """Weights at the nodes of panels, computed on the device; a context manager that frees its buffers.

    The pipeline is that of the job `quadrature`, built in the same precision; in double the cells have float64 arrays.
    Raises IncompleteRun where a loop of the shader was ended at the limit, and what the device raises.
    """

    def __init__(self, device: Device, pipeline: Pipeline, cells: Cells, precision: Precision = "float") -> None:
        layout = _LAYOUTS[precision]
        self._device, self._pipeline = device, pipeline
        self.device_ns = 0
        self.splits = np.zeros(len(cells))
        self._cells = device.buffer((len(cells),), layout.cell)
        self._cells.array["wo"] = cells.wo
        self._parameters = device.buffer((max(1, cells.parameters.size),), layout.real)
        self._parameters.array[: cells.parameters.size] = cells.parameters.ravel()
        self._panels = device.buffer((_CHUNK,), layout.panel)
        self._nodes = device.buffer((NODES, 2), layout.real)
        self._nodes.array[:] = np.stack([np.repeat(POINTS, SIDE), np.tile(POINTS, SIDE)], axis=1)
        self._weights = device.buffer((_CHUNK, NODES), layout.real)
        self._splits = device.buffer((len(cells),), layout.real)
        self._done = device.buffer((_CHUNK // _PANELS_PER_GROUP, NODES), np.uint32)
        self._warm_up()

    def __enter__(self) -> Evaluator:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for buffer in self._buffers:
            buffer.close()

    def __call__(self, panels: Panels) -> Values:
        """The weights at the nodes, NaN for a bad sample."""
        out = np.empty((len(panels), NODES))
        for first in range(0, len(panels), _CHUNK):
            part = slice(first, min(first + _CHUNK, len(panels)))
            count = part.stop - first
            rows = self._panels.array
            rows["cell"][:count, 0], rows["cell"][:count, 1] = panels.cell[part], panels.part[part]
            rows["corner"][:count] = panels.corner[part]
            self.device_ns += self._run(count)
            out[part] = self._weights.array[:count]
        self.splits = self._splits.array.astype(np.float64)
        return Values(out, self.splits)

    def _warm_up(self) -> None:
        """Run once, so that the driver compiles before anything is timed."""
        self._panels.array["cell"][0] = 0
        self._run(1)

    def _run(self, count: int) -> int:
        groups = (-(-count // _PANELS_PER_GROUP), 1, 1)
        constants = struct.pack("<I", count)
        spent = self._device.run(self._pipeline, self._buffers, groups, constants, timeout_s=TIMEOUT_S).total_ns
        if not self._done.array[: groups[0]].all():
            raise IncompleteRun("a loop of the shader ran to the limit of 65,535 iterations of one invocation")
        return spent

    @property
    def _buffers(self) -> list[Buffer]:
        return [self._cells, self._parameters, self._panels, self._nodes, self._weights, self._splits, self._done]
