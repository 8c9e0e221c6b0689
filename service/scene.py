"""The scene: one question, checked, and the cells it consists of.

A scene comes as JSON, as query parameters or as command-line options; all three end here. What is wrong with it is
reported for every field at once, with the value given and what is allowed.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    FailFast,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)

from service.catalogue import Catalogue, Entry, Parameter
from service.errors import BadInput, Problem, allowed_in_words

Statistic = Literal["mean", "variance", "max_weight"]
STATISTICS: tuple[Statistic, ...] = ("mean", "variance", "max_weight")
Method = Literal["mc", "qmc", "quadrature"]
METHODS: tuple[Method, ...] = ("mc", "qmc", "quadrature")

ALL_MODELS = "all"
"""In the place of a model's name: every model of the catalogue."""

MAX_ANGLES = 4096
MAX_SAMPLES = 2**40
MAX_CELLS = 2**20
MAX_NAMES = 256  # in a list of names
MIN_TOLERANCE = 1e-6  # weights are float32
GRAZING_COUNT_END_DEG = 90 * 0.999  # --angles N ends here, as the figures of the EON paper do


def _as_list(value: object) -> object:
    return list(value) if isinstance(value, tuple) else value if isinstance(value, list) else [value]


Sweep = Annotated[list[float], FailFast(), Field(min_length=1, max_length=MAX_CELLS), BeforeValidator(_as_list)]
Angle = Annotated[float, Field(ge=0, lt=90, allow_inf_nan=False)]
Azimuth = Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]
Azimuths = Annotated[list[Azimuth], Field(min_length=1, max_length=MAX_ANGLES), BeforeValidator(_as_list)]
_Group = Annotated[list[str], FailFast(), Field(min_length=2, max_length=MAX_NAMES)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class AngleCount(_Strict):
    """N angles from 0 to 89.91 degrees."""

    count: int = Field(ge=1, le=MAX_ANGLES)


class Estimator(_Strict):
    """How statistics are computed. With a tolerance and no method, the method is chosen; without either it is mc."""

    method: Method | None = None
    samples: int = Field(1_000_000, ge=1, le=MAX_SAMPLES)
    seed: int = Field(0, ge=0, lt=2**63)
    tolerance: float | None = Field(None, ge=MIN_TOLERANCE, le=1, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _default_method(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and data.get("method") is None and data.get("tolerance") is None:
            return {**data, "method": "mc"}
        return data


class Scene(_Strict):
    """One question. Every field but `model` has a default; `techniques` defaults to all that declare the model.

    `model` may be `all`: then every model of the catalogue is asked. `phi_o_deg` is there only for anisotropic models.
    """

    model: str
    parameters: dict[str, Sweep] = {}
    zip: Annotated[list[_Group], Field(max_length=MAX_NAMES)] = []
    techniques: Annotated[list[str], Field(min_length=1, max_length=MAX_NAMES), BeforeValidator(_as_list)] | None = None
    theta_o_deg: AngleCount | Annotated[list[Angle], Field(min_length=1, max_length=MAX_ANGLES)] = AngleCount(count=64)
    phi_o_deg: Azimuths | None = None
    statistics: Annotated[list[Statistic], Field(min_length=1, max_length=MAX_NAMES), BeforeValidator(_as_list)] = list(
        STATISTICS
    )
    estimator: Estimator = Estimator(method="mc")
    error_bars: bool = True
    reference: bool = True

    @model_serializer(mode="wrap")
    def _without_absent_azimuth(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data: dict[str, Any] = serialize(self)
        if data.get("phi_o_deg") is None:
            data.pop("phi_o_deg", None)
        return data

    @property
    def angles_deg(self) -> list[float]:
        """View angles in degrees. A count N means the paper's grid, 90 k 0.999/(N - 1)."""
        if isinstance(self.theta_o_deg, list):
            return self.theta_o_deg
        count = self.theta_o_deg.count
        return [GRAZING_COUNT_END_DEG * k / (count - 1) for k in range(count)] if count > 1 else [0.0]


@dataclass(frozen=True)
class SeriesPlan:
    """One curve of the answer: a model with fixed parameters and a technique, over all view angles.

    `phi_o_deg` is the azimuth of the view; None for an isotropic model, which is looked at from azimuth 0.
    """

    model: Entry
    technique: Entry
    parameters: Mapping[str, float]
    phi_o_deg: float | None = None

    @property
    def azimuth_deg(self) -> float:
        """The azimuth of the view in degrees."""
        return self.phi_o_deg or 0.0


@dataclass(frozen=True)
class Question:
    """A scene checked against the catalogue: what exactly has to be computed."""

    scene: Scene
    series: tuple[SeriesPlan, ...]


def parse_scene(data: Mapping[str, Any]) -> Scene:
    """Check the form of a scene. BadInput names every wrong field."""
    try:
        return Scene.model_validate(data)
    except ValidationError as error:
        raise BadInput(scene_problems(error)) from None


def resolve(scene: Scene, catalogue: Catalogue) -> Question:
    """Check a scene against the catalogue: names exist, parameters are declared and in range."""
    every = scene.model == ALL_MODELS
    models = list(catalogue.models.values()) if every else [catalogue.model(scene.model)]
    if scene.techniques is not None and len(set(scene.techniques)) < len(scene.techniques):
        raise BadInput(Problem("techniques", ",".join(scene.techniques), "each name once"))
    pairs = [
        (model, catalogue.technique(name))
        for model in models
        for name in (catalogue.techniques_for(model.name) if scene.techniques is None else scene.techniques)
    ]
    declared = [catalogue.parameters_of(*pair) for pair in pairs]
    _check_parameters(scene, {name: p for ps in declared for name, p in ps.items()})
    azimuths = _azimuths(scene, models)
    series = tuple(
        SeriesPlan(model, technique, values, phi_o_deg)
        for (model, technique), parameters in zip(pairs, declared, strict=True)
        for values in _combinations(scene, parameters)
        for phi_o_deg in (azimuths if model.head.anisotropic else [None])
    )
    if len(series) * len(scene.angles_deg) > MAX_CELLS:
        raise BadInput(Problem("parameters", f"{len(series)} series", f"at most {MAX_CELLS} cells (series x angles)"))
    names = scene.techniques if every else [technique.name for _, technique in pairs]
    anisotropic = any(model.head.anisotropic for model in models)
    full = scene.model_copy(update={"techniques": names, "phi_o_deg": azimuths if anisotropic else None})
    return Question(full, series)


def _azimuths(scene: Scene, models: Sequence[Entry]) -> list[float]:
    """View azimuths in degrees; 0 unless given, and given only for models where they matter."""
    if scene.phi_o_deg is None:
        return [0.0]
    if not any(model.head.anisotropic for model in models):
        raise BadInput(Problem("phi_o_deg", _one_or_list(scene.phi_o_deg), f"no value, {scene.model} is isotropic"))
    return scene.phi_o_deg


def _check_parameters(scene: Scene, declared: Mapping[str, Parameter]) -> None:
    problems = []
    for name, values in scene.parameters.items():
        field = f"parameters.{name}"
        if name not in declared:
            names = ", ".join(sorted(declared)) or "none"
            problems.append(Problem(field, _one_or_list(values), f"a parameter of {scene.model}: {names}"))
            continue
        parameter = declared[name]
        bad = [value for value in values if not parameter.min <= value <= parameter.max]
        if bad:
            problems.append(Problem(field, _one_or_list(bad), parameter.allowed))
    seen: set[str] = set()
    for group in scene.zip:
        lengths = {name: len(scene.parameters.get(name, [])) for name in group}
        if len(set(lengths.values())) > 1 or 0 in lengths.values() or seen & set(group):
            problems.append(Problem("zip", ",".join(group), "swept parameters with lists of equal length, each once"))
        seen |= set(group)
    if problems:
        raise BadInput(problems)


def _combinations(scene: Scene, declared: Mapping[str, Parameter]) -> Iterator[dict[str, float]]:
    """Parameter values of every series: the product of the sweeps, the last name fastest, zipped names together."""
    axes: list[list[dict[str, float]]] = []
    done: set[str] = set()
    for name in scene.parameters:
        if name in done or name not in declared:
            continue
        group = next((group for group in scene.zip if name in group), [name])
        rows = zip(*(scene.parameters[member] for member in group), strict=True)
        axes.append([dict(zip(group, row, strict=True)) for row in rows])
        done.update(group)
    defaults = {name: parameter.default for name, parameter in declared.items()}
    for choice in itertools.product(*axes):
        values = dict(defaults)
        for part in choice:
            values.update(part)
        yield values


def _one_or_list(values: list[float]) -> object:
    return values[0] if len(values) == 1 else values


def scene_problems(error: ValidationError) -> list[Problem]:
    """Pydantic's findings as fields, values and ranges. A union reports every branch; the most telling one is kept."""
    found: dict[tuple[str, ...], Problem] = {}
    above: set[tuple[str, ...]] = set()
    for item in error.errors(include_url=False):
        path = _path(item["loc"])
        if path in found or path in above:
            continue
        for length in range(len(path)):
            found.pop(path[:length], None)
            above.add(path[:length])
        field = ".".join(path) or "scene"
        found[path] = Problem(field, item["input"], _allowed(field, item["type"], item.get("ctx", {}), item["msg"]))
    return list(found.values())


def _path(place: Sequence[int | str]) -> tuple[str, ...]:
    """The path of an error, without the step that only names a branch of the union that `theta_o_deg` is."""
    steps = [str(step) for step in place]
    if steps[:1] == ["theta_o_deg"]:
        del steps[1:2]
    return tuple(steps)


_ALLOWED = {
    "model": "the name of a model",
    "techniques": "a list of names of techniques",
    "theta_o_deg": f'0 <= theta_o_deg < 90, as a list of 1 to {MAX_ANGLES} angles or as {{"count": N}}',
    "phi_o_deg": "-360 to 360, one or a list",
    "theta_o_deg.count": f"a whole number, 1 to {MAX_ANGLES}",
    "statistics": "a list out of " + ", ".join(STATISTICS),
    "estimator.samples": f"a whole number, 1 to {MAX_SAMPLES}",
    "estimator.seed": "a whole number, 0 to 2^63 - 1",
    "estimator.tolerance": f"a number, {MIN_TOLERANCE:g} to 1",
    "target_error": "a number above 0 and below 1",
    "replicates": "a whole number, 32 to 1024",
    "estimators": "a list out of mc, qmc, quadrature",
    "efficiency_over": "a list of names of parameters",
    "parameters": "a number or a list of numbers for each name",
    "zip": "lists of two or more names of swept parameters",
}


def _allowed(field: str, kind: str, context: Mapping[str, Any], message: str) -> str:
    """What a field allows, in words: those of the table where it knows the field, else pydantic's."""
    match kind:
        case "extra_forbidden":
            return "no field of this name"
        case "missing":
            return "a value, it is required"
        case "literal_error":
            return str(context["expected"]).replace("'", "")
    named = re.sub(r"\.\d+", "", field)
    known = _ALLOWED.get(named) or _ALLOWED.get(named.partition(".")[0])
    return known or allowed_in_words(message)
