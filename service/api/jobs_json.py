"""Jobs as JSON and as responses."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from starlette.responses import Response

from service.jobs.store import Job


def job_json(job: Job) -> dict[str, Any]:
    """A job as plain data."""
    path = f"/v1/jobs/{job.id}"
    return {
        "id": job.id,
        "kind": job.kind,
        "state": job.state,
        "progress": {"done": job.done, "total": job.total},
        "estimate_s": round(job.estimate_s, 3),
        "created": _time(job.created),
        "updated": _time(job.updated),
        "error": job.error,
        "links": {"self": path, "events": f"{path}/events", "result": f"{path}/result"},
        "scene": job.scene,
    }


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")


def json_response(data: Mapping[str, Any], status: int = 200, **headers: str) -> Response:
    """Plain data as JSON that is not kept by caches."""
    return _response(_encoded(data), status, **headers)


def jobs_response(jobs: Sequence[Job]) -> Response:
    """A list of jobs."""
    return _response(b'{"kind": "jobs", "jobs": [' + b", ".join(_encoded(job_json(job)) for job in jobs) + b"]}")


def _encoded(data: Mapping[str, Any]) -> bytes:
    return json.dumps(data, allow_nan=False).encode()


def _response(content: bytes, status: int = 200, **headers: str) -> Response:
    return Response(content, status, {"cache-control": "no-store", **headers}, "application/json")


def accepted(job: Job) -> Response:
    """202: the question became a job; where to look for it."""
    return json_response(job_json(job), 202, location=f"/v1/jobs/{job.id}", vary="Accept", **{"retry-after": "1"})


def sse(name: str, data: Mapping[str, Any]) -> bytes:
    """A server-sent event."""
    return f"event: {name}\ndata: {json.dumps(data, allow_nan=False)}\n\n".encode()
