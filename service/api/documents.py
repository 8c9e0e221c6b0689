"""Parts of the OpenAPI document: names, ranges, units and meanings come from the catalogue, so a new shader file shows
up here by itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from http import HTTPStatus
from typing import Any

from pydantic import BaseModel

from service.api import problems as problem_details
from service.catalogue import Catalogue, Parameter, load_catalogue
from service.formats import FORMATS, formats_of
from service.presets import preset_names
from service.scene import ALL_MODELS, MAX_ANGLES, Estimator, Scene
from service.worker.kinds import KINDS, ROUTED, Kind

Part = dict[str, Any]
Responses = dict[int | str, Part]

EXAMPLE_SCENE: Part = {
    "model": "eon",
    "parameters": {"roughness": [0.5, 1.0]},
    "techniques": ["cosine", "cltc-mis"],
    "theta_o_deg": {"count": 16},
    "estimator": {"samples": 20000, "seed": 3},
}
_EXAMPLE_QUERY = {
    "model": "eon",
    "roughness": "0.5,1",
    "techniques": "cosine,cltc-mis",
    "angles": 16,
    "samples": 20000,
    "seed": 3,
}
EXAMPLE_FILE = """/*---
provides = ["model"]
name = "matte"
title = "A model of one's own"
source = "Lambert's cosine law"
[parameters.tint]
min = 0.0
max = 1.0
default = 0.8
unit = ""
help = "reflected fraction of the light"
---*/
float brdf(vec3 wi, vec3 wo) { return tint * INV_PI; }
"""
_RETRY = {"Retry-After": {"description": "Seconds to wait.", "schema": {"type": "integer"}}}
_TAG = {"ETag": {"description": "A hash of the bytes.", "schema": {"type": "string"}}}

NOT_MODIFIED: Part = {"description": "The client has these bytes.", "headers": _TAG}
EVENTS: Part = {
    "description": "Events `progress`, `partial` (a series that plots) and at last the state of the job.",
    "content": {"text/event-stream": {"schema": {"type": "string"}}},
}
ANSWER_HEADERS: list[Part] = [
    {
        "name": "If-None-Match",
        "in": "header",
        "description": "The ETag of an answer that the client has.",
        "schema": {"type": "string"},
    },
    {
        "name": "Prefer",
        "in": "header",
        "description": "`respond-async` makes any question that is not answered yet a job.",
        "schema": {"type": "string", "enum": ["respond-async"]},
    },
]


def reference_to(name: str) -> Part:
    """A reference to a schema of `service.api.schemas`, or to Scene."""
    return {"$ref": f"#/components/schemas/{name}"}


def answers(schema: str, *statuses: int) -> Responses:
    """A response 200 of JSON, and problems."""
    return {200: json_content(schema), **problems(*statuses)}


def json_content(schema: str, description: str = "") -> Part:
    """A response of JSON."""
    content = {"application/json": {"schema": reference_to(schema)}}
    return {"description": description or schema, "content": content}


def problems(*statuses: int) -> Responses:
    """Responses that are problems."""
    content = {problem_details.MEDIA_TYPE: {"schema": reference_to("Problem")}}
    return {
        status: {
            "description": HTTPStatus(status).phrase,
            "content": content,
            **({"headers": _RETRY} if status in (429, 503) else {}),
        }
        for status in statuses
    }


BODY_RESPONSES: Responses = problems(400, 408, 413, 415)
JOB_ACCEPTED: Part = {
    **json_content("Job", "The question became a job"),
    "headers": {
        "Location": {"description": "The job.", "schema": {"type": "string"}},
        **_RETRY,
    },
}


def _contents(kind: str) -> Part:
    schema = {"statistics": "StatisticsResult", "explain": "ExplainResult"}.get(kind, "AnyResult")
    contents: Part = {}
    for name in formats_of(kind):
        entry = FORMATS[name]
        plain: Part = {"type": "string", "format": "binary"} if entry.binary else {"type": "string"}
        contents[entry.media_type] = {
            "schema": reference_to(schema) if name == "json" else {"type": "object"} if name == "vega" else plain
        }
    return contents


def answer_responses(kind: str) -> Responses:
    """Responses to a question."""
    answer = {"description": "The result", "content": _contents(kind), "headers": _TAG}
    return {200: answer, 202: JOB_ACCEPTED, 304: NOT_MODIFIED, **problems(406, 422, 429, 500, 503)}


def figure_responses() -> Responses:
    """Responses to a request for a figure."""
    return {**result_responses(), 202: JOB_ACCEPTED, **problems(404)}


def result_responses() -> Responses:
    """Responses to a request for a result of any kind."""
    contents = {name: content for kind in KINDS for name, content in _contents(kind).items()}
    contents["application/json"] = {"schema": reference_to("AnyResult")}
    answer = {"description": "The result", "content": contents, "headers": _TAG}
    return {200: answer, 304: NOT_MODIFIED, **problems(406, 422, 429, 500, 503)}


def page_responses(*media_types: str) -> Responses:
    """Responses to a request for a file of the page."""
    content = {name: {"schema": {"type": "string"}} for name in media_types}
    return {200: {"description": "The file", "content": content, "headers": _TAG}, 304: NOT_MODIFIED}


def own_responses(kind: str) -> Responses:
    """Responses to a question about a file of one's own."""
    return {status: part for status, part in answer_responses(kind).items() if status != 202} | problems(403)


