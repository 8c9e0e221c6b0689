"""All that a running server holds, and the one way from a question to a response."""

from __future__ import annotations

import asyncio
import gc
import math
from collections.abc import Coroutine, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from starlette.requests import Request
from starlette.responses import Response

from service.api.jobs_json import accepted
from service.api.metrics import Metrics
from service.api.problems import ClientGone, OverBudget, problem_of
from service.api.representations import chosen_format, represent
from service.api.settings import Settings
from service.catalogue import Catalogue, load_catalogue
from service.errors import Problem
from service.formats import FORMATS, formats_of
from service.jobs.answers import Answers
from service.jobs.asked import Asked, ask, own_key
from service.jobs.estimates import Costs, Estimate
from service.jobs.running import Jobs
from service.jobs.store import Store, Stored
from service.scene import Scene
from service.worker.kinds import KINDS
from service.worker.lane import Lane, LaneSettings

T = TypeVar("T")

PICTURE_BEAT_TIMEOUT_S = 30.0
"""The library that draws pictures holds the interpreter while it does: its worker gives no sign of life meanwhile."""

OWN_FILES_WAITING = 4
"""A file may take most of a minute: more that wait would only wait in vain."""

_COUNTLESS = 10**15
"""More series than this are so many: a product of a thousand sweeps has a thousand digits."""

_QUICK_SERIES = 200
"""Questions of more series are checked in a thread; of fewer, at once, which takes less than the switch would."""


