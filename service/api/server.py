"""Running the application: one process, one event loop, and an orderly end."""

from __future__ import annotations

import asyncio
import logging
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any

import uvicorn
import uvloop
from starlette.types import ASGIApp, Receive, Scope, Send

from lavapipe import DeviceNotFound
from service.api import logs
from service.api.app import create_app
from service.api.connections import Connection
from service.api.services import Services
from service.api.settings import Settings
from service.errors import BadInput, Problem
from service.worker.process import NoDevice

_log = logging.getLogger("samplerscope.server")


def serve(settings: Settings) -> None:
    """Serve until SIGINT or SIGTERM. Raises BadInput where address or folder is no good, DeviceNotFound."""
    logs.configure(settings.log_level)
    listener = _listen(settings)
    with listener, asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        try:
            runner.run(_serve(settings, listener))
        except NoDevice as error:
            raise DeviceNotFound(str(error)) from None


async def _serve(settings: Settings, listener: socket.socket) -> None:
    services = Services.create(settings)
    failures: list[Exception] = []
    config = uvicorn.Config(
        _noting(create_app(services), failures),
        http=partial(Connection, arrival_s=settings.request_timeout_s),  # type: ignore[arg-type]
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=round(settings.graceful_s) + 5,
        backlog=1024,
    )
    server = _Server(config, services)
    host, port = listener.getsockname()[:2]
    server.url = f"http://{f'[{host}]' if ':' in host else host}:{port}"
    with suppress(SystemExit):  # uvicorn's way to end when the application did not start
        await server.serve([listener])
    if failures:
        raise failures[0]


def _noting(app: ASGIApp, failures: list[Exception]) -> ASGIApp:
    """The application, with the error noted that kept it from starting: uvicorn would log it and no more."""

    async def noting(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "lifespan":
            await app(scope, receive, send)
            return

        async def send_on(message: Any) -> None:
            if message["type"] == "lifespan.startup.failed":
                message = {**message, "message": ""}
            await send(message)

        try:
            await app(scope, receive, send_on)
        except Exception as error:
            failures.append(error)

    return noting


def _listen(settings: Settings) -> socket.socket:
    """A socket that listens; BadInput where the address cannot be had."""
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((settings.host, settings.port))
    except OSError as error:
        listener.close()
        address = f"{settings.host}:{settings.port}"
        raise BadInput(Problem("host:port", address, f"an address that is free here ({error.strerror})")) from None
    return listener


class _Server(uvicorn.Server):
    """uvicorn, with an end in this order: jobs are put off and watchers told, requests finish, workers end."""

    url = ""

    def __init__(self, config: uvicorn.Config, services: Services) -> None:
        super().__init__(config)
        self._services = services

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Stop at SIGINT and SIGTERM. uvicorn's own way raises them again at the end, as if the process had died."""
        loop = asyncio.get_running_loop()
        for number in (signal.SIGINT, signal.SIGTERM):
            loop.add_signal_handler(number, self.handle_exit, number, None)
        try:
            yield
        finally:
            for number in (signal.SIGINT, signal.SIGTERM):
                loop.remove_signal_handler(number)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if not self.should_exit:
            _log.info("listening", extra={"url": self.url})

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        _log.info("stopping")
        ending = asyncio.create_task(self._end_requests())
        await self._services.jobs.stop()
        await super().shutdown(sockets)
        ending.cancel()

    async def _end_requests(self) -> None:
        """Whoever still waits when the time is up gets a problem, not a broken connection."""
        await asyncio.sleep(self._services.settings.graceful_s)
        await self._services.end_answers()
