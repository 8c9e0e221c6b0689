"""The catalogue: every model and technique, as their own files declare them.

A model or technique is one GLSL file whose head, a TOML block in its first comment, says what it is. Nothing about a
model or technique is written anywhere else: adding one means adding a file under shaders/.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from service import glsl
from service.errors import BadInput, Problem, ShaderFileError

SHADERS = Path(__file__).resolve().parent.parent / "shaders"

DEFAULT_MODEL = "eon"
"""The model of a question that names none."""

# fmt: off
RESERVED = frozenset({
    "model", "preset", "parameters", "zip", "techniques", "angles", "theta_o_deg", "phi_o_deg", "statistics",
    "reference", "estimator", "method", "samples", "seed", "tolerance", "error_bars", "format",
    "target_error", "replicates", "estimators", "efficiency_over",
})
# fmt: on
"""Names of a scene's fields and of query parameters, which a parameter may not have."""

OWN_FILE_BYTES = 1 << 20
_RESOURCES = frozenset({"buffer", "uniform", "shared", "layout"})

_HEAD = re.compile(r"\s*/\*---\n(.*?)\n---\*/", re.DOTALL)
_REQUIRED_FUNCTIONS = {"model": ("brdf",), "technique": ("sample_direction", "direction_pdf")}
_SIGNATURES = {
    "brdf": "float brdf(vec3 wi, vec3 wo)",
    "directional_albedo": "float directional_albedo(float mu)",
    "sample_direction": "DirectionSample sample_direction(vec3 wo, vec2 u)",
    "direction_pdf": "float direction_pdf(vec3 wo, vec3 wi)",
    "u1_split": "float u1_split(vec3 wo)",
}
_BUILT_IN = frozenset({"void", "bool", "int", "uint", "float", "double", "vec2", "vec3", "vec4", "DirectionSample"})
_KEYWORDS = _BUILT_IN | frozenset(
    re.findall(
        r"\w+",
        "const in out inout if else for while do return break continue switch case default struct discard true false "
        "precise highp mediump lowp flat smooth centroid sample patch attribute varying subroutine",
    )
)
_ALLOWED_IN_HEAD = {
    "provides": '["model"], ["technique"] or ["model", "technique"]',
    "name": "at most 64 lower case letters, digits and dashes, a letter first",
    "title": "a text",
    "source": "a text",
    "models": '"any" or a list of names of models',
    "uses": "a list of names of parameters",
    "singular": "a list of texts",
    "black": "values of parameters by name",
    "left_out": "tables of values of parameters by name",
    "min": "a number",
    "max": "a number",
    "default": "a number",
    "unit": "a text",
    "help": "a text",
}


class Parameter(BaseModel):
    """A declared number of a model or technique, with its closed range."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    min: float
    max: float
    default: float
    unit: str = ""
    help: str = ""

    @property
    def allowed(self) -> str:
        """The range in words."""
        return f"{self.min:g} to {self.max:g}" + (f" {self.unit}" if self.unit else "")


class Head(BaseModel):
    """The declaration at the top of a shader file; the fields are those of shaders/README.md."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    provides: list[Literal["model", "technique"]] = Field(min_length=1)
    name: str = Field(pattern=r"^[a-z][a-z0-9-]*$", max_length=64)
    title: str
    source: str
    models: Literal["any"] | list[str] = "any"
    uses: list[str] = []
    below_horizon: bool = False
    mixture: bool = False
    anisotropic: bool = False
    singular: list[str] = []
    black: dict[str, float] = {}
    left_out: dict[str, dict[str, float]] = {}
    parameters: dict[str, Parameter] = {}


@dataclass(frozen=True, eq=False)
class Entry:
    """One shader file: its declaration and its code. `origin` is its name in compile errors. Equal by identity."""

    head: Head
    code: str
    origin: str
    declared: frozenset[str] = field(repr=False)
    own: bool = False  # a user's file: no reference of a catalogue entry of the same name applies

    @property
    def name(self) -> str:
        """The catalogue name."""
        return self.head.name

    def made_for(self, model: str) -> bool:
        """Whether this technique declares the model; others run on explicit request."""
        return self.head.models == "any" or model in self.head.models


