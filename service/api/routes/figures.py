"""Figures of papers: their scenes, and their numbers and pictures."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response

from service.api import documents
from service.api.jobs_json import json_response
from service.api.problems import HttpError
from service.api.services import Services
from service.errors import BadInput, Problem
from service.papers import FIGURES, figure_scene
from service.scene import parse_scene

_ALLOWED = ("samples", "seed")
_Name = Annotated[str, Path(json_schema_extra={"enum": list(FIGURES)}, examples=["eon-13"])]
_KINDS = {"convergence": "convergence", "timings": "timings", "slices": "slices"}
"""Kinds of result by chart, where that is not statistics."""


def router(services: Services) -> APIRouter:
    """Routes of figures."""
    routes = APIRouter(tags=["figures"])

    @routes.get(
        "/v1/figures",
        summary="The figures there are",
        operation_id="get_figures",
        response_class=Response,
        responses={200: documents.json_content("Figures")},
    )
    async def figures() -> Response:
        listed = [
            {"name": name, "title": figure.title, "chart": figure.chart, "scene": figure.scene}
            for name, figure in FIGURES.items()
        ]
        return json_response({"kind": "figures", "figures": listed})

    @routes.get(
        "/v1/figures/{name}",
        summary="A figure of a paper",
        operation_id="get_figure",
        response_class=Response,
        responses=documents.figure_responses(),
        openapi_extra={"parameters": documents.figure_parameters()},
    )
    async def figure(name: _Name, request: Request) -> Response:
        if name not in FIGURES:
            raise HttpError(404, "not-found", f"there is no figure of this name; there are: {', '.join(FIGURES)}")
        given = {key: request.query_params[key] for key in _ALLOWED if key in request.query_params}
        unknown = set(request.query_params) - {*_ALLOWED, "format"}
        if unknown:
            raise BadInput(
                [Problem(key, request.query_params[key], "no field of this name") for key in sorted(unknown)]
            )
        paper = FIGURES[name]
        checked = parse_scene({"model": "eon", "estimator": given}).estimator
        scene = figure_scene(paper, **checked.model_dump(include=set(given)))
        return await services.respond(request, _KINDS.get(paper.chart, "statistics"), scene, figure=name)

    return routes
