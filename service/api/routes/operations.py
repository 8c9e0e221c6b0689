"""For those who run the service: is it alive, does the device compute right, what did it do."""

from __future__ import annotations

import asyncio
import time
from typing import Any

from fastapi import APIRouter, Response

from service.api import documents
from service.api.jobs_json import json_response
from service.api.problems import HttpError
from service.api.services import Services
from service.errors import SamplerscopeError
from service.worker.lane import Task

READY_S = 5.0
_FRESH_S = 1.0


class Readiness:
    """The outcome of the latest probe of the device. One at a time, and none within a second of the last."""

    def __init__(self, services: Services) -> None:
        self._services = services
        self._lock = asyncio.Lock()
        self._at = 0.0
        self._outcome: dict[str, Any] = {}

    async def probe(self) -> dict[str, Any]:
        """Dispatch on the device and compare: `ready`, and what was found and is known, or the reason."""
        async with self._lock:
            if time.monotonic() - self._at > _FRESH_S:
                self._outcome = await self._dispatch()
                self._at = time.monotonic()
            return self._outcome

    async def _dispatch(self) -> dict[str, Any]:
        lane, task = self._services.direct, Task({"do": "probe"})
        try:
            lane.submit(task, beyond_limit=True)
            async with asyncio.timeout(READY_S):
                head = (await task.future).head
        except (SamplerscopeError, TimeoutError) as error:
            lane.cancel(task)
            return {"ready": False, "reason": str(error) or f"the device did not answer within {READY_S:g} s"}
        found = {name: head[name] for name in ("found", "known")}
        outcome = {"ready": head["right"], **found, "device": lane.device}
        return outcome if head["right"] else {**outcome, "reason": "the device computes wrong"}


def health_router() -> APIRouter:
    """/healthz, which needs no key and no device."""
    routes = APIRouter(tags=["operations"])

    @routes.get(
        "/healthz",
        summary="Whether the server answers",
        operation_id="get_health",
        response_class=Response,
        responses={200: documents.json_content("Health")},
    )
    async def healthz() -> Response:
        return json_response({"status": "ok"})

    return routes


def ready_router(services: Services) -> APIRouter:
    """/readyz, which needs no key."""
    routes = APIRouter(tags=["operations"])
    readiness = Readiness(services)

    @routes.get(
        "/readyz",
        summary="Whether the device computes a known result",
        operation_id="get_readiness",
        response_class=Response,
        responses=documents.answers("Ready", 503),
    )
    async def readyz() -> Response:
        outcome = dict(await readiness.probe())
        if not outcome["ready"]:
            raise HttpError(503, "not-ready", outcome.pop("reason"), {"retry-after": "1"}, **outcome)
        return json_response(outcome)

    return routes


def metrics_router(services: Services) -> APIRouter:
    """/metrics."""
    routes = APIRouter(tags=["operations"])

    @routes.get(
        "/metrics",
        summary="Counters and times, for Prometheus",
        operation_id="get_metrics",
        response_class=Response,
        responses={200: {"description": "Metrics", "content": {"text/plain": {"schema": {"type": "string"}}}}},
    )
    async def metrics() -> Response:
        return Response(services.metrics.text(), media_type="text/plain; version=0.0.4; charset=utf-8")

    return routes
