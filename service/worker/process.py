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
from service.worker import protocol
from service.worker.protocol import Message

START_S = 60.0
_LOG_BYTES = 1 << 16
_log = logging.getLogger("samplerscope.worker")


class NoDevice(SamplerscopeError):
    """The worker found no Vulkan device; the text says what to run or unset."""


class WorkerLost(SamplerscopeError):
    """The worker ended, or was ended because it hung, while it worked on this."""


class WorkerProcess:
    """A running worker that has said hello. `device` is what it found: name, driver, threads; None without one."""

    def __init__(
        self, process: asyncio.subprocess.Process, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        self.process = process
        self.reader = reader
        self.writer = writer
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
        reader, writer = await asyncio.open_connection(sock=ours)
        worker = cls(process, reader, writer)
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
        while (message := await protocol.read_from(self.reader)) is not None:
            match message.head["say"]:
                case "hello":
                    self.device = message.head["device"]
                    return
                case "no-device":
                    raise NoDevice(message.head["message"])
        raise WorkerLost("the worker ended before it was ready")

    def send(self, message: Message) -> None:
        """Send a message; one to a worker that has ended is lost."""
        with contextlib.suppress(ConnectionError, RuntimeError):
            self.writer.write(message.packed())

    async def end(self) -> None:
        """Kill the process with what it started (a compiler), wait for it and close the socket."""
        if self.process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
        await self.process.wait()
        self.writer.close()
        with contextlib.suppress(ConnectionError):
            await self.writer.wait_closed()
        await self._log_copy

    async def _copy_log(self) -> None:
        """What the driver and the interpreter print becomes lines of the server's log."""
        assert self.process.stderr is not None
        while chunk := await self.process.stderr.read(_LOG_BYTES):
            for line in chunk.decode(errors="replace").splitlines():
                _log.warning("%s", line, extra={"worker": self.process.pid})