@dataclass
class Services:
    """A server's parts. `start` and `stop` them in the event loop that uses them."""

    settings: Settings
    catalogue: Catalogue
    metrics: Metrics
    store: Store
    direct: Lane
    background: Lane
    encoding: Lane
    costs: Costs
    answers: Answers
    jobs: Jobs
    own: Lane | None = None
    formats: dict[str, list[str]] = field(default_factory=dict)

    @classmethod
    def create(cls, settings: Settings) -> Services:
        """Open the store and lay out the rest. BadInput where the store's folder is no good. In an event loop."""
        metrics = Metrics()

        def lane(name: str, **more: Any) -> Lane:
            clocks: dict[str, Any] = {
                "beat_timeout_s": settings.beat_timeout_s,
                "stall_timeout_s": settings.stall_timeout_s,
            }
            made = Lane(LaneSettings(name, **clocks | more), lambda name: metrics.restarts.labels(name).inc())
            metrics.queue.labels(name).set_function(lambda: len(made.waiting))
            metrics.running.labels(name).set_function(lambda: made.running is not None)
            return made

        store = Store(settings.data_dir, settings.store_limit_bytes, settings.store_max_age_s, settings.store_max_jobs)
        # The server itself answers first, then small questions, then pictures and jobs.
        direct = lane("direct", nice=5, limit=settings.queue_limit)
        background = lane("jobs", nice=10, limit=settings.jobs_limit, quantum_s=1.0)
        encoding = lane(
            "encode", nice=7, limit=settings.queue_limit, with_device=False, beat_timeout_s=PICTURE_BEAT_TIMEOUT_S
        )
        costs = Costs()
        answers = Answers(
            store,
            direct,
            encoding,
            costs,
            settings.client_limit,
            settings.request_timeout_s,
            lambda how, kind: metrics.answers.labels(how, kind).inc(),
        )
        jobs = Jobs(
            answers, background, lambda error: problem_of(error)[0], lambda state: metrics.jobs.labels(state).inc()
        )
        own = None
        if settings.own_glsl:
            stall_s = settings.own_glsl_limit_s + settings.stall_timeout_s
            own = lane("own", nice=10, limit=OWN_FILES_WAITING, with_device=False, stall_timeout_s=stall_s)
        return cls(settings, load_catalogue(), metrics, store, direct, background, encoding, costs, answers, jobs, own)

    async def start(self) -> None:
        """Start the workers and go on with unfinished jobs. Raises NoDevice."""
        await asyncio.gather(*(lane.start() for lane in (*self._answering(), self.background)))
        await self.jobs.resume()
        # What is loaded by now stays: collections that walk through it would come between requests.
        gc.freeze()

    async def stop(self) -> None:
        """Put jobs off, end the workers, store what is not stored yet."""
        await self.jobs.stop()
        await self.end_answers()
        self.answers.close()
        self.store.close()

    async def end_answers(self) -> None:
        """End whatever is being answered directly."""
        await asyncio.gather(*(lane.close() for lane in self._answering()))

    def _answering(self) -> list[Lane]:
        return [lane for lane in (self.direct, self.encoding, self.own) if lane is not None]

    async def ask(self, kind: str, scene: Scene) -> Asked:
        """Check a scene against the catalogue and the limits. Raises BadInput."""
        series = self.check_cells(scene)
        if series > _QUICK_SERIES:
            asked = await asyncio.to_thread(ask, kind, scene, self.catalogue, self.direct.device)
        else:
            asked = ask(kind, scene, self.catalogue, self.direct.device)
        samples = KINDS[kind].samples(asked.question)
        if samples > self.settings.max_samples:
            limit = self.settings.max_samples
            problem = Problem("estimator.samples", f"{samples} in all cells", f"at most {limit} in all cells")
            raise OverBudget(problem, samples, limit)
        return asked

    def check_cells(self, scene: Scene) -> int:
        """How many series a scene may have. Raises BadInput where its cells are beyond the limit."""
        series = self._series_at_most(scene)
        cells = series * len(scene.angles_deg)
        if cells > self.settings.max_cells:
            problem = Problem("parameters", f"{cells} cells", f"at most {self.settings.max_cells} (series x angles)")
            raise OverBudget(problem, cells, self.settings.max_cells)
        return series

    def _series_at_most(self, scene: Scene) -> int:
        """How many series a scene may have, without making them."""
        together = {name for group in scene.zip for name in group[1:]}
        lengths = [len(values) for name, values in scene.parameters.items() if name not in together]
        techniques = len(scene.techniques) if scene.techniques else len(self.catalogue.techniques)
        return min(math.prod(lengths) * techniques, _COUNTLESS)

    async def estimate(self, asked: Asked) -> Estimate:
        """What an answer will cost."""
        if asked.question.scene.reference:
            return await asyncio.to_thread(self.costs.estimate, asked.kind, asked.question)
        return self.costs.estimate(asked.kind, asked.question)

    async def respond(self, request: Request, kind: str, scene: Scene, figure: str | None = None) -> Response:
        """The answer to a question in the format the client wants, or 202 and a job where it takes long."""
        timings = request.scope["state"]["timings"]
        format_ = self._format(request, kind)
        asked = await self.ask(kind, scene)
        stored = await self.answers.find(asked.key)
        if stored is not None:
            self.metrics.answers.labels("hit", kind).inc()
        elif (job := self.jobs.at(asked.key)) is not None:
            return accepted(job)
        else:
            estimate = await self.estimate(asked)
            patient = "respond-async" in request.headers.get("prefer", "")
            # What is long and cannot give way to others never stands before small questions.
            yielding = KINDS[kind].resumable or KINDS[kind].brief
            if patient or not yielding or estimate.seconds > self.settings.direct_limit_s:
                return accepted(await self.jobs.submit(asked, estimate))
            answered = await unless_gone(request, self.answers.compute(asked, _client(request)))
            stored = answered.stored
            timings |= answered.timings
            self.metrics.device_ms.inc(answered.timings.get("device", 0.0))
        return await self._represent(request, asked.key, stored, format_, figure)

    async def respond_own(self, request: Request, task: str, arguments: Mapping[str, Any]) -> Response:
        """The answer to a question about a user's own file. Only where the setting allows such questions."""
        assert self.own is not None
        format_ = self._format(request, task)
        key = own_key(task, arguments, self.direct.device)
        stored = await self.answers.find(key)
        if stored is not None:
            self.metrics.answers.labels("hit", f"own-{task}").inc()
        else:
            limit_s = self.settings.own_glsl_limit_s
            work = self.answers.compute_own(key, self.own, task, arguments, limit_s, _client(request))
            answered = await unless_gone(request, work)
            stored = answered.stored
            request.scope["state"]["timings"] |= answered.timings
        return await self._represent(request, key, stored, format_, None)

    def _format(self, request: Request, kind: str) -> str:
        if kind not in self.formats:
            self.formats[kind] = formats_of(kind)
        return chosen_format(request, self.formats[kind])

    async def _represent(
        self, request: Request, key: str, stored: Stored, format_: str, figure: str | None
    ) -> Response:
        if format_ != "json":
            work = self.answers.encode(key, stored, format_, figure, _client(request))
            encoded = await unless_gone(request, work)
            stored = encoded.stored
            timings = {name: ms for name, ms in encoded.timings.items() if name == "encode"}
            request.scope["state"]["timings"] |= timings
        return represent(request, stored, FORMATS[format_].media_type)


def _client(request: Request) -> str:
    return request.client.host if request.client else ""


async def unless_gone(request: Request, work: Coroutine[Any, Any, T]) -> T:
    """The outcome of work that is cancelled when the client goes away."""
    waiting = asyncio.current_task()
    assert waiting is not None
    gone = False

    async def watch() -> None:
        nonlocal gone
        while (await request.receive())["type"] != "http.disconnect":
            pass
        gone = True
        waiting.cancel()

    watching = asyncio.create_task(watch())
    try:
        return await work
    except asyncio.CancelledError:
        if not gone:
            raise
        waiting.uncancel()
        raise ClientGone from None
    finally:
        watching.cancel()
