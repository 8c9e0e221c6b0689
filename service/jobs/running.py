"""Jobs: long questions in the background, which can be watched, cancelled, and gone on with after a restart."""

from __future__ import annotations

import asyncio
import logging
import secrets
import time
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field, replace
from typing import Any

from service.jobs.answers import Answers
from service.jobs.asked import Asked
from service.jobs.estimates import Estimate
from service.jobs.store import Job
from service.worker.kinds import KINDS
from service.worker.lane import Cancelled, Lane, Task
from service.worker.protocol import Message

TRIES = 3
"""Workers that a job may lose in a row without getting further."""

CANCEL_S = 10.0
"""A step that cannot be interrupted may take longer; the job then still says `running`, and ends after it."""

Event = tuple[str, dict[str, Any]]
_log = logging.getLogger("samplerscope.jobs")


@dataclass(eq=False)
class _Live:
    """A job that waits or runs: its task, its latest partial statistics, and who watches."""

    job: Job
    task: Task
    partials: dict[int, dict[str, Any]] = field(default_factory=dict)
    unsaved: dict[str, bytes] = field(default_factory=dict)
    saving: bool = False
    watchers: set[asyncio.Queue[Event | None]] = field(default_factory=set)
    runner: asyncio.Task[None] | None = None

    def tell(self, name: str, data: dict[str, Any]) -> None:
        for watcher in self.watchers:
            # A watcher that does not read gets the newest events; what is lost comes again, more precise.
            if watcher.full():
                watcher.get_nowait()
            watcher.put_nowait((name, data))