@dataclass(frozen=True)
class Catalogue:
    """Models and techniques by name, and the texts that `#include` reaches."""

    models: Mapping[str, Entry]
    techniques: Mapping[str, Entry]
    includes: Mapping[str, str]

    def model(self, name: str) -> Entry:
        """The model of this name; BadInput lists the names there are."""
        return _lookup(self.models, "model", name)

    def technique(self, name: str) -> Entry:
        """The technique of this name; BadInput lists the names there are."""
        return _lookup(self.techniques, "techniques", name)

    def techniques_for(self, model: str) -> list[str]:
        """Names of the techniques that declare the model, general ones first."""
        fitting = [entry for entry in self.techniques.values() if entry.made_for(model)]
        return [entry.name for entry in sorted(fitting, key=lambda entry: (entry.head.models != "any", entry.name))]

    def parameters_of(self, model: Entry, technique: Entry) -> dict[str, Parameter]:
        """Parameters of a pair: the model's, the technique's own, and those it reads of the models it is made for.

        A technique that runs, on request, on a model without a parameter it reads takes that parameter's declaration
        from a model it was made for.
        """
        found = {**model.head.parameters, **technique.head.parameters}
        made_for = [] if technique.head.models == "any" else technique.head.models
        for name in technique.head.uses:
            if name not in found:
                known = [self.models[m] for m in made_for if m in self.models]
                owners = [model for model in known if name in model.head.parameters]
                if not owners:
                    raise ShaderFileError(f"{technique.origin}: uses {name!r}, which {model.name} does not declare")
                found[name] = owners[0].head.parameters[name]
        return found

    def file_of(self, origin: str) -> Entry:
        """The entry of a user's file that `with_text` has added under this origin."""
        return next(e for e in (*self.models.values(), *self.techniques.values()) if e.own and e.origin == origin)

    def with_file(self, path: Path) -> Catalogue:
        """This catalogue and one more file, which may replace an entry of the same name.

        Raises as `own_text` and `own_entry` do.
        """
        return self.with_text(own_text(path), str(path))

    def with_text(self, text: str, origin: str) -> Catalogue:
        """This catalogue and the file of this text; `origin` is how errors call it. It may take the place of an entry
        of the same name, but ShaderFileError where that is another file of the user's.
        """
        entry = own_entry(text, origin)
        for role in entry.head.provides:
            other = (self.models if role == "model" else self.techniques).get(entry.name)
            if other is not None and other.own:
                raise ShaderFileError(f"{origin}: head: name = {entry.name}: so is the {role} of {other.origin} called")
        return Catalogue(
            models={**self.models, **_provided([entry], "model")},
            techniques={**self.techniques, **_provided([entry], "technique")},
            includes=self.includes,
        )


def is_file(given: str) -> bool:
    """Whether a text means a user's shader file: a path, or a name with a dot, which no entry of the catalogue has."""
    return "." in given or "/" in given


def own_text(path: Path) -> str:
    """The text of a user's file. BadInput where it cannot be read."""
    try:
        if path.stat().st_size > OWN_FILE_BYTES:
            raise BadInput(Problem("file", str(path), f"at most {OWN_FILE_BYTES:,} bytes"))
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise BadInput(Problem("file", str(path), f"a shader file that can be read ({reason})")) from None


def own_entry(text: str, origin: str) -> Entry:
    """The entry of a user's file. ShaderFileError where it breaks the contract."""
    text = text.removeprefix("\ufeff").replace("\r\n", "\n")
    entry = replace(read_entry(text, origin), own=True)
    _check_signatures(text, origin)
    for line, word in glsl.words(text):
        if word in _RESOURCES:
            raise ShaderFileError(
                f"{origin}:{line}: {word}: a model or technique has no buffers, layouts or shared memory"
            )
    return entry


@cache
def hemisphere() -> Entry:
    """Directions as a technique that covers the hemisphere smoothly: its mean weight is a model's albedo."""
    return read_entry((SHADERS / "hemisphere.glsl").read_text(encoding="utf-8"), "hemisphere.glsl")


@cache
def load_catalogue(folder: Path = SHADERS) -> Catalogue:
    """Read the shader folder. ShaderFileError names the file that breaks the contract."""
    entries = [
        read_entry(path.read_text(encoding="utf-8"), str(path.relative_to(folder)))
        for kind in ("models", "techniques")
        for path in sorted((folder / kind).glob("*.glsl"))
    ]
    includes = {f"common/{path.name}": path.read_text(encoding="utf-8") for path in (folder / "common").glob("*.glsl")}
    return Catalogue(_provided(entries, "model"), _provided(entries, "technique"), includes)


