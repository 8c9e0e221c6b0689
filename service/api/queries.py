"""From a request to a scene: query parameters or a JSON body, as plain data that `parse_scene` checks."""

from __future__ import annotations

import asyncio
import json
import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from starlette.datastructures import QueryParams
from starlette.requests import ClientDisconnect, Request

from service.api.problems import ClientGone, HttpError
from service.catalogue import Catalogue
from service.errors import BadInput, Problem
from service.formats import FORMATS
from service.presets import with_preset
from service.scene import Estimator, Scene, parse_scene, resolve
from service.worker.kinds import Kind

_LISTS = frozenset({"techniques", "statistics", "theta_o_deg", "phi_o_deg", "estimators", "efficiency_over"})
_NOT_IN_QUERY = frozenset({"parameters", "estimator"})
_IN_CATALOGUE = ("model", "techniques", "parameters", "zip")
_QUICK_SERIES = 1000
_QUICK_BYTES = 1 << 16
_MAX_MEMBERS = 1000
"""Most members of one JSON object: a wrong name is told one by one."""


def parameter_names(catalogue: Catalogue) -> list[str]:
    """Names of the parameters that any model or technique declares."""
    entries = [*catalogue.models.values(), *catalogue.techniques.values()]
    return list(dict.fromkeys(name for entry in entries for name in entry.head.parameters))


def scene_of_query(query: QueryParams, kind: Kind, catalogue: Catalogue, parameters: Collection[str]) -> Scene:
    """The scene of a query string; every field is named as in a scene, a parameter by its own name.

    Raises BadInput with all that is wrong.
    """
    data: dict[str, Any] = {"parameters": {}, "estimator": {}}
    problems: list[Problem] = []
    preset: str | None = None
    given: dict[str, list[str]] = {}
    for name, value in query.multi_items():
        given.setdefault(name, []).append(value)
    for name, values in given.items():
        split = [part.strip() for value in values for part in value.split(",")]
        if name in parameters:
            data["parameters"][name] = split
        elif name == "zip":
            data[name] = [value.split(",") for value in values]
        elif name in _LISTS & kind.scene.model_fields.keys():
            data[name] = split
        elif len(values) > 1:
            problems.append(Problem(name, ", ".join(values), "given once"))
        elif name == "format":
            if values[0] not in FORMATS:
                problems.append(Problem(name, values[0], "one of " + ", ".join(FORMATS)))
        elif name == "preset":
            preset = values[0]
        elif name == "angles":
            data["theta_o_deg"] = {"count": values[0]}
        elif name in Estimator.model_fields:
            data["estimator"][name] = values[0]
        elif name in kind.scene.model_fields.keys() - _NOT_IN_QUERY:
            data[name] = values[0]
        else:
            problems.append(Problem(name, ", ".join(values), "no field of this name"))
    for one, other in (("angles", "theta_o_deg"), ("model", "preset")):
        if one in query and other in query:
            problems.append(Problem(one, query[one], f"either {one} or {other}, not both"))
    if preset is not None:
        try:
            data = with_preset(preset, data)
        except BadInput as error:
            problems.extend(error.problems)
    return _checked(data, kind, catalogue, problems)


async def scene_of_body(request: Request, kind: Kind, catalogue: Catalogue) -> Scene:
    """The scene of a JSON body; raises as `json_of_body` does, and BadInput with all that is wrong."""
    return scene_of(await json_of_body(request), kind, catalogue)


def scene_of(data: Any, kind: Kind, catalogue: Catalogue) -> Scene:
    """The scene of plain data. Raises BadInput with all that is wrong."""
    return _checked(data, kind, catalogue, [])


def _checked(data: Any, kind: Kind, catalogue: Catalogue, problems: list[Problem]) -> Scene:
    try:
        if not isinstance(data, Mapping):
            raise BadInput(Problem("scene", data, "an object"))
        scene = kind.parse(data)
    except BadInput as error:
        problems.extend(error.problems)
    if problems:
        raise BadInput([*problems, *_beside(data, catalogue, problems)])
    return scene


def _beside(data: Any, catalogue: Catalogue, known: Collection[Problem]) -> list[Problem]:
    """What the catalogue finds wrong in the fields of a wrong scene that are right in form."""
    wrong = {problem.field.partition(".")[0] for problem in known}
    if not isinstance(data, Mapping) or "model" not in data:
        return []
    rest = {name: data[name] for name in _IN_CATALOGUE if name in data and name not in wrong}
    try:
        scene = parse_scene(rest)
        if math.prod(map(len, scene.parameters.values())) <= _QUICK_SERIES:
            resolve(scene, catalogue)
    except BadInput as error:
        return [problem for problem in error.problems if problem.field.partition(".")[0] not in wrong]
    return []


async def json_of_body(request: Request) -> Any:
    """The JSON of a body. Raises HttpError: 415 for another type, 400 where it is not JSON."""
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type != "application/json":
        raise HttpError(415, "unsupported-media-type", "the body must be application/json")
    try:
        body = await request.body()
        if len(body) > _QUICK_BYTES:
            return await asyncio.to_thread(_parsed, body)
        return _parsed(body)
    except ClientDisconnect:
        raise ClientGone from None
    except (ValueError, RecursionError) as error:
        raise HttpError(400, "malformed-json", f"the body is not JSON: {str(error)[:200]}") from None


def _parsed(body: bytes) -> Any:
    return json.loads(body, parse_constant=_refuse, object_pairs_hook=_members)


def _members(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    members = dict(pairs)
    if len(pairs) > _MAX_MEMBERS:
        raise ValueError(f"an object has {len(pairs)} members, {_MAX_MEMBERS} are allowed")
    if len(members) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{twice!r} is given more than once in an object")
    return members


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no JSON number")
