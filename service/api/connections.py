"""A connection: what comes before a request is one. Its head is bounded in size, all of it in time, and what is no HTTP
is answered with a problem as well.
"""

from __future__ import annotations

import asyncio
import logging
import secrets
from http import HTTPStatus
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from service.api.problems import MEDIA_TYPE, HttpError, encode, problem_of, request_id

HEAD_BYTES = 1 << 16
_MALFORMED = HttpError(400, "malformed-request", "this is no request of HTTP/1.1")
_LARGE = HttpError(431, "head-too-large", f"the address and the headers are larger than {HEAD_BYTES} bytes")
_log = logging.getLogger("samplerscope.access")


class _HeadTooLarge(Exception):
    """The parser passes it on as an error of its own."""


class Connection(HttpToolsProtocol):
    """uvicorn's connection, where a request has to be whole `arrival_s` after its first byte."""

    def __init__(self, *arguments: Any, arrival_s: float, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self._arrival_s = arrival_s
        self._overdue: asyncio.TimerHandle | None = None
        self._in_head = True
        self._head_bytes = 0
        self._refusal = _MALFORMED

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """A client is there; that it says something is awaited as well."""
        super().connection_made(transport)
        self._await_request()

    def connection_lost(self, exc: Exception | None) -> None:
        """The client is gone."""
        self._arrived()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take in a piece of a request, or of several."""
        if self._overdue is None:
            self._await_request()
        if self._in_head:
            self._head_bytes += len(data)
        super().data_received(data)
        if self._head_bytes > HEAD_BYTES and not self.transport.is_closing():
            self._refuse(_LARGE)

    def on_headers_complete(self) -> None:
        """The head is there."""
        if len(self.url) + sum(len(name) + len(value) for name, value in self.headers) > HEAD_BYTES:
            self._refusal = _LARGE
            raise _HeadTooLarge
        self._in_head, self._head_bytes = False, 0
        super().on_headers_complete()

    def on_message_complete(self) -> None:
        """The request is there."""
        self._in_head = True
        self._arrived()
        super().on_message_complete()

    def send_400_response(self, msg: str) -> None:
        """What came is no HTTP, or too much of it."""
        self._refuse(self._refusal)

    def _await_request(self) -> None:
        self._overdue = self.loop.call_later(self._arrival_s, self._give_up)

    def _arrived(self) -> None:
        if self._overdue is not None:
            self._overdue.cancel()
            self._overdue = None

    def _give_up(self) -> None:
        """The time of a request is up; it goes on where it is this server that reads no further."""
        self._overdue = None
        answering = self.cycle is not None and not self.cycle.response_complete
        if self.flow.read_paused or (answering and not self.cycle.more_body):
            self._await_request()
        elif answering or self._head_bytes:
            self._refuse(HttpError(408, "too-slow", f"the request was not there within {self._arrival_s:g} s"))
        else:
            self.transport.close()

    def _refuse(self, error: HttpError) -> None:
        """Answer with a problem and close; where the answer to another request is owed, only that."""
        cycle = self.cycle
        if cycle is None or cycle.response_complete:
            self._write(error)
        elif cycle.more_body and not cycle.response_started and not self.pipeline:
            cycle.disconnected = True
            cycle.message_event.set()
            self._write(error)
        self.transport.close()

    def _write(self, error: HttpError) -> None:
        identifier = secrets.token_hex(8)
        token = request_id.set(identifier)
        content = encode(problem_of(error)[0])
        client = self.client[0] if self.client else ""
        _log.info("no request", extra={"detail": str(error), "status": error.status, "client": client})
        request_id.reset(token)
        lines = [
            f"HTTP/1.1 {error.status} {HTTPStatus(error.status).phrase}",
            *(f"{name.decode()}: {value.decode()}" for name, value in self.server_state.default_headers),
            f"content-type: {MEDIA_TYPE}",
            f"content-length: {len(content)}",
            f"x-request-id: {identifier}",
            "connection: close",
        ]
        self.transport.write("\r\n".join([*lines, "", ""]).encode() + content)
