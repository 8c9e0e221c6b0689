"""Statistics of a scene: mean, variance and largest weight of every technique at every view angle, with a verdict."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.axes import axes
from service.engine import Engine
from service.estimators import Estimate, SeriesRun, estimate, statistics_so_far
from service.estimators.quadrature import LEAST_VARIANCE
from service.left_out import Feature, features_left_out, moments_needed, report, structure_without
from service.moments import Statistics
from service.plain_data import finite_or_none
from service.random_numbers import cell_key
from service.reference import CellReference
from service.reference_store import plan_reference
from service.sampling import Cells, CellSums, Journal
from service.scene import Question, Scene, SeriesPlan
from service.verdict import Evidence, verdict

REFERENCE_ANGLES = 16
"""Cells whose reference is computed at a time: tenths of a second, so that an interruption is prompt."""

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of the work is done, and how much there is (samples, or steps)."""


def compute_statistics(
    question: Question,
    engine: Engine,
    progress: Progress = lambda *_: None,
    journal: Callable[[int], Journal | None] = lambda series: None,
) -> dict[str, Any]:
    """Answer a question: the result of kind `statistics`, as plain data ready for JSON.

    `journal` gives the journal of each series by its number: a run goes on from what it holds, and ends with the same
    bits as one that was never interrupted.
    Raises BadInput for parameters out of range, lavapipe.CompileError for a shader that does not compile, and the other
    errors of lavapipe for the device.
    """
    scene = question.scene
    begin = time.perf_counter()
    total = len(question.series) * len(scene.angles_deg) * scene.estimator.samples
    done = 0
    compile_ms = 0.0
    series: list[dict[str, Any]] = []
    features: list[Sequence[Feature]] = []
    for number, plan in enumerate(question.series):
        name = plan.technique.name

        def advance(samples: int, name: str = name) -> None:
            nonlocal done
            done += samples
            progress(name, min(done, total), total)

        done = number * total // len(question.series)  # an estimator may need more or fewer samples than asked for
        progress(name, done, total)
        entry, found = _series(plan, scene, engine, advance, journal(number))
        compile_ms += found.built_ms
        series.append(entry)
        features.append(features_left_out(plan, scene, found.estimator.method))
    return {
        "kind": "statistics",
        "scene": scene.model_dump(mode="json"),
        "axes": axes(series),
        "series": series,
        "left_out": report(features),
        "run": engine.run_block(
            begin,
            threads=engine.device.info.threads,
            compile_ms=compile_ms,
            device_ms=math.fsum(entry["device_ms"] for entry in series),
        ),
    }


def series_cells(plan: SeriesPlan, scene: Scene) -> Cells:
    """The cells of one series, one a view angle. Cosines are formed in double precision before they become float32."""
    angles = [math.radians(angle) for angle in scene.angles_deg]
    x, y = math.cos(math.radians(plan.azimuth_deg)), math.sin(math.radians(plan.azimuth_deg))
    wo = np.array([(x * math.sin(angle), y * math.sin(angle), math.cos(angle)) for angle in angles], np.float32)
    keys = np.array([cell_key(scene.estimator.seed, angle, plan.azimuth_deg) for angle in scene.angles_deg], np.uint32)
    row = np.array([list(plan.parameters.values())], np.float32)
    return Cells(wo, keys, np.repeat(row, len(angles), axis=0))


def partial_series(plan: SeriesPlan, scene: Scene, sums: CellSums) -> dict[str, Any]:
    """What the sums of an unfinished run give, as a series that plots.

    `samples` has an entry an angle, since they differ; an angle without any is null.
    """
    sampled = statistics_so_far(sums, len(scene.angles_deg), moments_needed(scene))
    entry = _head(plan, scene) | {"samples": sampled.samples.tolist()}
    if sampled.statistics is not None:
        entry |= _moment_columns(scene, sampled.statistics, None)
    if "max_weight" in scene.statistics:
        entry["max_weight"] = finite_or_none(sampled.largest)
    return entry


def _head(plan: SeriesPlan, scene: Scene) -> dict[str, Any]:
    return {
        "model": plan.model.name,
        "technique": plan.technique.name,
        "parameters": dict(plan.parameters),
        "theta_o_deg": list(scene.angles_deg),
        **_azimuth(plan),
    }


def _reference(plan: SeriesPlan, scene: Scene, engine: Engine, pause: Callable[[], None]) -> list[CellReference] | None:
    """The reference of every angle, None where there is none or it was not asked for.

    `pause` is called time and again: a reference takes milliseconds a cell the first time.
    """
    if not scene.reference:
        return None
    reference: list[CellReference] = []
    for first in range(0, len(scene.angles_deg), REFERENCE_ANGLES):
        pause()
        angles = scene.angles_deg[first : first + REFERENCE_ANGLES]
        found = plan_reference(plan, angles, engine)
        if found is None:
            return None
        reference += found
    return reference