def format_parameter(kind: str = "statistics") -> Part:
    """`?format=`"""
    return _query(
        "format",
        "The format, in place of what `Accept` asks for.",
        {"type": "string", "enum": formats_of(kind)},
    )


def limit_parameter(most: int) -> Part:
    """`?limit=` of a list."""
    return _query("limit", "How many.", {"type": "integer", "minimum": 1, "maximum": most, "default": most})


def _query(name: str, description: str, schema: Part, **more: Any) -> Part:
    part: Part = {"name": name, "in": "query", "description": description, "schema": schema, **more}
    if name in _EXAMPLE_QUERY and "example" not in part:
        part["example"] = _EXAMPLE_QUERY[name]
    return part


def _names(title: str, names: Iterable[str], **more: Any) -> Part:
    items = {"type": "string", "enum": list(names)}
    schema = {"type": "array", "items": items, "minItems": 1, "uniqueItems": True}
    part = _query(title, more.pop("description"), schema, style="form", explode=False)
    if "example" in part:
        part["example"] = str(part["example"]).split(",")
    return part


def query_parameters(catalogue: Catalogue, kind: Kind) -> list[Part]:
    """Parameters of a question that fits in a link."""
    scene, estimator = kind.scene.model_json_schema(), Estimator.model_json_schema()
    found = [
        _query("model", "The BRDF. Needed unless there is a `preset`.", _model_schema(kind, catalogue)),
        _query("preset", "A material of a paper, in the place of a model.", {"type": "string", "enum": preset_names()}),
        _names("techniques", sorted(catalogue.techniques), description="Default: all that are made for the model."),
        *_view_parameters(),
        _query(
            "zip",
            "Names of parameters whose lists run together, as `kd,ks`; once for each group.",
            {"type": "array", "items": {"type": "string"}, "minItems": 1},
        ),
        _names(
            "statistics",
            scene["properties"]["statistics"]["items"]["enum"],
            description="What to compute. Default: all.",
        ),
        *(
            _query(name, schema.get("description", "Of the estimator."), _bare(schema))
            for name, schema in estimator["properties"].items()
            if "$ref" not in str(schema)
        ),
        *(
            _query(name, text, {"type": "boolean", "default": True})
            for name, text in (("error_bars", "Standard errors."), ("reference", "The float64 reference."))
        ),
        *(
            _query(name, _meaning(parameter), _values(parameter), style="form", explode=False, **_example(name))
            for name, parameter in _all_parameters(catalogue).items()
        ),
        *(
            _list(name, _bare(scene["properties"][name]))
            for name in kind.scene.model_fields.keys() - Scene.model_fields.keys()
        ),
        format_parameter(kind.name),
    ]
    return [*found, *ANSWER_HEADERS]


def _view_parameters() -> list[Part]:
    return [
        _query(
            "angles",
            "So many view angles, from 0 to 89.91 degrees.",
            {"type": "integer", "minimum": 1, "maximum": MAX_ANGLES},
        ),
        _query(
            "theta_o_deg",
            "View angles in degrees, in place of `angles`, as `0,45,89.9`.",
            {"type": "array", "items": {"type": "number", "minimum": 0, "exclusiveMaximum": 90}, "minItems": 1},
            style="form",
            explode=False,
        ),
        _query(
            "phi_o_deg",
            "View azimuths of an anisotropic model, in degrees: one series each. Default: 0.",
            {"type": "array", "items": {"type": "number", "minimum": -360, "maximum": 360}, "minItems": 1},
            style="form",
            explode=False,
        ),
    ]


def _model_schema(kind: Kind, catalogue: Catalogue) -> Part:
    """A name of a model, or `all` for kinds that take every model at once."""
    every = [] if kind.name == "convergence" else [ALL_MODELS]
    return {"type": "string", "enum": [*sorted(catalogue.models), *every]}


def _list(name: str, schema: Part) -> Part:
    """A field of a scene in a query; a list is separated by commas."""
    more: Part = {"style": "form", "explode": False} if schema.get("type") == "array" else {}
    return _query(name, "Of a scene of this kind.", schema, **more)


def _bare(schema: Part) -> Part:
    return {name: value for name, value in schema.items() if name not in ("title", "description")}


