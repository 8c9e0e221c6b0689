"""What every estimator gives for one series."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.moments import Statistics
from service.scene import Estimator


@dataclass(frozen=True)
class Estimate:
    """Statistics of the cells of one series, each array of shape (cells,), with what they cost.

    estimator: as used, with the count for every cell. statistics: None where no moment was asked for; its standard
    errors are those of the estimator's own replicates (mc, qmc) or its bound of the error (quadrature).
    zero_fraction: None where zero weights were not counted.
    bad_inputs: sample index and (u1, u2) as float32 of the first sample that is not finite, None where all are.
    evaluations: weights evaluated in all. unreached: cells whose stated error is above the tolerance. divergent: cells
    whose variance grew without limit.
    """

    estimator: Estimator
    statistics: Statistics | None
    zero_fraction: NDArray[np.float64] | None
    largest: NDArray[np.float64]
    nonfinite: NDArray[np.int64]
    negative: NDArray[np.int64]
    bad_inputs: Sequence[tuple[int, NDArray[np.float32]] | None]
    unreached: NDArray[np.bool_]
    divergent: NDArray[np.bool_]
    evaluations: int
    device_ns: int
    built_ms: float
