"""What happens around every request: an id, a size limit, a log line, metrics, and no error without a problem.

Pure ASGI: a body that streams is passed on as it is.
"""

from __future__ import annotations

import logging
import re
import secrets
import time
from collections.abc import Mapping
from typing import Any

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.metrics import Metrics
from service.api.problems import HttpError, problem_response, request_id

_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
_METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
_log = logging.getLogger("samplerscope.access")


class RequestContext:
    """Outermost: request id, HEAD as GET without a body, log line, metrics, `Server-Timing`, and a last resort.

    Handlers put milliseconds into `scope["state"]["timings"]`; they become `Server-Timing`.
    """

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        token = request_id.set(_identifier(scope))
        begin = time.perf_counter()
        timings: dict[str, float] = {}
        scope.setdefault("state", {})["timings"] = timings
        method = scope["method"]
        inner = {**scope, "method": "GET"} if method == "HEAD" else scope
        status, complete = 0, False

        def finish() -> None:
            """Note the request before its last byte goes out: whoever reads an answer finds its id in the log."""
            nonlocal complete
            if not complete:
                complete = True
                self._note(inner, method, status, time.perf_counter() - begin)

        async def send_more(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                _label(message, timings | {"total": 1e3 * (time.perf_counter() - begin)})
                if method == "HEAD":  # the end at once: events may go on for hours
                    finish()
                await send(message)
                if method == "HEAD":
                    await send({"type": "http.response.body"})
            elif method != "HEAD":
                if not message.get("more_body", False):
                    finish()
                await send(message)

        try:
            await self._app(inner, receive, send_more)
        except Exception as error:
            # The problem of an error that no handler expects is already sent when the error arrives here.
            if status and not complete:
                raise
            if not status:
                await problem_response(error)(scope, receive, send_more)
        finally:
            finish()
            request_id.reset(token)

    def _note(self, scope: Scope, method: str, status: int, elapsed_s: float) -> None:
        route = getattr(scope.get("route"), "path", "other")
        self._metrics.requests.labels(route, method if method in _METHODS else "other", str(status)).inc()
        self._metrics.duration.labels(route).observe(elapsed_s)
        level = logging.DEBUG if route in ("/healthz", "/readyz", "/metrics") else logging.INFO
        facts: dict[str, Any] = {"method": method, "path": scope["path"], "status": status}
        _log.log(level, "request", extra={**facts, "client": _client(scope), "elapsed_ms": round(1e3 * elapsed_s, 3)})


def _identifier(scope: Scope) -> str:
    """The id that the client gave, where it is one."""
    given = Headers(scope=scope).get("x-request-id", "")
    return given if _ID.fullmatch(given) else secrets.token_hex(8)


def _label(start: Message, timings: Mapping[str, float]) -> None:
    headers = MutableHeaders(scope=start)
    headers["x-request-id"] = request_id.get()
    headers["server-timing"] = ", ".join(f"{name};dur={ms:.3f}" for name, ms in timings.items())


def _client(scope: Scope) -> str:
    return scope["client"][0] if scope.get("client") else ""


class BodyLimit:
    """Refuses a body above a number of bytes, by its declared length and by what really comes."""

    def __init__(self, app: ASGIApp, limit_bytes: int) -> None:
        self._app = app
        self._limit = limit_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        declared = Headers(scope=scope).get("content-length", "0")
        if declared.isdigit() and int(declared) > self._limit:
            raise self._too_large()
        received = 0

        async def receive_limited() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > self._limit:
                raise self._too_large()
            return message

        await self._app(scope, receive_limited, send)

    def _too_large(self) -> HttpError:
        # The rest of the body is not read, so the connection cannot be used again.
        return HttpError(
            413,
            "body-too-large",
            f"the body is larger than {self._limit} bytes",
            {"connection": "close"},
            limit=self._limit,
        )
