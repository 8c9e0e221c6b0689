"""Jobs: start, list, watch, fetch the result, cancel."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator
from typing import Any

from fastapi import APIRouter, Request, Response
from starlette.datastructures import QueryParams
from starlette.responses import StreamingResponse

from service.api import documents
from service.api.jobs_json import accepted, job_json, jobs_response, json_response, sse
from service.api.problems import HttpError
from service.api.queries import json_of_body, scene_of
from service.api.representations import chosen_format, represent
from service.api.services import Services, unless_gone
from service.errors import BadInput, Problem
from service.formats import FORMATS, formats_of
from service.jobs.store import Job
from service.worker.kinds import KINDS, ROUTED

LISTED = 100
"""Most jobs that are listed."""


def router(services: Services) -> APIRouter:
    """Routes of jobs."""
    routes = APIRouter(tags=["jobs"])
    _add_collection(routes, services)
    _add_job(routes, services)
    _add_outcome(routes, services)
    return routes


def _add_collection(routes: APIRouter, services: Services) -> None:
    """Start a job, and list them."""

    @routes.post(
        "/v1/jobs",
        summary="Answer a question in the background",
        operation_id="post_job",
        response_class=Response,
        responses={202: documents.JOB_ACCEPTED, **documents.problems(422, 503), **documents.BODY_RESPONSES},
        openapi_extra={"requestBody": documents.job_body()},
    )
    async def start(request: Request) -> Response:
        kind, scene = _wanted(await json_of_body(request))
        asked = await services.ask(kind, scene_of(scene, KINDS[kind], services.catalogue))
        return accepted(await services.jobs.submit(asked, await services.estimate(asked)))

    @routes.get(
        "/v1/jobs",
        summary="The latest jobs, newest first",
        operation_id="get_jobs",
        response_class=Response,
        responses=documents.answers("Jobs", 422),
        openapi_extra={"parameters": [documents.limit_parameter(LISTED)]},
    )
    async def listed(request: Request) -> Response:
        jobs = await services.jobs.latest(_limit(request.query_params))
        # Scenes may be large: in a thread, and one by one, they hold up nobody.
        return await asyncio.to_thread(jobs_response, jobs)


def _add_job(routes: APIRouter, services: Services) -> None:
    """State of a job, and its end."""

    @routes.get(
        "/v1/jobs/{job_id}",
        summary="State and progress of a job",
        operation_id="get_job",
        response_class=Response,
        responses=documents.answers("Job", 404),
    )
    async def state(job_id: str) -> Response:
        return json_response(job_json(_there(await services.jobs.job(job_id))))

    @routes.delete(
        "/v1/jobs/{job_id}",
        summary="Cancel a job; it ends at its next launch and frees the device",
        operation_id="delete_job",
        response_class=Response,
        responses=documents.answers("Job", 404),
    )
    async def cancel(job_id: str) -> Response:
        return json_response(job_json(_there(await services.jobs.cancel(job_id))))


def _add_outcome(routes: APIRouter, services: Services) -> None:
    """What comes of a job: events while it runs, and its result."""

    @routes.get(
        "/v1/jobs/{job_id}/events",
        summary="What happens to a job, as server-sent events",
        operation_id="get_job_events",
        response_class=Response,
        responses={200: documents.EVENTS, **documents.problems(404)},
    )
    async def events(job_id: str) -> Response:
        _there(await services.jobs.job(job_id))

        async def stream() -> AsyncIterator[bytes]:
            async for event in services.jobs.events(job_id):
                yield sse(*event) if event is not None else b":\n\n"

        headers = {"cache-control": "no-store", "x-accel-buffering": "no"}
        return StreamingResponse(stream(), headers=headers, media_type="text/event-stream")

    @routes.get(
        "/v1/jobs/{job_id}/result",
        summary="The result of a job that is done",
        operation_id="get_job_result",
        response_class=Response,
        responses=documents.result_responses() | documents.problems(404, 409),
        openapi_extra={"parameters": [documents.format_parameter(), *documents.ANSWER_HEADERS]},
    )
    async def result(job_id: str, request: Request) -> Response:
        job = _there(await services.jobs.job(job_id))
        format_ = chosen_format(request, formats_of(job.kind))
        if job.state != "done":
            again = {"retry-after": "1"} if not job.finished else {}
            raise HttpError(409, "no-result", f"the job is {job.state}", again, state=job.state, error=job.error)
        stored = await services.answers.find(job.key)
        if stored is None:
            raise HttpError(404, "not-found", "the result was stored and is no longer; ask the question again")
        if format_ != "json":
            client = request.client.host if request.client else ""
            work = services.answers.encode(job.key, stored, format_, None, client)
            stored = (await unless_gone(request, work)).stored
        return represent(request, stored, FORMATS[format_].media_type)


def _limit(query: QueryParams) -> int:
    """How many jobs to list. Raises BadInput."""
    problems = [Problem(name, query[name], "no field of this name") for name in query if name != "limit"]
    given = query.getlist("limit") or [str(LISTED)]
    if len(given) > 1 or not re.fullmatch("[0-9]{1,9}", given[0]) or not 1 <= int(given[0]) <= LISTED:
        problems.append(Problem("limit", ", ".join(given), f"a whole number, 1 to {LISTED}, given once"))
    if problems:
        raise BadInput(problems)
    return int(given[0])


def _there(job: Job | None) -> Job:
    if job is None:
        raise HttpError(404, "not-found", "there is no job of this id, or it is forgotten")
    return job


def _wanted(body: Any) -> tuple[str, Any]:
    """Kind and scene of a job's body."""
    if not isinstance(body, dict):
        raise BadInput(Problem("body", body, 'an object {"kind": ..., "scene": {...}}'))
    problems = [Problem(name, body[name], "no field of this name") for name in body if name not in ("kind", "scene")]
    kind = body.get("kind", "statistics")
    names = [kind.name for kind in ROUTED]
    if kind not in names:
        problems.append(Problem("kind", kind, "one of " + ", ".join(names)))
    if "scene" not in body:
        problems.append(Problem("scene", None, "a value, it is required"))
    if problems:
        raise BadInput(problems)
    return str(kind), body["scene"]
