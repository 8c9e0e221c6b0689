"""The engine: an open device, the catalogue, and the pipelines built so far."""

from __future__ import annotations

from collections.abc import Mapping
from types import TracebackType
from typing import Literal

from lavapipe import Cache, Device, Pipeline, compile_glsl, default_cache
from service.catalogue import Catalogue, Entry, load_catalogue
from service.variant import Precision, compose

Job = Literal["statistics", "probe", "quadrature", "cost"]
_BUFFERS: Mapping[Job, int] = {"statistics": 4, "probe": 4, "quadrature": 7, "cost": 2}
_PUSH_CONSTANT_BYTES: Mapping[Job, int] = {"statistics": 16, "probe": 8, "quadrature": 4, "cost": 8}


class Engine:
    """Everything a computation needs of the machine. A context manager: closing it frees the device."""

    def __init__(self, device: Device, catalogue: Catalogue, cache: Cache) -> None:
        self.device = device
        self.catalogue = catalogue
        self.cache = cache
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
        specialization: Mapping[int, int | bool] | None = None,
        precision: Precision = "float",
    ) -> Pipeline:
        """The pipeline of a job for a model and a technique, built once. CompileError has the file's own lines."""
        constants = dict(specialization or {})
        key = (model, technique, job, precision, tuple(sorted(constants.items())))
        if key not in self._pipelines:
            variant = compose(self.catalogue, model, technique, job, precision)
            spirv = compile_glsl(variant.source, name=variant.name, include=variant.includes, cache=self.cache)
            self._pipelines[key] = self.device.pipeline(
                spirv,
                buffers=_BUFFERS[job],
                push_constant_bytes=_PUSH_CONSTANT_BYTES[job],
                specialization=constants,
                name=variant.name,
            )
        return self._pipelines[key]

    def first_use(self, pipeline: Pipeline) -> bool:
        """Whether this pipeline was not asked for before: the driver compiles at the first dispatch."""
        first = pipeline not in self._warm
        self._warm.add(pipeline)
        return first
