"""Statistics of a scene: mean, variance and largest weight of every technique at every view angle, with a verdict."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from service.engine import Engine
from service.moments import Statistics, from_power_sums
from service.random_numbers import cell_key, random_pairs
from service.reference import CellReference
from service.reference_store import series_reference
from service.sampling import Cells, CellSums, Sampler
from service.scene import Question, Scene, SeriesPlan, radians
from service.verdict import Evidence, finite_or_none, verdict

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how many samples are done, and how many there will be."""


def compute_statistics(question: Question, engine: Engine, progress: Progress = lambda *_: None) -> dict[str, Any]:
    """Answer a question: the result of kind `statistics`, as plain data ready for JSON.

    Raises BadInput for parameters out of range, lavapipe.CompileError for a shader that does not compile, and the other
    errors of lavapipe for the device.
    """
    scene = question.scene
    begin = time.perf_counter()
    total = len(question.series) * len(scene.angles_deg) * scene.estimator.samples
    done = 0
    compile_ms = 0.0
    series = []
    for plan in question.series:
        name = plan.technique.name

        def advance(samples: int, name: str = name) -> None:
            nonlocal done
            done += samples
            progress(name, done, total)

        progress(name, done, total)
        sums, built_ms = _draw(plan, scene, engine, advance)
        compile_ms += built_ms
        series.append(_series(plan, scene, sums, engine))
    info = engine.device.info
    return {
        "kind": "statistics",
        "scene": scene.model_dump(mode="json"),
        "series": series,
        "left_out": left_out(scene),
        "run": {
            "device": info.name,
            "driver": info.driver_version,
            "threads": info.threads,
            "compile_ms": compile_ms,
            "device_ms": math.fsum(entry["device_ms"] for entry in series),
            "elapsed_ms": 1e3 * (time.perf_counter() - begin),
        },
    }


def moments_needed(scene: Scene) -> int:
    """The highest power of the weight that the asked statistics and their error bars need."""
    if "variance" in scene.statistics:
        return 4 if scene.error_bars else 2
    if "mean" in scene.statistics:
        return 2 if scene.error_bars else 1
    return 0


def left_out(scene: Scene) -> list[dict[str, str]]:
    """What the shader of this scene does not compute, and why."""
    moments = moments_needed(scene)
    out = []
    if moments < 4:
        bars = "error bars were not asked for" if not scene.error_bars else "the variance was not asked for"
        out.append({"feature": "third and fourth powers of the weight", "reason": bars})
    if moments < 2:
        out.append({"feature": "second power of the weight", "reason": "only the mean or the maximum was asked for"})
    if moments < 1:
        out.append({"feature": "sum of the weight", "reason": "neither mean nor variance was asked for"})
    if "max_weight" not in scene.statistics:
        out.append({"feature": "largest weight", "reason": "max_weight was not asked for"})
    return out


def series_cells(plan: SeriesPlan, scene: Scene) -> Cells:
    """The cells of one series, one a view angle. Cosines are formed in double precision before they become float32."""
    angles = [radians(angle) for angle in scene.angles_deg]
    wo = np.array([(math.sin(angle), 0.0, math.cos(angle)) for angle in angles], np.float32)
    keys = np.array([cell_key(scene.estimator.seed, angle) for angle in scene.angles_deg], np.uint32)
    row = np.array([list(plan.parameters.values())], np.float32)
    return Cells(wo, keys, np.repeat(row, len(angles), axis=0))


def _draw(plan: SeriesPlan, scene: Scene, engine: Engine, advance: Callable[[int], None]) -> tuple[CellSums, float]:
    """The sums of one series, and the milliseconds that building its pipeline took."""
    specialization = {0: moments_needed(scene), 1: "max_weight" in scene.statistics}
    begin = time.perf_counter()
    pipeline = engine.pipeline(plan.model, plan.technique, "statistics", specialization)
    with Sampler(engine.device, pipeline, series_cells(plan, scene)) as sampler:
        sampler.warm_up()
        built_ms = 1e3 * (time.perf_counter() - begin)
        return sampler.run(scene.estimator.samples, advance), built_ms