def _series(
    plan: SeriesPlan, scene: Scene, engine: Engine, advance: Callable[[int], None], journal: Journal | None
) -> tuple[dict[str, Any], Estimate]:
    """One series of the result, and the estimate that it was made of."""
    reference = _reference(plan, scene, engine, lambda: advance(0))
    structure = structure_without(features_left_out(plan, scene))
    run = SeriesRun(plan, engine, series_cells(plan, scene), structure, advance, journal)
    found = estimate(run, scene, reference)
    entry = _head(plan, scene)
    if found.statistics is not None:
        entry |= _moment_columns(scene, found.statistics, reference)
    if "max_weight" in scene.statistics:
        entry["max_weight"] = finite_or_none(found.largest)
    evidence = Evidence(scene.angles_deg, found, reference, _replays(plan, scene, found))
    if found.zero_fraction is not None:
        entry["zero_fraction"] = found.zero_fraction.tolist()
    return entry | {
        "nonfinite": found.nonfinite.tolist(),
        "samples": found.estimator.samples,
        "estimator": found.estimator.model_dump(mode="json", exclude_none=True),
        "reference": _reference_columns(scene, found, reference),
        "verdict": verdict(evidence),
        "device_ms": found.device_ns / 1e6,
    }, found


def _azimuth(plan: SeriesPlan) -> dict[str, float]:
    """The view azimuth as a field, for anisotropic models."""
    return {} if plan.phi_o_deg is None else {"phi_o_deg": plan.phi_o_deg}


def _moment_columns(
    scene: Scene, statistics: Statistics, reference: Sequence[CellReference] | None
) -> dict[str, list[float | None]]:
    """Mean and variance with their standard errors; null where the moment behind a standard error is infinite.

    A quadrature gives no variance where it is infinite, and bounds of its own error in place of standard errors. A
    moment that the reference does not know counts as finite.
    """

    def infinite(moment: str) -> NDArray[np.bool_] | np.bool_:
        return np.isinf([getattr(cell, moment) for cell in reference]) if reference else np.False_

    columns = {}
    if "mean" in scene.statistics:
        columns["mean"] = finite_or_none(statistics.mean)
        if scene.error_bars:
            meaningless = infinite("variance") & (scene.estimator.method in ("mc", "qmc"))
            columns["mean_stderr"] = finite_or_none(np.where(meaningless, np.nan, statistics.mean_stderr))
    if "variance" in scene.statistics:
        columns["variance"] = finite_or_none(statistics.variance)
        if scene.error_bars:
            meaningless = infinite("fourth_moment")
            columns["variance_stderr"] = finite_or_none(np.where(meaningless, np.nan, statistics.variance_stderr))
    return columns


def _reference_columns(
    scene: Scene, found: Estimate, reference: Sequence[CellReference] | None
) -> dict[str, list[float | None]] | None:
    """The reference as columns, and the relative errors of the estimate against it.

    `variance_stderr` is the standard error to expect of a variance from this many independent samples; an uncertainty
    is what the reference itself may be off by. A null without a finding that says why is not known.
    """
    if reference is None:
        return None
    n = found.estimator.samples
    spread = [
        math.sqrt(max(0.0, cell.fourth_moment - cell.variance**2 * (n - 3) / max(1, n - 1)) / n)
        if math.isfinite(cell.fourth_moment)
        else math.inf
        for cell in reference
    ]
    exact = ("mean", "albedo", "variance", "max_weight")
    uncertain = ("mean_uncertainty", "albedo_uncertainty", "variance_uncertainty")
    columns = {name: finite_or_none(getattr(cell, name) for cell in reference) for name in (*exact, *uncertain)}
    columns["variance_stderr"] = finite_or_none(spread)
    if found.statistics is not None and "mean" in scene.statistics:
        columns["mean_error"] = _relative_errors(found.statistics.mean, [cell.mean for cell in reference])
    if found.statistics is not None and "variance" in scene.statistics:
        columns["variance_error"] = _relative_errors(found.statistics.variance, [cell.variance for cell in reference])
    return columns


def _relative_errors(values: NDArray[np.float64], truth: Sequence[float]) -> list[float | None]:
    """Estimate over reference, less 1; null where the reference is infinite or as good as zero."""
    exact = np.array(truth)
    usable = np.isfinite(exact) & (np.abs(exact) > LEAST_VARIANCE)
    return finite_or_none(np.where(usable, values / np.where(usable, exact, 1.0) - 1.0, np.nan))


def _replays(plan: SeriesPlan, scene: Scene, found: Estimate) -> list[dict[str, Any]]:
    """The exact inputs of the first non-finite sample of every cell; empty where there is none."""
    replays: list[dict[str, Any]] = []
    for angle, bad in zip(scene.angles_deg, found.bad_inputs, strict=True):
        if bad is None:
            replays.append({})
            continue
        index, u = bad
        replays.append(
            {
                "model": plan.model.name,
                "technique": plan.technique.name,
                "parameters": dict(plan.parameters),
                "theta_o_deg": angle,
                **_azimuth(plan),
                "sample": index,
                "u_bits": [f"0x{bits:08x}" for bits in u.view(np.uint32)],
            }
        )
    return replays
