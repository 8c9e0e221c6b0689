"""A lane: a queue of tasks before one worker, which is watched and replaced when it dies or hangs.

The device goes to the task that had least of it so far, so small tasks overtake huge ones and equal ones share. A task
that can be resumed gives way at its next launch when another waits that had less; its checkpoints are kept here, which
is also why the death of a worker costs it no more than the launches that were under way. One that cannot be resumed
stays at the worker and has guests: tasks that go first at its next step, and then it goes on.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Literal

from service.errors import SamplerscopeError
from service.worker.process import NoDevice, WorkerLost, WorkerProcess
from service.worker.protocol import Message

_log = logging.getLogger("samplerscope.worker")
_numbers = itertools.count(1)


class QueueFull(SamplerscopeError):
    """As many tasks wait as are allowed to."""


class Cancelled(SamplerscopeError):
    """A task was cancelled, or put off by the end of the server; its checkpoints stay valid."""


class WorkerError(SamplerscopeError):
    """An error that the worker met in a task. `description` is its own account; see service.worker.child."""

    def __init__(self, description: dict[str, Any]) -> None:
        super().__init__(description["message"] or "an error inside the service")
        self.description = description


@dataclass(frozen=True)
class LaneSettings:
    """How a lane runs: `tries` is how many workers a task may lose in a row without getting further."""

    name: str
    with_device: bool = True
    nice: int = 0
    limit: int = 64
    quantum_s: float = 0.2
    beat_timeout_s: float = 2.0
    stall_timeout_s: float = 120.0


@dataclass(eq=False)
class Task:
    """Something to be done. `checkpoints` holds the latest bytes of every run that has begun.

    `tries` is how many workers it may use up without getting further; `hear` is called with every message about it.
    `estimate_s` is what it is expected to take.
    """

    head: dict[str, Any]
    blobs: tuple[bytes, ...] = ()
    resumable: bool = False
    estimate_s: float = math.inf
    tries: int = 1
    hear: Callable[[Message], None] = lambda message: None
    checkpoints: dict[str, bytes] = field(default_factory=dict)
    number: int = field(default_factory=lambda: next(_numbers))
    created: float = field(default_factory=time.monotonic)
    begun: float | None = None
    served_s: float = 0.0
    slices_in_vain: int = 0
    losses: int = 0
    cancelled: bool = False
    future: asyncio.Future[Message] = field(default_factory=lambda: asyncio.get_running_loop().create_future())

    def message(self) -> Message:
        """The message that starts it, or starts it again."""
        runs = list(self.checkpoints)
        head = {**self.head, "id": self.number, "runs": runs}
        return Message(head, tuple(self.checkpoints.values()) if runs else self.blobs)

    def fail(self, error: Exception) -> None:
        """End it with an error."""
        if not self.future.done():
            self.future.set_exception(error)


class Lane:
    """A worker and the tasks before it. `start` it in a running event loop, `close` it at the end."""

    def __init__(self, settings: LaneSettings, on_restart: Callable[[str], None] = lambda name: None) -> None:
        self.settings = settings
        self.waiting: list[Task] = []
        self.at_work: list[Task] = []
        self.worker: WorkerProcess | None = None
        self.device: dict[str, Any] | None = None
        self.failure: Exception | None = None
        self.restarts = 0
        self._on_restart = on_restart
        self._up = asyncio.Event()
        self._closing = False
        self._keeper: asyncio.Task[None] | None = None

    @property
    def running(self) -> Task | None:
        """The task that the worker was given first, where it is at one; its guest comes after it in `at_work`."""
        return self.at_work[0] if self.at_work else None

    async def start(self) -> None:
        """Start the worker. Raises NoDevice or WorkerLost where that fails the first time."""
        self._keeper = asyncio.create_task(self._keep())
        await self._up.wait()
        if self.failure is not None:
            failure = self.failure
            await self.close()
            raise failure

    async def close(self) -> None:
        """End the worker; what waits or runs ends with Cancelled."""
        self._closing = True
        if self._keeper is not None:
            self._keeper.cancel()
            with suppress(asyncio.CancelledError):
                await self._keeper
        for task in (*self.waiting, *self.at_work):
            task.fail(Cancelled("the server is stopping"))
        self.waiting.clear()

    def submit(self, task: Task, *, beyond_limit: bool = False) -> None:
        """Put a task into the queue. Raises QueueFull, Cancelled at the server's end, and NoDevice without a device."""
        if self._closing:
            raise Cancelled("the server is stopping")
        if isinstance(self.failure, NoDevice):
            raise self.failure
        if len(self.waiting) >= self.settings.limit and not beyond_limit:
            raise QueueFull(f"{len(self.waiting)} tasks wait already, which is the limit")
        self.waiting.append(task)
        if self.worker is not None:
            self.worker.inbox.put_nowait(_NEW_TASK)

    def cancel(self, task: Task) -> None:
        """End a task: at once where it waits, at its next launch where it runs."""
        task.cancelled = True
        if task in self.waiting:
            self.waiting.remove(task)
            task.fail(Cancelled("cancelled"))
        elif task in self.at_work and self.worker is not None:
            self.worker.send(Message({"do": "stop", "id": task.number}))

    async def _keep(self) -> None:
        """Keep a worker running, for ever."""
        pause_s = 0.05
        while True:
            try:
                self.worker = await WorkerProcess.start(with_device=self.settings.with_device, nice=self.settings.nice)
            except (NoDevice, WorkerLost, OSError) as error:
                self._fail_all(error)
                await asyncio.sleep(pause_s)
                pause_s = min(5.0, 2 * pause_s)
                continue
            pause_s, self.failure, self.device = 0.05, None, self.worker.device
            self._up.set()
            _log.info("worker started", extra={"lane": self.settings.name, "worker": self.worker.process.pid})
            try:
                await self._work(self.worker)
            finally:
                worker, self.worker = self.worker, None
                await worker.end()
            self.restarts += 1
            self._on_restart(self.settings.name)
            _log.error("worker lost, starting another", extra={"lane": self.settings.name, "restarts": self.restarts})

    def _fail_all(self, error: Exception) -> None:
        _log.error("no worker: %s", error, extra={"lane": self.settings.name})
        self.failure = error
        self._up.set()
        # A task with more tries waits on until a worker can be started.
        for task in [waiting for waiting in self.waiting if waiting.tries == 1]:
            self.waiting.remove(task)
            task.fail(error)

    async def _work(self, worker: WorkerProcess) -> None:
        """Give tasks to a worker until it is lost."""
        watch = _Watch(worker, self.settings)
        while True:
            watch.expect(within_s=math.inf)
            while not self.waiting:
                if await watch.next() is None:
                    return
            try:
                lost = await self._do(min(self.waiting, key=_had_least), worker, watch)
            except (KeyError, ValueError, TypeError, IndexError):
                # What a damaged worker says may be anything; it is replaced like one that says nothing.
                _log.exception("a worker talks nonsense", extra={"lane": self.settings.name})
                lost = True
            if lost:
                for task in self.at_work:
                    self._lose(task)
                self.at_work.clear()
                return

    async def _do(self, task: Task, worker: WorkerProcess, watch: _Watch) -> bool:
        """Have a waiting task done; whether the worker was lost over it. One that gave way is back in the queue."""
        self.waiting.remove(task)
        self.at_work.append(task)
        begin = time.monotonic()
        task.begun = task.begun or begin
        served_before, stopping = task.served_s, False
        worker.send(task.message())
        watch.expect(within_s=self.settings.stall_timeout_s)
        if task.cancelled:
            worker.send(Message({"do": "stop", "id": task.number}))
        while task in self.at_work:
            message = await watch.next()
            if message is None:
                return True
            task.served_s = served_before + time.monotonic() - begin
            self._take(message)
            slice_s = task.served_s - served_before
            if task in self.at_work and not stopping and message.head.get("id") == task.number:
                stopping = self._should_yield(task, slice_s)
                if stopping:
                    worker.send(Message({"do": "stop", "id": task.number}))
            guest = self._guest_of(task)
            if guest is not None:
                arrived = time.monotonic()
                if await self._do(guest, worker, watch):
                    return True
                begin += time.monotonic() - arrived
        return False

    def _take(self, message: Message) -> None:
        """Take in what the worker says of a task that it is at."""
        task = next((task for task in self.at_work if task.number == message.head.get("id")), None)
        if task is None:
            return
        match message.head["say"]:
            case "checkpoint" | "progress" as say:
                if say == "checkpoint":
                    task.checkpoints[message.head["run"]] = message.blobs[0]
                    task.losses = task.slices_in_vain = 0
                task.hear(message)
            case say:
                self._finish(task, say, message)
                self.at_work.remove(task)

    def _should_yield(self, task: Task, slice_s: float) -> bool:
        # Slices that bring no checkpoint grow, so that a long step without one is finished at last.
        rivals = (*self.waiting, *(other for other in self.at_work if other is not task))
        return (
            task.resumable
            and slice_s >= self.settings.quantum_s * 2**task.slices_in_vain
            and any(rival.served_s < task.served_s for rival in rivals)
        )

    def _guest_of(self, host: Task) -> Task | None:
        """The waiting task that goes first at the next step of a task that cannot be resumed: one that had less of the
        device, and gives it back soon: it can be interrupted itself, or takes no longer than the host already had.
        """
        if host.resumable or self.at_work != [host]:
            return None
        guests = [
            waiting
            for waiting in self.waiting
            if waiting.served_s < host.served_s and (waiting.resumable or waiting.estimate_s <= host.served_s)
        ]
        return min(guests, key=_had_least, default=None)

    def _finish(self, task: Task, say: Literal["done", "stopped", "failed"] | str, message: Message) -> None:
        if task.future.done():
            return
        if say == "done":
            task.future.set_result(message)
        elif say == "failed":
            task.fail(WorkerError(message.head["error"]))
        elif task.cancelled:
            task.fail(Cancelled("cancelled"))
        else:
            task.slices_in_vain += 1
            self.waiting.append(task)

    def _lose(self, task: Task) -> None:
        """A worker died over this task: begin again where its checkpoints are, unless that was tried too often."""
        task.losses += 1
        if task.cancelled:
            task.fail(Cancelled("cancelled"))
        elif task.losses < task.tries:
            self.waiting.append(task)
        else:
            task.fail(WorkerLost("the process that owned the device was lost; another one is starting"))


