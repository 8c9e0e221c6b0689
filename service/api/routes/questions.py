"""GET and POST of every kind of question: a scene in the query string or as JSON."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from service.api import documents
from service.api.queries import parameter_names, scene_of_body, scene_of_query
from service.api.services import Services
from service.worker.kinds import ROUTED, Kind


def router(services: Services) -> APIRouter:
    """Routes of all kinds."""
    routes = APIRouter(tags=["questions"])
    for kind in ROUTED:
        _add(routes, kind, services)
    return routes


def _add(routes: APIRouter, kind: Kind, services: Services) -> None:
    parameters = parameter_names(services.catalogue)

    async def ask_by_query(request: Request) -> Response:
        scene = scene_of_query(request.query_params, kind, services.catalogue, parameters)
        return await services.respond(request, kind.name, scene)

    async def ask_by_scene(request: Request) -> Response:
        return await services.respond(request, kind.name, await scene_of_body(request, kind, services.catalogue))

    responses = documents.answer_responses(kind.name)
    routes.add_api_route(
        kind.path,
        ask_by_query,
        methods=["GET"],
        summary=kind.title,
        operation_id=f"get_{kind.name}",
        response_class=Response,
        responses=responses,
        openapi_extra={"parameters": documents.query_parameters(services.catalogue, kind)},
    )
    routes.add_api_route(
        kind.path,
        ask_by_scene,
        methods=["POST"],
        summary=kind.title,
        operation_id=f"post_{kind.name}",
        response_class=Response,
        responses=responses | documents.BODY_RESPONSES,
        openapi_extra={
            "parameters": [documents.format_parameter(kind.name), *documents.ANSWER_HEADERS],
            "requestBody": documents.scene_body(kind),
        },
    )
