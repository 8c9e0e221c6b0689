"""Questions about a model or technique of one's own, whose GLSL comes with them. Off unless a setting allows it."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic import ValidationError

from service.api import documents
from service.api.problems import HttpError
from service.api.queries import json_of_body
from service.api.schemas import OwnCheck, OwnScene
from service.api.services import Services
from service.errors import BadInput, Problem
from service.scene import parse_scene, scene_problems

ORIGIN = "own.glsl"
"""What results and the compiler's messages call the file."""

_TITLES = {
    "check": "The whole battery on a model or technique of one's own",
    "statistics": "Statistics of a model or technique of one's own",
    "stability": "Stiff and extreme cases of a model or technique of one's own",
}


def router(services: Services) -> APIRouter:
    """Routes of own files."""
    routes = APIRouter(tags=["own files"])
    for task in _TITLES:
        _add(routes, task, services)
    return routes


def _add(routes: APIRouter, task: str, services: Services) -> None:
    body = OwnCheck if task == "check" else OwnScene

    async def answer(request: Request) -> Response:
        if services.own is None:
            raise HttpError(403, "own-glsl-off", "this server takes no shader text: SAMPLERSCOPE_OWN_GLSL is off")
        given = _checked(body, await json_of_body(request))
        if isinstance(given, OwnScene):
            if "model" in given.scene:
                raise BadInput(Problem("scene.model", given.scene["model"], "no value: it is the file's"))
            scene = {**given.scene, "model": ORIGIN}
            services.check_cells(parse_scene(scene))
            arguments: dict[str, Any] = {"scene": scene}
        else:
            fields = given.model_dump(include={"model", "techniques", "quick", "seed"})
            arguments = {"subject": ORIGIN, "fixed": given.parameters, **fields}
        return await services.respond_own(request, task, {**arguments, "files": {ORIGIN: given.glsl}, "device": None})

    routes.add_api_route(
        f"/v1/own/{task}",
        answer,
        methods=["POST"],
        summary=_TITLES[task],
        operation_id=f"post_own_{task}",
        response_class=Response,
        responses=documents.own_responses(task) | documents.BODY_RESPONSES,
        openapi_extra={
            "parameters": [documents.format_parameter(task), documents.ANSWER_HEADERS[0]],
            "requestBody": documents.own_body(body),
        },
    )


def _checked(body: type[OwnCheck] | type[OwnScene], data: Any) -> OwnCheck | OwnScene:
    if not isinstance(data, dict):
        raise BadInput(Problem("body", data, 'an object {"glsl": "...", ...}'))
    try:
        return body.model_validate(data)
    except ValidationError as error:
        raise BadInput(scene_problems(error)) from None
