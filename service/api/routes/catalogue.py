"""The catalogue: models and techniques as their shader files declare them."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from service.api import documents
from service.api.representations import represent
from service.api.services import Services
from service.formats import encode
from service.information import describe_catalogue
from service.jobs.store import Stored


def router(services: Services) -> APIRouter:
    """Routes of the catalogue."""
    routes = APIRouter(tags=["catalogue"])
    stored = Stored.of(encode({"kind": "catalogue", **describe_catalogue(services.catalogue)}, "json"))

    @routes.get(
        "/v1/catalogue",
        summary="Models and techniques, their parameters, ranges, units and meanings",
        operation_id="get_catalogue",
        response_class=Response,
        responses={200: documents.json_content("CatalogueResult"), 304: documents.NOT_MODIFIED},
    )
    async def catalogue(request: Request) -> Response:
        return represent(request, stored, "application/json")

    return routes
