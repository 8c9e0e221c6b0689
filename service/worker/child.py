"""The worker's own side: reads tasks, does one at a time, sends what it finds, and shows that it lives.

Two threads: the main one works, and reads at every step of its work; the other sends a beat every quarter of a second.
The end of the socket is the end of the process, whatever the device is doing.
"""

from __future__ import annotations

import gc
import os
import select
import socket
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

from lavapipe import LavapipeError
from service.engine import Engine
from service.errors import BadInput, SamplerscopeError
from service.isolation import OwnFileFailed
from service.worker import protocol
from service.worker.protocol import Message
from service.worker.tasks import Stopped, Toil, do_task

BEAT_S = 0.25
_NO_DEVICE = 3


class Worker:
    """A worker at one end of a socket."""

    def __init__(self, connection: socket.socket, *, with_device: bool) -> None:
        self._connection = connection
        self._with_device = with_device
        self._sending = threading.Lock()
        self._arrivals = select.poll()
        self._arrivals.register(connection, select.POLLIN)
        self._tasks: deque[Message] = deque()
        self._stops: set[int] = set()

    def run(self) -> int:
        """Work until the socket ends the process. Returns an exit code where there is no device to work with."""
        threading.Thread(target=self._beat, daemon=True).start()
        if not self._with_device:
            self._say("hello", device=None)
            return self._serve(None)
        try:
            engine = Engine.open()
        except LavapipeError as error:
            self._say("no-device", message=str(error))
            return _NO_DEVICE
        # What is loaded by now stays: a collection that walks through it takes a third of the time of a small task.
        gc.freeze()
        info = engine.device.info
        self._say("hello", device={"name": info.name, "driver": info.driver_version, "threads": info.threads})
        return self._serve(engine)

    def _serve(self, engine: Engine | None) -> int:
        while True:
            while not self._tasks:
                self._read()
            self._do(self._tasks.popleft(), engine, lambda: self._serve_guests(engine))

    def _serve_guests(self, engine: Engine | None) -> None:
        """Do what the server sent while a task was under way: it knows that this is to go first."""
        self._read_arrived()
        while self._tasks:
            self._do(self._tasks.popleft(), engine, self._read_arrived)

    def _do(self, task: Message, engine: Engine | None, give_way: Callable[[], None]) -> None:
        number = task.head["id"]
        toil = Toil(task, engine, self._say, self._stops, give_way)
        begin = time.perf_counter()
        try:
            head, blobs = do_task(toil)
            head["busy_ms"] = 1e3 * (time.perf_counter() - begin)
            self._say("done", blobs, id=number, **head)
        except Stopped:
            self._say("stopped", id=number)
        except Exception as error:
            self._say("failed", id=number, error=_described(error))
        self._stops.discard(number)

    def _read_arrived(self) -> None:
        """Read what has arrived, without waiting for more."""
        while self._arrivals.poll(0):
            self._read()

    def _read(self) -> None:
        """Read one message, and wait for it where there is none."""
        message = protocol.receive(self._connection)
        if message is None:
            os._exit(0)
        if message.head["do"] == "stop":
            self._stops.add(message.head["id"])
        else:
            self._tasks.append(message)

    def _beat(self) -> None:
        while True:
            self._say("beat")
            time.sleep(BEAT_S)

    def _say(self, say: str, blobs: tuple[bytes, ...] = (), **head: Any) -> None:
        content = Message({"say": say, **head}, blobs).packed()
        try:
            with self._sending:
                self._connection.sendall(content)
        except OSError:
            os._exit(0)


def _described(error: Exception) -> dict[str, Any]:
    """What the server may tell a client of an error (`message`, `problems`), and what only its log may (`trace`)."""
    problems: Sequence[Any] = ()
    if isinstance(error, BadInput):
        problems = [{"field": p.field, "value": repr(p.value), "allowed": p.allowed} for p in error.problems]
    elif isinstance(error, OwnFileFailed):
        problems = error.problems
    known = isinstance(error, LavapipeError | SamplerscopeError)
    return {
        "type": type(error).__name__,
        "tree": [base.__name__ for base in type(error).__mro__],
        "message": str(error) if known else "",
        "problems": problems,
        "diagnostics": error.diagnostics if isinstance(error, OwnFileFailed) else [],
        "trace": "" if problems else "".join(traceback.format_exception(error)),
    }
