"""The shaders that are compared: the variant of a series, and the one that keeps everything, or all but one feature."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lavapipe import compile_glsl, read_module, specialized
from service.catalogue import Entry
from service.engine import Engine
from service.left_out import Feature, features_left_out, structure_without
from service.sampling import Cells
from service.scene import Question, Scene, SeriesPlan
from service.statistics import series_cells
from service.structure import Constants
from service.variant import compose

CELLS = 16
"""View angles that a launch covers, spread over those of the scene."""


@dataclass(frozen=True)
class Group:
    """Series that have one variant: their numbers, and the plan of the first, which stands for all."""

    plan: SeriesPlan
    features: tuple[Feature, ...]
    series: list[int]


@dataclass(frozen=True)
class Shader:
    """A module with its specialization, and what it draws for."""

    name: str
    spirv: bytes
    constants: Constants
    cells: Cells


@dataclass(frozen=True)
class Size:
    """How large a shader is, after specialization where spirv-opt is installed and else before it.

    module_bytes: its module as it is kept, before specialization, which other shaders may share.
    """

    module_bytes: int
    spirv_bytes: int
    instructions: int
    specialized: bool


def groups_of(question: Question) -> list[Group]:
    """The series of a question by the variants that answer them."""
    found: dict[tuple[object, ...], Group] = {}
    for number, plan in enumerate(question.series):
        features = features_left_out(plan, question.scene)
        key = (plan.model, plan.technique, tuple(feature.name for feature in features))
        found.setdefault(key, Group(plan, features, [])).series.append(number)
    return list(found.values())


def shader_without(engine: Engine, question: Question, plan: SeriesPlan, features: Iterable[Feature]) -> Shader:
    """The shader of a series that leaves these features out; without any it holds all techniques of the scene."""
    structure = structure_without(features)
    techniques = _together(question, plan) if structure.together else [plan.technique]
    variant = compose(engine.catalogue, plan.model, techniques, "statistics")
    spirv = compile_glsl(variant.source, name=variant.name, include=variant.includes, cache=engine.cache)
    chosen = techniques.index(plan.technique)
    sobol = question.scene.estimator.method == "qmc"
    constants = structure.statistics_constants(plan.model, techniques, chosen, sobol=sobol)
    cells = _cells(engine, plan, question.scene, techniques, variant.parameters)
    return Shader(variant.name, spirv, constants, cells)


def whole_shader(engine: Engine, question: Question, plan: SeriesPlan) -> Shader:
    """The shader that keeps everything."""
    return shader_without(engine, question, plan, ())


def size_of(engine: Engine, shader: Shader) -> Size:
    """What the driver has to compile of a shader."""
    smaller = specialized(shader.spirv, shader.constants, engine.cache)
    module = smaller or shader.spirv
    return Size(len(shader.spirv), len(module), read_module(module).instructions, smaller is not None)


def _together(question: Question, plan: SeriesPlan) -> list[Entry]:
    """The techniques of the scene that its series of this model have."""
    return list({one.technique: None for one in question.series if one.model is plan.model})


def _cells(engine: Engine, plan: SeriesPlan, scene: Scene, techniques: Sequence[Entry], names: Sequence[str]) -> Cells:
    """Some cells of a series, with the parameters of every technique of the shader."""
    count = len(scene.angles_deg)
    chosen = np.unique(np.linspace(0, count - 1, min(count, CELLS)).round().astype(int))
    some = scene.model_copy(update={"theta_o_deg": [scene.angles_deg[i] for i in chosen]})
    values = {
        name: parameter.default
        for technique in techniques
        for name, parameter in engine.catalogue.parameters_of(plan.model, technique).items()
    } | dict(plan.parameters)
    return series_cells(replace(plan, parameters={name: values[name] for name in names}), some)
