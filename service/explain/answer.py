"""The answer of `explain`: what the shaders of a scene leave out, with sizes and times beside those that keep it."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lavapipe import Device
from service.engine import Engine
from service.explain.shaders import Group, Shader, Size, groups_of, shader_without, size_of, whole_shader
from service.explain.timing import LAUNCH_SAMPLES, ROUNDS, Spread, compile_time, sample_times, spread
from service.left_out import report, structure_without
from service.scene import Question
from service.statistics import Progress

_AVERAGED = ("module_bytes", "spirv_bytes", "instructions", "compile_ms", "ns_per_sample")
_NOTHING = {**dict.fromkeys(_AVERAGED, 0), "quartiles": [0.0, 0.0]}
"""In the place of a variant that draws no sample."""


@dataclass(frozen=True)
class _Times:
    """ns a sample of a group's shaders, a round each, shape (rounds,) and (rounds, features)."""

    full: NDArray[np.float64]
    variant: NDArray[np.float64]
    without: NDArray[np.float64]


@dataclass(frozen=True)
class _Comparison:
    """A group of series with its shaders: the full one, the variant, and the full one without each feature.

    Where the answer is known without a sample there is the full one alone.
    """

    group: Group
    shaders: list[Shader]
    sizes: list[Size]


def compute_explanation(
    question: Question,
    engine: Engine,
    progress: Progress = lambda *_: None,
    *,
    rounds: int = ROUNDS,
    compiled: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """Answer a question: the result of kind `explain`, plain data for JSON.

    Series that have the same variant are measured once, at the parameters of the first, on a device of its own that
    compiles everything anew. Every group of shaders runs interleaved, `rounds` times. `compiled` is called when no file
    is read and no program started any more, before the first shader runs. Raises as
    `service.statistics.compute_statistics` does.
    """
    begin = time.perf_counter()
    groups = groups_of(question)
    comparisons = [_comparison(engine, question, group) for group in groups]
    info = engine.device.info
    total = sum(len(comparison.shaders) for comparison in comparisons) * rounds * LAUNCH_SAMPLES
    done = 0
    with Device.open(None if info.is_lavapipe else info.name, shader_cache=False) as device:
        compiled()
        shaders = []
        for comparison in comparisons:

            def advance(samples: int, name: str = comparison.group.plan.technique.name) -> None:
                nonlocal done
                done += samples
                progress(name, min(done, total), total)

            advance(0)
            shaders.append(_explained(device, comparison, rounds, advance))
    return {
        "kind": "explain",
        "scene": question.scene.model_dump(mode="json"),
        "series": [
            {"model": plan.model.name, "technique": plan.technique.name, "parameters": dict(plan.parameters)}
            for plan in question.series
        ],
        "left_out": _left_out(question, groups, shaders),
        "variant": _averaged([one["variant"] for one in shaders], groups),
        "full": _averaged([one["full"] for one in shaders], groups),
        "shaders": shaders,
        "run": engine.run_block(
            begin,
            threads=info.threads,
            clock="processor" if info.is_lavapipe else "device",
            rounds=rounds,
            samples_per_round=LAUNCH_SAMPLES,
        ),
    }


def _comparison(engine: Engine, question: Question, group: Group) -> _Comparison:
    shaders = [whole_shader(engine, question, group.plan)]
    if structure_without(group.features).drawn:
        shaders.append(shader_without(engine, question, group.plan, group.features))
        shaders += [shader_without(engine, question, group.plan, [feature]) for feature in group.features]
    return _Comparison(group, shaders, [size_of(engine, shader) for shader in shaders])


def _explained(device: Device, comparison: _Comparison, rounds: int, advance: Callable[[int], None]) -> dict[str, Any]:
    """One variant beside the shader that keeps everything, and what each feature alone saves of that."""
    group, sizes = comparison.group, comparison.sizes
    drawn = len(comparison.shaders) > 1
    times = _times(sample_times(device, comparison.shaders, rounds, advance), drawn)
    compile_ms = [compile_time(device, shader) for shader in comparison.shaders[:2]]
    return {
        "model": group.plan.model.name,
        "technique": group.plan.technique.name,
        "series": group.series,
        "variant": _figures(sizes[1], compile_ms[1], times.variant) if drawn else dict(_NOTHING),
        "full": _figures(sizes[0], compile_ms[0], times.full),
        "speedup": _rounded(spread(times.full / times.variant)) if drawn else None,
        "left_out": [
            {
                "feature": feature.name,
                "reason": feature.reason,
                "saves": {
                    **_saved(spread(times.full - times.without[:, at])),
                    "instructions": sizes[0].instructions - (sizes[2 + at].instructions if drawn else 0),
                },
            }
            for at, feature in enumerate(group.features)
        ],
    }


def _times(found: NDArray[np.float64], drawn: bool) -> _Times:
    if drawn:
        return _Times(found[:, 0], found[:, 1], found[:, 2:])
    return _Times(found[:, 0], np.zeros(len(found)), np.zeros((len(found), 1)))


def _figures(size: Size, compile_ms: float, times: NDArray[np.float64]) -> dict[str, Any]:
    over_rounds = spread(times)
    return {
        "module_bytes": size.module_bytes,
        "spirv_bytes": size.spirv_bytes,
        "instructions": size.instructions,
        "specialized": size.specialized,
        "compile_ms": compile_ms,
        "ns_per_sample": over_rounds.median,
        "quartiles": list(over_rounds.quartiles),
    }


def _rounded(ratio: Spread) -> dict[str, Any]:
    return {"median": ratio.median, "quartiles": list(ratio.quartiles), "interval": list(ratio.interval)}


def _saved(difference: Spread) -> dict[str, Any]:
    return {"ns_per_sample": difference.median, "interval": list(difference.interval)}


def _averaged(figures: Sequence[Mapping[str, Any]], groups: Sequence[Group]) -> dict[str, Any]:
    """Sizes and times of the shader that answers a series, on average over the series."""
    weights = [len(group.series) for group in groups]
    averages = {name: float(np.average([one[name] for one in figures], weights=weights)) for name in _AVERAGED}
    return averages | {name: round(averages[name]) for name in ("module_bytes", "spirv_bytes", "instructions")}


def _left_out(
    question: Question, groups: Sequence[Group], shaders: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """The features of all shaders, each with its series and what it saves on average over these."""
    by_series: list[Any] = [()] * len(question.series)
    saves: dict[tuple[str, str], list[tuple[int, Mapping[str, Any]]]] = {}
    for group, shader in zip(groups, shaders, strict=True):
        for number in group.series:
            by_series[number] = group.features
        for one in shader["left_out"]:
            saves.setdefault((one["feature"], one["reason"]), []).append((len(group.series), one["saves"]))
    return [one | {"saves": _average_saving(saves[one["feature"], one["reason"]])} for one in report(by_series)]


def _average_saving(found: Sequence[tuple[int, Mapping[str, Any]]]) -> dict[str, Any]:
    weights = [weight for weight, _ in found]

    def average(values: Sequence[float]) -> float:
        return float(np.average(values, weights=weights))

    return {
        "ns_per_sample": average([saving["ns_per_sample"] for _, saving in found]),
        "instructions": round(average([saving["instructions"] for _, saving in found])),
    }
