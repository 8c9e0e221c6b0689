"""Answers to questions: from memory, from the store, or computed once for all who ask at the same time."""

from __future__ import annotations

import asyncio
import logging
from collections import Counter, OrderedDict
from collections.abc import Callable, Coroutine, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from service.errors import SamplerscopeError
from service.jobs.asked import Asked
from service.jobs.estimates import Costs
from service.jobs.store import Store, Stored
from service.worker.kinds import KINDS
from service.worker.lane import Lane, Task

MEMORY_BYTES = 64 << 20
STORE_AFTER_S = 0.05
"""Answers are stored together, so long after the first of them: storing one at once would delay its way out."""
_log = logging.getLogger("samplerscope.answers")


class TooManyRequests(SamplerscopeError):
    """One client has as many computations under way as it may."""


class TimedOut(SamplerscopeError):
    """An answer was not ready within the time limit of a request."""


@dataclass(frozen=True)
class Answered:
    """Bytes of an answer, and where its milliseconds went."""

    stored: Stored
    timings: dict[str, float]


@dataclass(eq=False)
class _Flight:
    task: asyncio.Task[Answered]
    waiters: int = 0


@dataclass
class Answers:
    """Finds answers or has them computed. `on_event` hears `hit`, `shared` or `computed` with the kind."""

    store: Store
    device_lane: Lane
    encode_lane: Lane
    costs: Costs
    client_limit: int
    timeout_s: float
    on_event: Callable[[str, str], None] = lambda event, kind: None
    _flights: dict[str, _Flight] = field(default_factory=dict)
    _memory: OrderedDict[str, Stored] = field(default_factory=OrderedDict)
    _memory_bytes: int = 0
    # Keys that are on disk, or soon will be: what is not among them need not be looked for.
    _on_disk: set[str] = field(default_factory=set)
    _unstored: dict[str, Stored] = field(default_factory=dict)
    _clients: Counter[str] = field(default_factory=Counter)
    # SQLite in a thread of its own: the event loop never waits for the disk.
    _disk: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "store"))

    def __post_init__(self) -> None:
        self._on_disk = self.store.keys()

    async def on_disk(self, work: Callable[..., Any], *values: Any) -> Any:
        """Call a method of the store in its thread."""
        return await asyncio.get_running_loop().run_in_executor(self._disk, work, *values)

    def close(self) -> None:
        """Store what is not stored yet, and wait for that."""
        self._store_all()
        self._disk.shutdown(wait=True)

    def prune(self) -> None:
        """Let go what is stored beyond the limits. In the thread of the store."""
        self._on_disk -= self.store.prune()

    async def find(self, key: str) -> Stored | None:
        """The stored answer of this key."""
        if key in self._memory:
            self._memory.move_to_end(key)
            return self._memory[key]
        if key in self._unstored:
            return self._unstored[key]
        if key not in self._on_disk:
            return None
        found: Stored | None = await self.on_disk(self.store.result, key)
        if found is None:
            self._on_disk.discard(key)
        else:
            self._remember(key, found)
        return found

    async def settle(self, key: str, content: bytes) -> Stored:
        """What is the answer of this key from now on: what came first, where a job and a direct answer were at the same
        question. To be stored at once, or soon.
        """
        stored = await self.find(key)
        if stored is None:
            stored = Stored.of(content)
            self._remember(key, stored)
        return stored

    def _remember(self, key: str, stored: Stored) -> None:
        """Hold an answer in memory, as long as there is room. It is stored, or about to be."""
        self._on_disk.add(key)
        if key not in self._memory:
            self._memory[key] = stored
            self._memory_bytes += len(stored.content)
        while self._memory_bytes > MEMORY_BYTES and len(self._memory) > 1:
            self._memory_bytes -= len(self._memory.popitem(last=False)[1].content)

    async def compute(self, asked: Asked, client: str) -> Answered:
        """Compute a direct answer, together with everyone who asks the same.

        Raises QueueFull, TooManyRequests, TimedOut, WorkerLost, NoDevice, Cancelled or WorkerError. A caller that is
        cancelled leaves; when the last one has left, the device is free again after its next launch.
        """
        head = {"do": "answer", "kind": asked.kind, "scene": asked.question.scene.model_dump(mode="json")}
        resumable = KINDS[asked.kind].resumable
        return await self._together(
            asked.key,
            asked.kind,
            client,
            lambda: self._answer(asked, Task(head, resumable=resumable)),
        )

    async def compute_own(
        self, key: str, lane: Lane, task: str, arguments: Mapping[str, Any], limit_s: float, client: str
    ) -> Answered:
        """Have a task of `service.isolation.tasks` done over a user's own file; raises as `compute` does."""
        head = {"do": "own", "task": task, "arguments": dict(arguments), "limit_s": limit_s}
        return await self._together(key, f"own-{task}", client, lambda: self._run(key, lane, Task(head)))

    async def encode(self, key: str, stored: Stored, format_: str, figure: str | None, client: str) -> Answered:
        """A stored JSON result in another format, stored as well; raises as `compute` does. A `figure` of a paper has a
        chart and a title of its own.
        """
        encoded_key = f"{key}.{figure or ''}.{format_}"
        found = await self.find(encoded_key)
        if found is not None:
            return Answered(found, {})
        head = {"do": "encode", "format": format_, "figure": figure}
        return await self._together(
            encoded_key,
            "encode",
            client,
            lambda: self._run(encoded_key, self.encode_lane, Task(head, (stored.content,))),
        )

    async def _together(
        self, key: str, kind: str, client: str, start: Callable[[], Coroutine[Any, Any, Answered]]
    ) -> Answered:
        flight = self._flights.get(key)
        self.on_event("computed" if flight is None else "shared", kind)
        if flight is None:
            if self._clients[client] >= self.client_limit:
                raise TooManyRequests(f"{self.client_limit} computations of yours are under way, which is the limit")
            flight = self._flights[key] = _Flight(asyncio.create_task(start()))
            self._clients[client] += 1
            flight.task.add_done_callback(lambda _: self._landed(key, client, flight))
        flight.waiters += 1
        try:
            return await asyncio.shield(flight.task)
        finally:
            flight.waiters -= 1
            if flight.waiters == 0 and not flight.task.done():
                if self._flights.get(key) is flight:
                    del self._flights[key]
                flight.task.cancel()

    def _landed(self, key: str, client: str, flight: _Flight | None) -> None:
        if self._flights.get(key) is flight:
            del self._flights[key]
        self._clients[client] -= 1
        if self._clients[client] <= 0:
            del self._clients[client]
        if flight is not None and not flight.task.cancelled():
            flight.task.exception()

    async def _answer(self, asked: Asked, task: Task) -> Answered:
        answered = await self._run(asked.key, self.device_lane, task)
        self.costs.learn(asked.kind, KINDS[asked.kind].samples(asked.question), task.future.result().head)
        return answered

    async def _run(self, key: str, lane: Lane, task: Task) -> Answered:
        lane.submit(task)
        try:
            async with asyncio.timeout(self.timeout_s):
                message = await task.future
        except TimeoutError:
            raise TimedOut(f"no answer within {self.timeout_s:g} s; ask for it as a job") from None
        finally:
            if not task.future.done() or task.future.cancelled():
                lane.cancel(task)
        stored = await self.settle(key, message.blobs[0])
        self._store_soon(key, stored)
        queue_ms = 1e3 * ((task.begun or task.created) - task.created)
        return Answered(stored, {"queue": queue_ms, **message.head["timings"]})

    def _store_soon(self, key: str, stored: Stored) -> None:
        if not self._unstored:
            asyncio.get_running_loop().call_later(STORE_AFTER_S, self._store_all)
        self._unstored[key] = stored

    def _store_all(self) -> None:
        if self._unstored:
            self._disk.submit(self._keep, self._unstored)
            self._unstored = {}

    def _keep(self, answers: Mapping[str, Stored]) -> None:
        try:
            self.store.keep_results(answers)
            self.prune()
        except Exception:
            _log.exception("%d answers could not be stored", len(answers))
