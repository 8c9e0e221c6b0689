"""The engine: an open device, the catalogue, and the pipelines built so far."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from types import TracebackType
from typing import Any, Literal, get_args

from lavapipe import Cache, CompileError, Device, Pipeline, compile_glsl, default_cache
from service.catalogue import Catalogue, Entry, hemisphere, load_catalogue
from service.variant import Precision, compose, variant_name

Job = Literal["statistics", "probe", "quadrature", "cost"]
BUFFERS: Mapping[Job, int] = {"statistics": 4, "probe": 4, "quadrature": 7, "cost": 2}
PUSH_CONSTANT_BYTES: Mapping[Job, int] = {"statistics": 16, "probe": 8, "quadrature": 4, "cost": 8}


class Engine:
    """Everything a computation needs of the machine. A context manager: closing it frees the device."""

    def __init__(self, device: Device, catalogue: Catalogue, cache: Cache) -> None:
        self.device = device
        self.catalogue = catalogue
        self.cache = cache
        self.pause: Callable[[], None] = lambda: None
        """Called whenever a pipeline is asked for, which every step of long work begins with; it may raise."""
        self._compiled: dict[tuple[Entry, Entry, Job, Precision], bytes | CompileError] = {}
        self._pipelines: dict[tuple[object, ...], Pipeline] = {}
        self._warm: set[Pipeline] = set()

    @classmethod
    def open(cls, catalogue: Catalogue | None = None, *, device: str | None = None) -> Engine:
        """Open the device of this name (default: lavapipe) with the catalogue of this installation, or another one."""
        return cls(Device.open(device), catalogue or load_catalogue(), default_cache())

    def __enter__(self) -> Engine:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free pipelines and device."""
        self._pipelines.clear()
        self._warm.clear()
        self.device.close()

    def pipeline(
        self,
        model: Entry,
        technique: Entry,
        job: Job,
        specialization: Mapping[int, int | float | bool] | None = None,
        precision: Precision = "float",
    ) -> Pipeline:
        """The pipeline of a job for a model and a technique, built once. CompileError has the file's own lines."""
        self.pause()
        constants = dict(specialization or {})
        key = (model, technique, job, precision, tuple(sorted(constants.items())))
        if key not in self._pipelines:
            self._pipelines[key] = self.device.pipeline(
                self._spirv(model, technique, job, precision),
                buffers=BUFFERS[job],
                push_constant_bytes=PUSH_CONSTANT_BYTES[job],
                specialization=constants,
                name=variant_name(model, [technique], job, precision),
            )
        return self._pipelines[key]

    def compile_all(self, pairs: Iterable[tuple[Entry, Entry]], truth: bool) -> None:
        """Have every job of these models and techniques ready as SPIR-V, so that no compiler is needed from here on.
        With `truth` also what the float64 truth of a user's own file needs.

        A job that does not compile raises CompileError when its pipeline is asked for.
        """
        for model, technique in pairs:
            for job in get_args(Job):
                doubled = job == "probe" or (truth and job == "quadrature")
                for precision in get_args(Precision) if doubled else ("float",):
                    with suppress(CompileError):
                        self._spirv(model, technique, job, precision)
            for precision in get_args(Precision) if truth else ():
                with suppress(CompileError):
                    self._spirv(model, hemisphere(), "quadrature", precision)

    def _spirv(self, model: Entry, technique: Entry, job: Job, precision: Precision) -> bytes:
        key = (model, technique, job, precision)
        if key not in self._compiled:
            variant = compose(self.catalogue, model, [technique], job, precision)
            try:
                self._compiled[key] = compile_glsl(
                    variant.source, name=variant.name, include=variant.includes, cache=self.cache
                )
            except CompileError as error:
                self._compiled[key] = error
        compiled = self._compiled[key]
        if isinstance(compiled, CompileError):
            raise compiled
        return compiled

    def run_block(self, begin: float, **facts: Any) -> dict[str, Any]:
        """The block `run` of a result: device and driver, these facts, and the milliseconds since `begin`.

        begin: by `time.perf_counter`.
        """
        info = self.device.info
        elapsed_ms = 1e3 * (time.perf_counter() - begin)
        return {"device": info.name, "driver": info.driver_version, **facts, "elapsed_ms": elapsed_ms}

    def first_use(self, pipeline: Pipeline) -> bool:
        """Whether this pipeline was not asked for before: the driver compiles at the first dispatch."""
        first = pipeline not in self._warm
        self._warm.add(pipeline)
        return first