class Jobs:
    """The jobs of a server. `describe` makes the problem of an error, `on_state` hears every change of state."""

    def __init__(
        self,
        answers: Answers,
        lane: Lane,
        describe: Callable[[Exception], dict[str, Any]],
        on_state: Callable[[str], None] = lambda state: None,
    ) -> None:
        self._answers = answers
        self._store = answers.store
        self._lane = lane
        self._describe = describe
        self._on_state = on_state
        self._live: dict[str, _Live] = {}
        # Jobs whose end could not be stored: there they are unfinished, and the next server goes on with them.
        self._ended: dict[str, Job] = {}
        self._stopping = False

    async def resume(self) -> None:
        """Go on with the jobs that an earlier server did not finish."""
        for job in await self._answers.on_disk(self._store.unfinished_jobs):
            checkpoints = await self._answers.on_disk(self._store.checkpoints, job.id)
            _log.info("going on with a job", extra={"job": job.id, "runs_begun": len(checkpoints)})
            self._launch(replace(job, state="queued"), checkpoints, beyond_limit=True)

    async def submit(self, asked: Asked, estimate: Estimate) -> Job:
        """Start a job, or return the one that is at the same question already. Raises QueueFull and NoDevice."""
        stored = await self._answers.find(asked.key)
        if (same := self.at(asked.key)) is not None:
            return same
        now = time.time()
        job = Job(
            id=secrets.token_hex(12),
            key=asked.key,
            kind=asked.kind,
            scene=asked.question.scene.model_dump(mode="json"),
            state="queued",
            created=now,
            updated=now,
            done=0,
            total=estimate.samples,
            estimate_s=estimate.seconds,
        )
        if stored is not None:
            job = replace(job, state="done", done=job.total)
            await self._answers.on_disk(self._store.keep_job, job)
            return job
        live = self._launch(job, {})
        try:
            await self._answers.on_disk(self._store.keep_job, job)
        except Exception:
            self._lane.cancel(live.task)
            raise
        return job

    def at(self, key: str) -> Job | None:
        """The job that is at the question of this key."""
        return next((live.job for live in self._live.values() if live.job.key == key), None)

    async def job(self, job_id: str) -> Job | None:
        """The job of this id as it stands."""
        found: Job | None = self._in_memory(job_id)
        return found or await self._answers.on_disk(self._store.job, job_id)

    def _in_memory(self, job_id: str) -> Job | None:
        return self._live[job_id].job if job_id in self._live else self._ended.get(job_id)

    async def latest(self, limit: int) -> list[Job]:
        """The latest jobs, newest first."""
        jobs: list[Job] = await self._answers.on_disk(self._store.jobs, limit)
        return [self._in_memory(job.id) or job for job in jobs]

    async def cancel(self, job_id: str) -> Job | None:
        """Cancel a job, which frees the device after its next launch, and wait for that. A finished one stays."""
        live = self._live.get(job_id)
        if live is not None:
            self._lane.cancel(live.task)
            if live.runner is not None:
                await asyncio.wait({live.runner}, timeout=CANCEL_S)
        return await self.job(job_id)

    async def events(self, job_id: str) -> AsyncIterator[Event | None]:
        """What happens to a job: `progress`, `partial` (a series that plots) and at last `done`, `failed`, `cancelled`
        or `interrupted`. What is known comes first. None every few seconds of silence.
        """
        live = self._live.get(job_id)
        if live is None:
            job = await self.job(job_id)
            if job is not None:
                yield job.state, {}
            return
        queue: asyncio.Queue[Event | None] = asyncio.Queue(100)
        live.watchers.add(queue)
        try:
            yield "progress", {"technique": None, "done": live.job.done, "total": live.job.total}
            for partial in list(live.partials.values()):
                yield "partial", partial
            while True:
                try:
                    async with asyncio.timeout(10):
                        event = await queue.get()
                except TimeoutError:
                    yield None
                    continue
                yield event
                if event is None or event[0] not in ("progress", "partial"):
                    return
        finally:
            live.watchers.discard(queue)

    async def stop(self) -> None:
        """The server stops: watchers are told, and what is unfinished stays so in the store, with its checkpoints."""
        self._stopping = True
        for live in list(self._live.values()):
            live.tell("interrupted", {"message": "the server is stopping; the job goes on when it is back"})
        await self._lane.close()
        runners = {live.runner for live in self._live.values() if live.runner is not None}
        if runners:
            await asyncio.wait(runners)

    def _launch(self, job: Job, checkpoints: dict[str, bytes], *, beyond_limit: bool = False) -> _Live:
        head = {"do": "answer", "kind": job.kind, "scene": dict(job.scene), "partial": True}
        task = Task(
            head,
            resumable=KINDS[job.kind].resumable,
            estimate_s=job.estimate_s,
            tries=TRIES,
            checkpoints=checkpoints,
        )
        live = _Live(job, task)
        task.hear = lambda message: self._hear(live, message)
        self._lane.submit(task, beyond_limit=beyond_limit)
        self._live[job.id] = live
        self._on_state("queued")
        live.runner = asyncio.create_task(self._run(live))
        return live

    def _hear(self, live: _Live, message: Message) -> None:
        head = message.head
        if head["say"] == "progress":
            # A run that goes on counts from 0 until it has read its checkpoint; what was done stays done.
            done = max(live.job.done, head["done"]) if live.task.resumable else head["done"]
            live.job = replace(live.job, state="running", done=done, total=head["total"], updated=time.time())
            live.tell("progress", {"technique": head["technique"], "done": done, "total": head["total"]})
            return
        live.unsaved[head["run"]] = message.blobs[0]
        self._save(live)
        if "partial" in head:
            live.partials[head["partial"]["number"]] = head["partial"]
            live.tell("partial", head["partial"])

    def _save(self, live: _Live) -> None:
        """Store the latest checkpoints, one write at a time: those that come meanwhile go with the next."""
        if live.saving or not live.unsaved:
            return
        live.saving = True
        run, sums = live.unsaved.popitem()
        writing = asyncio.get_running_loop().create_task(
            self._answers.on_disk(self._store.keep_checkpoint, live.job, run, sums)
        )

        def written(task: asyncio.Task[Any]) -> None:
            live.saving = False
            if not task.cancelled() and (error := task.exception()) is not None:
                _log.error("a checkpoint could not be stored: %s", error, extra={"job": live.job.id})
                return
            self._save(live)

        writing.add_done_callback(written)

    async def _run(self, live: _Live) -> None:
        """Wait for the end of a job and store what became of it."""
        error: dict[str, Any] | None = None
        state = "done"
        try:
            message = await live.task.future
            self._answers.costs.learn(live.job.kind, live.job.total, message.head)
            stored = await self._answers.settle(live.job.key, message.blobs[0])
            live.job = replace(live.job, done=live.job.total)
            await self._answers.on_disk(self._store.finish_job, live.job, stored)
        except Cancelled:
            if self._stopping:
                await self._put_off(live)
                return
            state = "cancelled"
        except Exception as failure:
            state, error = "failed", self._describe(failure)
        live.job = replace(live.job, state=state, error=error, updated=time.time())
        try:
            if state != "done":
                await self._answers.on_disk(self._store.keep_job, live.job)
            await self._answers.on_disk(self._answers.prune)
        except Exception:
            _log.exception("what became of a job could not be stored", extra={"job": live.job.id})
            self._ended[live.job.id] = live.job
        self._on_state(state)
        del self._live[live.job.id]
        live.tell(state, error or {})

    async def _put_off(self, live: _Live) -> None:
        """Store how far a job is that the next server goes on with."""
        while live.unsaved:
            run, sums = live.unsaved.popitem()
            await self._answers.on_disk(self._store.keep_checkpoint, live.job, run, sums)
        await self._answers.on_disk(self._store.keep_job, live.job)