def read_entry(text: str, origin: str) -> Entry:
    """Parse one shader file; `origin` is how errors call it."""
    head = _read_head(text, origin)
    declared = frozenset(glsl.declared_names(text))
    _check_parameters(head, origin)
    _check_values(head, origin)
    for role in head.provides:
        for function in _REQUIRED_FUNCTIONS[role]:
            if function not in declared:
                raise ShaderFileError(f"{origin}: a {role} must define the function {_SIGNATURES[function]}")
    return Entry(head, text, origin, declared)


def _read_head(text: str, origin: str) -> Head:
    match = _HEAD.match(text)
    if match is None and text.lstrip().startswith("/*---"):
        raise ShaderFileError(f"{origin}:1: the head must begin with a line /*--- and end with a line ---*/")
    if match is None:
        raise ShaderFileError(
            f"{origin}:1: the file must begin with a head: a comment /*--- TOML ---*/, see shaders/README.md"
        )
    try:
        return Head.model_validate(tomllib.loads(match.group(1)))
    except tomllib.TOMLDecodeError as error:
        message, _, place = str(error).partition(" (at line ")
        line = text.count("\n", 0, match.start(1)) + int(place.partition(",")[0] if place[:1].isdecimal() else 1)
        raise ShaderFileError(f"{origin}:{line}: the head is not TOML: {message}") from None
    except ValidationError as error:
        raise ShaderFileError(f"{origin}: head: {_head_problem(error)}") from None


def _head_problem(error: ValidationError) -> Problem:
    """The first wrong field of a head, and what it allows."""
    first = error.errors()[0]
    place = [str(part) for part in first["loc"] if not re.search(r"[\[\]]", str(part))]
    place = place if first["type"] == "missing" or not place[-1].isdecimal() else place[:-1]
    allowed = _ALLOWED_IN_HEAD.get(place[0] if place[0] != "parameters" else place[-1], first["msg"])
    if first["type"] == "missing":
        return Problem(".".join(place), None, f"{allowed}; it is required")
    if first["type"] == "extra_forbidden":
        fields = Parameter.model_fields if place[0] == "parameters" else Head.model_fields
        allowed = f"no field of this name; there are {', '.join(fields)}"
    return Problem(".".join(place), first["input"], allowed)


def _check_signatures(text: str, origin: str) -> None:
    """The functions that the jobs call are as they call them. Types of the file's own making are for the compiler."""
    for function, wanted in _SIGNATURES.items():
        found = glsl.signatures(text, function)
        ((_, types),) = glsl.signatures(wanted, function)
        plain = all(_BUILT_IN.issuperset(has) for _, has in found)
        if found and plain and types not in (has for _, has in found):
            raise ShaderFileError(f"{origin}:{found[0][0]}: {function}: must be {wanted}")


def _check_parameters(head: Head, origin: str) -> None:
    for name, parameter in head.parameters.items():
        if name in RESERVED | _KEYWORDS or not re.fullmatch(r"[a-z][a-z0-9_]*", name):
            raise ShaderFileError(f"{origin}: head: a parameter may not be called {name!r}")
        values = (parameter.min, parameter.default, parameter.max)
        if not (all(map(math.isfinite, values)) and parameter.min <= parameter.default <= parameter.max):
            raise ShaderFileError(f"{origin}: head: parameters.{name}: must have min <= default <= max")


def _check_values(head: Head, origin: str) -> None:
    """What drops out at given values names parameters that the file reads, with values in range."""
    for field_name, values in [("black", head.black), *((f"left_out.{name}", v) for name, v in head.left_out.items())]:
        for name, value in values.items():
            own = head.parameters.get(name)
            if own is None and (name not in head.uses or field_name == "black"):
                raise ShaderFileError(f"{origin}: head: {field_name}: {name!r} is no parameter of this file")
            if not (math.isfinite(value) if own is None else own.min <= value <= own.max):
                raise ShaderFileError(f"{origin}: head: {field_name}: {name} = {value:g} is out of its range")
        if not values and field_name != "black":
            raise ShaderFileError(f"{origin}: head: {field_name}: must name a parameter and its value")


def _provided(entries: Iterable[Entry], role: Literal["model", "technique"]) -> dict[str, Entry]:
    return {entry.name: entry for entry in entries if role in entry.head.provides}


def _lookup(entries: Mapping[str, Entry], field_name: str, name: str) -> Entry:
    try:
        return entries[name]
    except KeyError:
        raise BadInput(Problem(field_name, name, "one of " + ", ".join(sorted(entries)))) from None
