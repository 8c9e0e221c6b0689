"""Problems: what a client is told when something is wrong (RFC 9457), from one table of errors.

A problem never holds more of an error than its own one-line text; the traceback is in the log, under the same request
id.
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

from starlette.responses import Response

from lavapipe import CompileError, LavapipeError, OutOfMemory
from service.errors import BadInput, SamplerscopeError, short
from service.formats import UnknownFormat
from service.isolation import OwnFileFailed
from service.jobs.answers import TimedOut, TooManyRequests
from service.worker.lane import Cancelled, QueueFull, WorkerError
from service.worker.process import NoDevice, WorkerLost

MEDIA_TYPE = "application/problem+json"
request_id: ContextVar[str] = ContextVar("request_id", default="")
_log = logging.getLogger("samplerscope.problems")


class HttpError(SamplerscopeError):
    """A request that is wrong as HTTP: status, name of the problem, detail, and headers of the answer."""

    def __init__(
        self, status: int, name: str, detail: str, headers: Mapping[str, str] | None = None, **members: Any
    ) -> None:
        self.status = status
        self.name = name
        self.headers = dict(headers or {})
        self.members = members
        super().__init__(detail)


class ClientGone(HttpError):
    """The client closed the connection: the log has it, nobody is there to read it."""

    def __init__(self) -> None:
        super().__init__(408, "client-gone", "the client closed the connection")


class OverBudget(BadInput):
    """A question beyond a limit of this server: `estimate` and `limit` in the unit of the field."""

    def __init__(self, problem: Any, estimate: float, limit: float) -> None:
        super().__init__(problem)
        self.estimate = estimate
        self.limit = limit


@dataclass(frozen=True)
class _Row:
    status: int
    name: str
    retry_after_s: int | None = None
    detail: str | None = None


_TABLE: Mapping[type[Exception], _Row] = {
    OverBudget: _Row(422, "over-budget"),
    BadInput: _Row(422, "bad-input"),
    UnknownFormat: _Row(406, "not-acceptable"),
    TooManyRequests: _Row(429, "too-many-requests", 1),
    QueueFull: _Row(503, "queue-full", 2),
    TimedOut: _Row(503, "timed-out", 5),
    WorkerLost: _Row(503, "worker-lost", 1),
    NoDevice: _Row(503, "no-device", 5),
    Cancelled: _Row(503, "stopping", 5),
    OwnFileFailed: _Row(422, "own-file-failed"),
    CompileError: _Row(500, "compile-error"),
    OutOfMemory: _Row(503, "out-of-memory", 5),
    LavapipeError: _Row(503, "device-error", 1),
    Exception: _Row(500, "internal-error", detail="an error inside the service; its log has the request id"),
}
_BY_NAME = {kind.__name__: row for kind, row in _TABLE.items()}


def problem_of(error: Exception) -> tuple[dict[str, Any], dict[str, str]]:
    """The problem of an error, and the headers that go with it."""
    if isinstance(error, HttpError):
        return _problem(error.status, error.name, str(error), **error.members), error.headers
    description = error.description if isinstance(error, WorkerError) else {}
    names = description.get("tree") or [base.__name__ for base in type(error).__mro__]
    row = next((_BY_NAME[name] for name in names if name in _BY_NAME), _TABLE[Exception])
    if row.status == HTTPStatus.INTERNAL_SERVER_ERROR:
        _log.error("internal error", exc_info=error, extra={"worker_trace": description.get("trace", "")})
    members: dict[str, Any] = {}
    if isinstance(error, BadInput):
        members["errors"] = [
            {"field": one.field, "value": _plain(one.value), "allowed": one.allowed} for one in error.problems
        ]
    elif description.get("problems"):
        members["errors"] = description["problems"]
    if description.get("diagnostics"):
        members["diagnostics"] = description["diagnostics"]
    if isinstance(error, OverBudget):
        members |= {"estimate": error.estimate, "limit": error.limit}
    headers = {}
    if row.retry_after_s is not None:
        headers["retry-after"] = str(row.retry_after_s)
    return _problem(row.status, row.name, row.detail or str(error), **members), headers


def _problem(status: int, name: str, detail: str, **members: Any) -> dict[str, Any]:
    return {
        "type": f"urn:samplerscope:problem:{name}",
        "title": HTTPStatus(status).phrase,
        "status": status,
        "detail": detail,
        "request_id": request_id.get(),
        **members,
    }


def problem_response(error: Exception) -> Response:
    """The answer to a request that met this error."""
    problem, headers = problem_of(error)
    return Response(encode(problem), problem["status"], headers, MEDIA_TYPE)


def encode(problem: Mapping[str, Any]) -> bytes:
    """A problem as bytes. ASCII: a client may have sent half a surrogate pair, which UTF-8 cannot hold."""
    return json.dumps(problem, ensure_ascii=True, allow_nan=False).encode()


def _plain(value: object) -> Any:
    """A value that a client sent, as JSON that is short."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if value is None or isinstance(value, bool | int | float):
        return value
    return short(value, 200)