def _had_least(task: Task) -> tuple[float, int]:
    return task.served_s, task.number


_NEW_TASK = Message({"say": "new-task"})
"""Put into the inbox of a worker, it ends the wait of one that has nothing to do."""


class _Watch:
    """Messages of a worker, with the two clocks that find one that hangs: its beats, and its getting further."""

    def __init__(self, worker: WorkerProcess, settings: LaneSettings) -> None:
        self._worker = worker
        self._settings = settings
        self._alive_by = 0.0
        self._heard()
        self.expect(within_s=math.inf)

    def expect(self, within_s: float) -> None:
        """From now on the worker has to get further within so many seconds, again and again."""
        self._within_s = within_s
        self._further_by = time.monotonic() + within_s

    async def next(self) -> Message | None:
        """The next message, be it a beat; None where the worker ended, shows no life, or does not get further."""
        try:
            message = await self._arrived()
        except asyncio.QueueEmpty:
            self._log_hang("no sign of life")
            return None
        say = message.head.get("say") if message is not None else None
        if say not in ("beat", "new-task"):
            self.expect(self._within_s)
        elif time.monotonic() > self._further_by:
            self._log_hang("a task does not get further")
            return None
        return message

    async def _arrived(self) -> Message | None:
        """The next message. Raises asyncio.QueueEmpty where the worker itself is silent for longer than two beats may
        be apart.
        """
        inbox = self._worker.inbox
        try:
            async with asyncio.timeout_at(self._alive_by):
                message = await inbox.get()
        except TimeoutError:
            # If this process was the one that stood still, what arrived meanwhile is read now.
            await asyncio.sleep(0.05)
            while (message := inbox.get_nowait()) is _NEW_TASK:
                pass
        if message is not _NEW_TASK:
            self._heard()
        return message

    def _heard(self) -> None:
        self._alive_by = asyncio.get_running_loop().time() + self._settings.beat_timeout_s

    def _log_hang(self, why: str) -> None:
        _log.error("worker hangs: %s", why, extra={"lane": self._settings.name, "worker": self._worker.process.pid})
