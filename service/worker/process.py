"""One worker process, as the server sees it: started, spoken to, ended."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
import socket
import sys
from typing import Any

from service.errors import SamplerscopeError
from service.worker.protocol import Message, Unpacker

START_S = 60.0
_LOG_BYTES = 1 << 16
_log = logging.getLogger("samplerscope.worker")


class NoDevice(SamplerscopeError):
    """The worker found no Vulkan device; the text says what to run or unset."""


class WorkerLost(SamplerscopeError):
    """The worker ended, or was ended because it hung, while it worked on this."""


class _Arrivals(asyncio.Protocol):
    """Puts what a worker says into its inbox; None where the worker ended, or what it said is no message."""

    def __init__(self, inbox: asyncio.Queue[Message | None]) -> None:
        self._inbox = inbox
        self._unpacker = Unpacker()

    def data_received(self, data: bytes) -> None:
        try:
            for message in self._unpacker.feed(data):
                self._inbox.put_nowait(message)
        except (ValueError, KeyError, TypeError, AttributeError):
            self._inbox.put_nowait(None)

    def connection_lost(self, exc: Exception | None) -> None:
        self._inbox.put_nowait(None)


class WorkerProcess:
    """A running worker that has said hello. `device` is what it found: name, driver, threads; None without one.

    What it says comes to `inbox`, and None at its end.
    """

    def __init__(
        self,
        process: asyncio.subprocess.Process,
        transport: asyncio.WriteTransport,
        inbox: asyncio.Queue[Message | None],
    ) -> None:
        self.process = process
        self.inbox = inbox
        self._transport = transport
        self.device: dict[str, Any] | None = None
        self._log_copy = asyncio.create_task(self._copy_log())

    @classmethod
    async def start(cls, *, with_device: bool, nice: int) -> WorkerProcess:
        """Start a worker and wait until it is ready.

        Raises NoDevice where it finds no device and WorkerLost where it ends before it is ready.
        """
        ours, theirs = socket.socketpair()
        with theirs:
            process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-m", "service.worker"),
                *(str(theirs.fileno()), "device" if with_device else "no-device"),
                pass_fds=[theirs.fileno()],
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.DEVNULL,
                stderr=asyncio.subprocess.PIPE,
                # Ctrl-C in a terminal goes to the server, which ends its workers in order.
                start_new_session=True,
            )
        with contextlib.suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, process.pid, os.getpriority(os.PRIO_PROCESS, 0) + nice)
        inbox: asyncio.Queue[Message | None] = asyncio.Queue()
        loop = asyncio.get_running_loop()
        transport, _ = await loop.create_connection(lambda: _Arrivals(inbox), sock=ours)
        worker = cls(process, transport, inbox)
        try:
            async with asyncio.timeout(START_S):
                await worker._await_hello()
        except BaseException as error:
            await worker.end()
            if isinstance(error, TimeoutError):
                raise WorkerLost(f"the worker was not ready after {START_S:g} s") from None
            raise
        return worker

    async def _await_hello(self) -> None:
        while (message := await self.inbox.get()) is not None:
            match message.head["say"]:
                case "hello":
                    self.device = message.head["device"]
                    return
                case "no-device":
                    raise NoDevice(message.head["message"])
        raise WorkerLost("the worker ended before it was ready")

    def send(self, message: Message) -> None:
        """Send a message; one to a worker that has ended is lost."""
        if not self._transport.is_closing():
            self._transport.write(message.packed())

    async def end(self) -> None:
        """Kill the process with what it started (a compiler), wait for it and close the socket."""
        if self.process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
        await self.process.wait()
        self._transport.abort()
        await self._log_copy

    async def _copy_log(self) -> None:
        """What the driver and the interpreter print becomes lines of the server's log."""
        assert self.process.stderr is not None
        while chunk := await self.process.stderr.read(_LOG_BYTES):
            for line in chunk.decode(errors="replace").splitlines():
                _log.warning("%s", line, extra={"worker": self.process.pid})