def _series(plan: SeriesPlan, scene: Scene, sums: CellSums, engine: Engine) -> dict[str, Any]:
    angles = scene.angles_deg
    cells = None
    if scene.reference and not (plan.model.own or plan.technique.own):
        cells = series_reference(plan.model.name, plan.technique.name, plan.parameters, angles, engine.cache)
    moments = moments_needed(scene)
    statistics = from_power_sums(sums.counted, sums.shift, sums.powers, moments) if moments else None
    entry: dict[str, Any] = {
        "model": plan.model.name,
        "technique": plan.technique.name,
        "parameters": dict(plan.parameters),
        "theta_o_deg": list(angles),
    }
    if statistics is not None:
        entry |= _moment_columns(scene, statistics, cells)
    if "max_weight" in scene.statistics:
        entry["max_weight"] = finite_or_none(sums.largest)
    evidence = Evidence(
        theta_o_deg=angles,
        samples=scene.estimator.samples,
        sums=sums,
        statistics=statistics,
        reference=cells,
        replay=_replays(plan, scene, sums),
    )
    return entry | {
        "zero_fraction": (sums.zero / sums.drawn).tolist(),
        "nonfinite": sums.nonfinite.tolist(),
        "samples": scene.estimator.samples,
        "reference": _reference_columns(scene, cells),
        "verdict": verdict(evidence),
        "device_ms": sums.device_ns / 1e6,
    }


def _moment_columns(
    scene: Scene, statistics: Statistics, cells: Sequence[CellReference] | None
) -> dict[str, list[float | None]]:
    """Mean and variance with their standard errors; null where the moment behind a standard error is infinite."""
    variance = np.array([cell.variance for cell in cells]) if cells else np.zeros(len(statistics.mean))
    fourth = np.array([cell.fourth_moment for cell in cells]) if cells else np.zeros(len(statistics.mean))
    columns = {}
    if "mean" in scene.statistics:
        columns["mean"] = finite_or_none(statistics.mean)
        if scene.error_bars:
            columns["mean_stderr"] = finite_or_none(np.where(np.isfinite(variance), statistics.mean_stderr, np.nan))
    if "variance" in scene.statistics:
        columns["variance"] = finite_or_none(statistics.variance)
        if scene.error_bars:
            known = np.isfinite(fourth)
            columns["variance_stderr"] = finite_or_none(np.where(known, statistics.variance_stderr, np.nan))
    return columns


def _reference_columns(scene: Scene, cells: Sequence[CellReference] | None) -> dict[str, list[float | None]] | None:
    """The reference as columns; `variance_stderr` is the standard error to expect of a variance from this many
    samples.
    """
    if cells is None:
        return None
    n = scene.estimator.samples
    spread = [
        math.sqrt(max(0.0, cell.fourth_moment - cell.variance**2 * (n - 3) / max(1, n - 1)) / n)
        if math.isfinite(cell.fourth_moment)
        else math.inf
        for cell in cells
    ]
    return {
        "mean": finite_or_none(cell.mean for cell in cells),
        "albedo": finite_or_none(cell.albedo for cell in cells),
        "variance": finite_or_none(cell.variance for cell in cells),
        "variance_stderr": finite_or_none(spread),
        "max_weight": finite_or_none(cell.max_weight for cell in cells),
    }


def _replays(plan: SeriesPlan, scene: Scene, sums: CellSums) -> list[dict[str, Any]]:
    """The exact inputs of the first non-finite sample of every cell; empty where there is none."""
    replays: list[dict[str, Any]] = []
    for angle, index in zip(scene.angles_deg, sums.first_bad.tolist(), strict=True):
        if index < 0:
            replays.append({})
            continue
        u = random_pairs(cell_key(scene.estimator.seed, angle), np.array([index], np.uint64))[0]
        replays.append(
            {
                "model": plan.model.name,
                "technique": plan.technique.name,
                "parameters": dict(plan.parameters),
                "theta_o_deg": angle,
                "sample": index,
                "u_bits": [f"0x{bits:08x}" for bits in u.view(np.uint32)],
            }
        )
    return replays
