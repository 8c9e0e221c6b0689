"""The estimators that draw samples: `mc` with random numbers, `qmc` with replicates of a scrambled Sobol' sequence."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.engine import Engine
from service.estimators.estimate import Estimate
from service.moments import Statistics, central_moments, from_power_sums
from service.random_numbers import random_pairs, replicate_key, scrambled_sobol_pairs
from service.sampling import Cells, CellSums, Journal, Sampler
from service.scene import Estimator, SeriesPlan
from service.structure import Structure

Advance = Callable[[int], None]
REPLICATES = 16
"""Independent scramblings of `qmc`: their spread gives the error bars, with 15 degrees of freedom."""


@contextmanager
def open_sampler(
    plan: SeriesPlan, engine: Engine, cells: Cells, structure: Structure, *, sobol: bool
) -> Iterator[tuple[Sampler, float]]:
    """A warm sampler for the cells of a series, and the milliseconds that building it took."""
    begin = time.perf_counter()
    constants = structure.statistics_constants(plan.model, [plan.technique], sobol=sobol)
    pipeline = engine.pipeline(plan.model, plan.technique, "statistics", constants)
    with Sampler(engine.device, pipeline, cells) as sampler:
        if engine.first_use(pipeline):
            sampler.warm_up()
        yield sampler, 1e3 * (time.perf_counter() - begin)


def replicated(cells: Cells, replicates: Sequence[tuple[int, int]]) -> Cells:
    """The cells again and again: all of them with the first keys of `replicates`, and so on; keys in cell order."""
    times = len(replicates) // len(cells)
    return Cells(np.tile(cells.wo, (times, 1)), np.array(replicates, np.uint32), np.tile(cells.parameters, (times, 1)))


@dataclass(frozen=True)
class SeriesRun:
    """A series to be estimated: its cells, what its shader computes (see `service.left_out`), who hears of progress.

    `advance` is called with the number of samples just drawn; `journal` keeps how far the sampling is.
    """

    plan: SeriesPlan
    engine: Engine
    cells: Cells
    structure: Structure
    advance: Advance = lambda done: None
    journal: Journal | None = None


def _sums(run: SeriesRun, samples: int, *, sobol: bool) -> tuple[CellSums, float]:
    """What so many samples of every cell give, and the milliseconds that building the shader took.

    The index of a non-finite sample is kept only when there is one: they are then drawn again by a shader that looks.
    """
    with open_sampler(run.plan, run.engine, run.cells, run.structure, sobol=sobol) as (sampler, built_ms):
        sums = sampler.run(samples, run.advance, run.journal)
    if run.structure.first_bad or not sums.nonfinite.any():
        return sums, built_ms
    looking = replace(run, structure=replace(run.structure, first_bad=True), advance=lambda _: run.advance(0))
    again, more_ms = _sums(looking, samples, sobol=sobol)
    again.device_ns += sums.device_ns
    return again, built_ms + more_ms


def monte_carlo(run: SeriesRun, estimator: Estimator) -> Estimate:
    """Independent samples; the error bars are theirs."""
    cells, structure, moments = run.cells, run.structure, run.structure.moments
    sums, built_ms = _sums(run, estimator.samples, sobol=False)
    bad = [
        (index, random_pairs(_key(cells, at), np.array([index], np.uint64))[0]) if index >= 0 else None
        for at, index in enumerate(sums.first_bad.tolist())
    ]
    return Estimate(
        estimator=estimator.model_copy(update={"method": "mc"}),
        statistics=from_power_sums(sums.counted, sums.shift, sums.powers, moments) if moments else None,
        zero_fraction=sums.zero / sums.drawn if structure.zeros else None,
        largest=sums.largest,
        nonfinite=sums.nonfinite,
        negative=sums.negative,
        bad_inputs=bad,
        unreached=np.zeros(len(cells), bool),
        divergent=np.zeros(len(cells), bool),
        evaluations=int(sums.drawn.sum()),
        device_ns=sums.device_ns,
        built_ms=built_ms,
    )


def nothing_drawn(cells: int, estimator: Estimator) -> Estimate:
    """The estimate of a black model: every weight is 0, whatever is drawn."""
    zeros, none = np.zeros(cells), np.zeros(cells, np.int64)
    drawn = estimator.samples if estimator.method == "mc" else REPLICATES  # one sample has no variance
    return Estimate(
        estimator=estimator.model_copy(update={"method": estimator.method or "quadrature"}),
        statistics=from_power_sums(np.full(cells, drawn), zeros, np.zeros((4, cells))),
        zero_fraction=np.ones(cells),
        largest=zeros,
        nonfinite=none,
        negative=none,
        bad_inputs=[None] * cells,
        unreached=np.zeros(cells, bool),
        divergent=np.zeros(cells, bool),
        evaluations=0,
        device_ns=0,
        built_ms=0.0,
    )


def quasi_monte_carlo(run: SeriesRun, angles_deg: Sequence[float], estimator: Estimator) -> Estimate:
    """Replicates of a scrambled sequence, each of a power of two of points; the error bars are their spread."""
    cells, structure, moments = run.cells, run.structure, run.structure.moments
    points = points_for(estimator.samples)
    keys = [replicate_key(estimator.seed, r, angle) for r in range(REPLICATES) for angle in angles_deg]
    many = replicated(cells, keys)
    sums, built_ms = _sums(replace(run, cells=many), points, sobol=True)
    by_replicate = (REPLICATES, len(cells))
    first_bad = sums.first_bad.reshape(by_replicate)
    bad: list[tuple[int, NDArray[np.float32]] | None] = []
    for at in range(len(cells)):
        held = np.flatnonzero(first_bad[:, at] >= 0)
        if not len(held):
            bad.append(None)
            continue
        index = int(first_bad[held[0], at])
        key = _key(many, int(held[0]) * len(cells) + at)
        bad.append((index, scrambled_sobol_pairs(key, np.array([index], np.uint64))[0]))
    return Estimate(
        estimator=estimator.model_copy(update={"method": "qmc", "samples": points * REPLICATES}),
        statistics=_pooled(sums, by_replicate, moments) if moments else None,
        zero_fraction=(sums.zero / sums.drawn).reshape(by_replicate).mean(axis=0) if structure.zeros else None,
        largest=sums.largest.reshape(by_replicate).max(axis=0),
        nonfinite=sums.nonfinite.reshape(by_replicate).sum(axis=0),
        negative=sums.negative.reshape(by_replicate).sum(axis=0),
        bad_inputs=bad,
        unreached=np.zeros(len(cells), bool),
        divergent=np.zeros(len(cells), bool),
        evaluations=int(sums.drawn.sum()),
        device_ns=sums.device_ns,
        built_ms=built_ms,
    )


@dataclass(frozen=True)
class Drawn:
    """What the sums of an unfinished run give, an entry a cell: samples drawn, statistics and largest weight."""

    samples: NDArray[np.int64]
    statistics: Statistics | None
    largest: NDArray[np.float64]


def statistics_so_far(sums: CellSums, cells: int, moments: int) -> Drawn:
    """The statistics of an unfinished run of either estimator for so many cells; NaN for a cell without a sample."""
    if len(sums.drawn) == cells:
        statistics = from_power_sums(sums.counted, sums.shift, sums.powers, moments) if moments else None
        return Drawn(sums.drawn, statistics, sums.largest)
    shape = (REPLICATES, cells)
    return Drawn(
        sums.drawn.reshape(shape).sum(axis=0),
        _pooled(sums, shape, moments) if moments else None,
        sums.largest.reshape(shape).max(axis=0),
    )


def points_for(samples: int) -> int:
    """Points of each replicate for about this many samples in all: the power of two that gives no fewer."""
    return 1 << max(0, math.ceil(math.log2(samples / REPLICATES))) if samples > REPLICATES else 1


def _pooled(sums: CellSums, shape: tuple[int, int], moments: int) -> Statistics:
    """Statistics over replicates of shape (replicates, cells).

    The variance is the mean square about the mean of all, plus the square of that mean's standard error, which is what
    it lacks on average. What needs a power above `moments` is NaN.
    """
    replicates = shape[0]
    n = np.maximum(sums.counted, 1).astype(np.float64)
    powers = [row.reshape(shape) for row in sums.powers / n]
    a, b, c, _ = powers
    means = sums.shift.reshape(shape) + a
    mean = means.mean(axis=0)
    offset = means - mean
    second, fourth = central_moments(powers)
    third = c - 3 * a * b + 2 * a**3
    squares = second + offset * offset
    central4 = (fourth + 4 * third * offset + 6 * second * offset**2 + offset**4).mean(axis=0)
    mean_stderr = means.std(axis=0, ddof=1) / math.sqrt(replicates)
    variance = squares.mean(axis=0) + mean_stderr**2
    unknown = np.full(shape[1], np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        kurtosis = np.where(variance > 0, central4 / variance**2, 1.0)
    return Statistics(
        mean=mean,
        mean_stderr=mean_stderr,
        variance=variance if moments >= 2 else unknown,
        variance_stderr=squares.std(axis=0, ddof=1) / math.sqrt(replicates) if moments >= 2 else unknown,
        kurtosis=kurtosis if moments >= 4 else unknown,
    )


def _key(cells: Cells, at: int) -> tuple[int, int]:
    low, high = cells.keys[at].tolist()
    return low, high
