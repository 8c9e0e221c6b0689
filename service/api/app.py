"""The application: routes, error answers and middleware around one `Services`."""

from __future__ import annotations

import hmac
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from importlib.metadata import version
from typing import Any

from fastapi import Depends, FastAPI, Request, Response, Security
from fastapi.openapi.utils import get_openapi
from fastapi.security import APIKeyHeader
from starlette.exceptions import HTTPException
from starlette.routing import Match
from starlette.types import ASGIApp

from lavapipe import LavapipeError
from service.api import documents
from service.api.middleware import BodyLimit, RequestContext
from service.api.problems import HttpError, problem_response
from service.api.routes import catalogue, figures, jobs, operations, own_files, page, questions
from service.api.services import Services
from service.errors import SamplerscopeError

_DESCRIPTION = (
    "How noisy, how right and how fast a BRDF sampler is. A question is a scene: a model with parameter values, "
    "techniques, view angles. What takes long becomes a job: the answer is then 202 with its Location."
)
_NAMES = {404: "not-found", 405: "method-not-allowed"}


def create_app(services: Services) -> ASGIApp:
    """The application of these services, which it starts and stops with its lifespan."""

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        await services.start()
        try:
            yield
        finally:
            await services.stop()

    app = FastAPI(
        title="samplerscope",
        version=version("samplerscope"),
        description=_DESCRIPTION,
        lifespan=lifespan,
        redoc_url=None,
        redirect_slashes=False,
        responses=documents.problems(405),
    )
    app.include_router(page.router(services))
    app.include_router(operations.health_router())
    app.include_router(operations.ready_router(services))
    guard = _guard(services)
    for resource in (questions, figures, own_files, catalogue, jobs):
        app.include_router(resource.router(services), dependencies=guard)
    app.include_router(operations.metrics_router(services), dependencies=guard)
    app.add_exception_handler(HTTPException, _http_exception)
    app.add_exception_handler(Exception, _exception)
    app.add_exception_handler(SamplerscopeError, _exception)
    app.add_exception_handler(LavapipeError, _exception)
    app.openapi = _openapi(app, secured=bool(guard))  # type: ignore[method-assign]
    return RequestContext(BodyLimit(app, services.settings.max_body_bytes), services.metrics)


async def _exception(_: Request, error: Exception) -> Response:
    return problem_response(error)


async def _http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    name = _NAMES.get(error.status_code, "bad-request")
    headers = {"allow": _methods(request)} if error.status_code == 405 else error.headers
    return problem_response(HttpError(error.status_code, name, str(error.detail), headers))


def _methods(request: Request) -> str:
    """The methods that a path has: each has a route of its own, and the framework names those of one route."""

    def has(method: str) -> bool:
        scope = {**request.scope, "method": method}
        return any(route.matches(scope)[0] == Match.FULL for route in request.app.routes)

    found = [method for method in ("GET", "POST", "DELETE") if has(method)]
    return ", ".join([*found, "HEAD"] if "GET" in found else found)


def _guard(services: Services) -> list[Any]:
    """What every request must pass: the API key, where one is set."""
    secret = services.settings.api_key
    if secret is None:
        return []
    header = APIKeyHeader(name="X-API-Key", auto_error=False, description="Or `Authorization: Bearer KEY`.")

    def check(request: Request, given: str | None = Security(header)) -> None:
        scheme, _, token = request.headers.get("authorization", "").partition(" ")
        key = given or (token if scheme.lower() == "bearer" else "")
        if not hmac.compare_digest(key.encode(), secret.get_secret_value().encode()):
            raise HttpError(401, "unauthorized", "this server wants a key", {"www-authenticate": "Bearer"})

    return [Depends(check)]


def _openapi(app: FastAPI, *, secured: bool) -> Callable[[], dict[str, Any]]:
    """The function that makes the OpenAPI document, once."""

    def document() -> dict[str, Any]:
        if not app.openapi_schema:
            made = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes)
            made.setdefault("components", {}).setdefault("schemas", {}).update(documents.components())
            for path in made["paths"].values():
                for operation in path.values():
                    operation["responses"].pop("422", None) if _default_422(operation) else None
                    if secured and operation.get("security"):
                        operation["responses"] |= {str(k): v for k, v in documents.problems(401).items()}
            made["components"]["schemas"].pop("HTTPValidationError", None)
            made["components"]["schemas"].pop("ValidationError", None)
            app.openapi_schema = made
        return app.openapi_schema

    return document


def _default_422(operation: dict[str, Any]) -> bool:
    """Whether the answer 422 is FastAPI's own, for a check of path parameters that cannot fail: they are texts."""
    return "HTTPValidationError" in str(operation["responses"].get("422", ""))