def _example(name: str) -> Part:
    text = _EXAMPLE_QUERY.get(name)
    return {} if text is None else {"example": [float(value) for value in str(text).split(",")]}


def _all_parameters(catalogue: Catalogue) -> dict[str, Parameter]:
    """Every declared parameter; where entries differ in its range, the widest."""
    found: dict[str, Parameter] = {}
    for entry in (*catalogue.models.values(), *catalogue.techniques.values()):
        for name, parameter in entry.head.parameters.items():
            known = found.get(name, parameter)
            widest = {"min": min(known.min, parameter.min), "max": max(known.max, parameter.max)}
            found[name] = known.model_copy(update=widest)
    return found


def _meaning(parameter: Parameter) -> str:
    unit = f" ({parameter.unit})" if parameter.unit else ""
    return f"{parameter.help or 'A parameter'}{unit}; several values sweep it. Default: {parameter.default:g}."


def _values(parameter: Parameter) -> Part:
    """One value or several of a parameter."""
    items = {"type": "number", "minimum": parameter.min, "maximum": parameter.max}
    schema: Part = {"type": "array", "items": items, "minItems": 1, "default": [parameter.default]}
    return schema | ({"x-unit": parameter.unit} if parameter.unit else {})


def figure_parameters() -> list[Part]:
    """Parameters of a figure."""
    estimator = Estimator.model_json_schema()["properties"]
    return [
        _query("samples", "Samples for each angle, in place of the figure's own number.", _bare(estimator["samples"])),
        _query("seed", "Seed of the random numbers.", _bare(estimator["seed"])),
        format_parameter(),
        *ANSWER_HEADERS,
    ]


def scene_schema(kind: Kind, catalogue: Catalogue | None = None) -> Part:
    """The schema of a scene, with the catalogue's names as enums and its parameters with their ranges."""
    catalogue = catalogue or load_catalogue()
    schema = kind.scene.model_json_schema(ref_template="#/components/schemas/{model}")
    schema.pop("$defs", None)
    fields = schema["properties"]
    fields["model"] = {**_model_schema(kind, catalogue), "description": "The BRDF."}
    names = {"type": "string", "enum": sorted(catalogue.techniques)}
    fields["techniques"] = {
        "type": "array",
        "items": names,
        "minItems": 1,
        "uniqueItems": True,
        "description": "Default: all that are made for the model.",
    }
    fields["parameters"] = {
        "type": "object",
        "additionalProperties": False,
        "description": "Values by name: a number, or several that sweep the parameter.",
        "properties": {
            name: {
                "description": _meaning(parameter),
                "anyOf": [_values(parameter)["items"], {**_values(parameter)}],
                **({"x-unit": parameter.unit} if parameter.unit else {}),
            }
            for name, parameter in _all_parameters(catalogue).items()
        },
    }
    schema["examples"] = [EXAMPLE_SCENE]
    return schema


def scene_body(kind: Kind) -> Part:
    """The body of a question."""
    content = {"application/json": {"schema": reference_to(kind.scene.__name__), "example": EXAMPLE_SCENE}}
    return {"required": True, "content": content}


def own_body(model: type[BaseModel]) -> Part:
    """A body that carries shader text; the scene of the example fits every task that takes one."""
    example: Part = {"glsl": EXAMPLE_FILE}
    if "scene" in model.model_fields:
        example["scene"] = {"techniques": ["cosine"], "theta_o_deg": [0, 60], "estimator": {"samples": 20000}}
    return {
        "required": True,
        "content": {"application/json": {"schema": reference_to(model.__name__), "example": example}},
    }


def job_body() -> Part:
    """The body that starts a job."""
    schema = {
        "type": "object",
        "required": ["scene"],
        "additionalProperties": False,
        "properties": {
            "kind": {"type": "string", "enum": [kind.name for kind in ROUTED], "default": "statistics"},
            "scene": {"anyOf": [reference_to(kind.scene.__name__) for kind in ROUTED]},
        },
    }
    example = {"kind": "statistics", "scene": EXAMPLE_SCENE}
    return {"required": True, "content": {"application/json": {"schema": schema, "example": example}}}


def components() -> dict[str, Part]:
    """Schemas that the document refers to, beyond those that FastAPI finds."""
    from pydantic.json_schema import models_json_schema

    from service.api import schemas
    from service.scene import AngleCount

    wanted = [(model, "serialization") for model in (*schemas.MODELS, schemas.Job)]
    wanted += [(model, "validation") for model in (AngleCount, Estimator)]
    _, definitions = models_json_schema(wanted, ref_template="#/components/schemas/{model}")  # type: ignore[arg-type]
    known: dict[str, Part] = definitions["$defs"]
    return known | {kind.scene.__name__: scene_schema(kind) for kind in ROUTED}
