"""The page to look at, at `/`, and the files that it is made of. They hold no data, and need no key."""

from __future__ import annotations

import asyncio
from pathlib import Path

from fastapi import APIRouter, Request, Response

from service.api import documents
from service.api.assets import Asset, assets_of
from service.api.problems import HttpError
from service.api.services import Services
from service.worker.lane import Task

_FOLDER = Path(__file__).resolve().parents[2] / "page"
_INDEX = "index.html"
_LIBRARY = "vega-embed.js"


class _Library:
    """The plotting library, which a worker bundles once and then has in its cache: not while the server starts."""

    def __init__(self, services: Services) -> None:
        self._services = services
        self._lock = asyncio.Lock()
        self._asset: Asset | None = None

    async def asset(self) -> Asset:
        """The library. Raises QueueFull, WorkerLost, Cancelled or WorkerError."""
        async with self._lock:
            if self._asset is None:
                task = Task({"do": "library"})
                self._services.encoding.submit(task)
                content = (await task.future).blobs[0]
                self._asset = await asyncio.to_thread(Asset.of, _LIBRARY, content)
            return self._asset


def router(services: Services) -> APIRouter:
    """Routes of the page."""
    routes = APIRouter(tags=["page"])
    files = assets_of(_FOLDER)
    index = files.pop(_INDEX)
    library = _Library(services)

    @routes.get(
        "/",
        summary="The page: explore samplers in a browser",
        operation_id="get_page",
        response_class=Response,
        responses=documents.page_responses("text/html"),
    )
    async def page(request: Request) -> Response:
        return index.respond(request)

    @routes.get(
        "/page/{name}",
        summary="A file of the page: a module, the style sheet, the icon",
        operation_id="get_page_file",
        response_class=Response,
        responses=documents.page_responses("text/javascript", "text/css", "image/svg+xml")
        | documents.problems(404, 500, 503),
    )
    async def file(name: str, request: Request) -> Response:
        if name == _LIBRARY:
            return (await library.asset()).respond(request)
        if name not in files:
            raise HttpError(404, "not-found", f"the page has no file of this name; it has: {', '.join(sorted(files))}")
        return files[name].respond(request)

    return routes
