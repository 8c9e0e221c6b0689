"""What a shader leaves out: each feature by its name, the reason in words, and what it changes in the structure.

Leaving a feature out changes no bit of a statistic that is still computed. What a model or technique says of itself
(its head's `left_out`, `black` and `below_horizon`) is believed of files of the catalogue, whose tests hold it; a
user's own file runs as it is, because the question is whether it is right.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from service.catalogue import Entry
from service.scene import Scene, SeriesPlan
from service.structure import Fixed, Role, Structure, read_parameters


@dataclass(frozen=True)
class Feature:
    """One thing that a shader leaves out. `changes` are fields of Structure; those of several features add up."""

    name: str
    reason: str
    changes: Mapping[str, Any] = field(hash=False)


_FIRST_BAD = Feature(
    "index of the first non-finite sample",
    "samples are drawn again to find it, where one is not finite",
    {"first_bad": False},
)
_ONCE = Feature(
    "terms of the view in every sample",
    "they are the same for every sample, and formed once",
    {"formed_once": True},
)


def structure_without(features: Iterable[Feature]) -> Structure:
    """The structure of a shader that leaves these features out and keeps everything else."""
    structure = Structure()
    for feature in features:
        changes = dict(feature.changes)
        if "fixed" in changes:
            changes["fixed"] = structure.fixed | changes["fixed"]
        structure = replace(structure, **changes)
    return structure


def features_left_out(plan: SeriesPlan, scene: Scene, method: str | None = "mc") -> tuple[Feature, ...]:
    """What the shader that answers a series of this scene by this method leaves out."""
    black = _black(plan)
    if black is not None:
        return (black,)
    if method == "quadrature":
        return structural_features(plan)
    return (*_unasked(scene), *_never_needed(scene), *structural_features(plan))


def structural_features(plan: SeriesPlan) -> tuple[Feature, ...]:
    """What no job need compute for a series: the ones that evaluate a quadrature rule leave it out as well."""
    return (
        *_of_view_and_horizon(plan),
        *_declared(plan.model, "model", plan),
        *_declared(plan.technique, "technique", plan),
    )


def error_curve_features(plan: SeriesPlan, method: str) -> tuple[Feature, ...]:
    """What the shader of an error curve leaves out: it needs mean and variance of each replicate."""
    if method == "quadrature":
        return structural_features(plan)
    reason = "an error curve is made of means and variances"
    curve = (
        Feature("third and fourth powers of the weight", reason, {"moments": 2}),
        Feature("largest weight", reason, {"largest": False}),
        Feature("count of zero weights", reason, {"zeros": False}),
        _FIRST_BAD,
        _ONCE,
    )
    return (*curve, *structural_features(plan))


def report(by_series: Sequence[Sequence[Feature]]) -> list[dict[str, Any]]:
    """The block `left_out` of a result: each feature with its reason and the numbers of the series without it."""
    found: dict[tuple[str, str], list[int]] = {}
    for number, features in enumerate(by_series):
        for feature in features:
            found.setdefault((feature.name, feature.reason), []).append(number)
    return [{"feature": name, "reason": reason, "series": series} for (name, reason), series in found.items()]


def moments_needed(scene: Scene) -> int:
    """The highest power of the weight that the asked statistics and their error bars need."""
    if "variance" in scene.statistics:
        return 4 if scene.error_bars else 2
    if "mean" in scene.statistics:
        return 2 if scene.error_bars else 1
    return 0


def _unasked(scene: Scene) -> Iterator[Feature]:
    moments = moments_needed(scene)
    if moments < 4:
        names = {
            2: "third and fourth powers of the weight",
            1: "powers of the weight above the first",
            0: "powers of the weight",
        }
        asked = " and ".join(scene.statistics)
        bars = " without error bars" if moments and not scene.error_bars else ""
        yield Feature(names[moments], f"only {asked}{bars} was asked for", {"moments": moments})
    if "max_weight" not in scene.statistics:
        yield Feature("largest weight", "max_weight was not asked for", {"largest": False})
    if "variance" not in scene.statistics:
        reason = "zero_fraction comes with the variance, which was not asked for"
        yield Feature("count of zero weights", reason, {"zeros": False})


def _never_needed(scene: Scene) -> Iterator[Feature]:
    yield _FIRST_BAD
    yield _ONCE
    if scene.techniques is not None and len(scene.techniques) > 1:
        yield Feature("the other techniques", "each technique has a module of its own", {"together": False})


def _of_view_and_horizon(plan: SeriesPlan) -> Iterator[Feature]:
    if plan.model.own or plan.technique.own:
        return
    if not plan.model.head.anisotropic:
        reason = "the model is isotropic: wo stays in the x-z plane"
        yield Feature("azimuth of the view", reason, {"azimuth": False})
    if not plan.technique.head.below_horizon:
        reason = "the technique draws nothing below the horizon"
        yield Feature("test for the horizon", reason, {"horizon": False})


def _declared(entry: Entry, role: Role, plan: SeriesPlan) -> Iterator[Feature]:
    """What the head of a file says that drops out where parameters have these values."""
    read = set(read_parameters(entry, role))
    for name, values in entry.head.left_out.items():
        if not entry.own and set(values) <= read and _has(plan, values):
            fixed = frozenset(Fixed(role, parameter, value) for parameter, value in values.items())
            yield Feature(name, _in_words(values), {"fixed": fixed})


def _black(plan: SeriesPlan) -> Feature | None:
    values = plan.model.head.black
    if not values or plan.model.own or plan.technique.own or not _has(plan, values):
        return None
    return Feature("every sample", f"{_in_words(values)}: the model reflects nothing", {"drawn": False})


def _has(plan: SeriesPlan, values: Mapping[str, float]) -> bool:
    return all(plan.parameters[name] == value for name, value in values.items())


def _in_words(values: Mapping[str, float]) -> str:
    return " and ".join(f"{name} is {value:g}" for name, value in values.items())
