"""The probe: a model and a technique evaluated at single inputs, in float32 as a renderer would, or in float64."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lavapipe import CompileError, Pipeline
from service.catalogue import Entry, Parameter
from service.engine import Engine
from service.errors import SamplerscopeError, ShaderFileError
from service.variant import Precision

Array = NDArray[Any]
_DTYPES = {"float": np.float32, "double": np.float64}
_GROUP = 64
LAUNCH_POINTS = 1 << 18
TIMEOUT_S = 120.0


class LoopLimitReached(SamplerscopeError):
    """A loop of the shader was ended at the limit: what came after it is not what the file says."""


@dataclass(frozen=True)
class Values:
    """What the probe found, each of shape (n,) but `wi` (n, 3); float32 or float64 as asked, never laundered.

    pdf is the density that came with a drawn direction (0 where wi was given), direction_pdf the technique's own
    answer for wi. weight is f cos/pdf, with direction_pdf where wi was given. albedo is 0 where the model declares
    none.
    """

    wi: Array
    pdf: Array
    brdf: Array
    direction_pdf: Array
    weight: Array
    albedo: Array

    def __getitem__(self, where: Any) -> Values:
        return Values(*(getattr(self, name)[where] for name in self.__dataclass_fields__))


class Probe:
    """A model and a technique, ready to be evaluated. Its parameters are those of `names`, in that order.

    `fixed` parameters have their value as their only one in `declared`, the ranges that checks sweep.
    """

    def __init__(
        self, engine: Engine, model: Entry, technique: Entry, fixed: Mapping[str, float] = MappingProxyType({})
    ) -> None:
        self.engine = engine
        self.model = model
        self.technique = technique
        self.declared = {
            name: Parameter(min=fixed[name], max=fixed[name], default=fixed[name]) if name in fixed else parameter
            for name, parameter in engine.catalogue.parameters_of(model, technique).items()
        }
        self.names = tuple(self.declared)

    def draw(self, wo: Array, u: Array, parameters: Array, precision: Precision = "float") -> Values:
        """Draw a direction for each row: wo (n, 3), u (n, 2), parameters (n, p), each broadcast from (1, ...).

        Raises CompileError for code that does not compile, LoopLimitReached, and what the device raises.
        """
        return self._run(wo, u, parameters, precision, draw=True)

    def evaluate(self, wo: Array, wi: Array, parameters: Array, precision: Precision = "float") -> Values:
        """Evaluate at given directions: wo and wi (n, 3), parameters (n, p), each broadcast from (1, ...)."""
        return self._run(wo, wi, parameters, precision, draw=False)

    def _run(self, wo: Array, value: Array, parameters: Array, precision: Precision, draw: bool) -> Values:
        wo, value, parameters = (np.atleast_2d(np.asarray(a)) for a in (wo, value, parameters))
        count = max(len(wo), len(value), len(parameters))
        out = np.empty((count, 2, 4), _DTYPES[precision])
        pipeline = self._pipeline(precision, draw)
        device, dtype, width = self.engine.device, _DTYPES[precision], max(1, len(self.names))
        step = min(count, LAUNCH_POINTS)
        with (
            device.buffer((step, 2, 4), dtype) as given,
            device.buffer((step, width), dtype) as rows,
            device.buffer((step, 2, 4), dtype) as found,
            device.buffer(step, np.uint32) as done,
        ):
            for first in range(0, count, step):
                size = min(step, count - first)
                part = slice(first, first + size)
                given.array[:size, 0, :3] = wo[part] if len(wo) > 1 else wo
                given.array[:size, 1, : value.shape[1]] = value[part] if len(value) > 1 else value
                rows.array[:size, : len(self.names)] = parameters[part] if len(parameters) > 1 else parameters
                device.run(
                    pipeline,
                    [given, rows, found, done],
                    (-(-size // _GROUP), 1, 1),
                    struct.pack("<2I", size, 2),
                    timeout_s=TIMEOUT_S,
                )
                if not done.array[:size].all():
                    self._complain(int(np.argmin(done.array[:size])) + first)
                out[part] = found.array[:size]
        return Values(out[:, 0, :3], out[:, 0, 3], out[:, 1, 0], out[:, 1, 1], out[:, 1, 2], out[:, 1, 3])

    def compile(self) -> None:
        """Build the float pipelines: raises CompileError with the lines of the file before anything else runs."""
        for draw in (True, False):
            self._pipeline("float", draw)

    def _pipeline(self, precision: Precision, draw: bool) -> Pipeline:
        try:
            return self.engine.pipeline(self.model, self.technique, "probe", {0: draw}, precision)
        except CompileError as error:
            if precision == "float":
                raise
            raise ShaderFileError(f"the code compiles, but not with double in place of float: {error}") from None

    def _complain(self, index: int) -> None:
        entries = [e for e in (self.technique, self.model) if e.own] or [self.technique, self.model]
        names = " or ".join(dict.fromkeys(entry.origin for entry in entries))
        raise LoopLimitReached(
            f"{names}: loops ran to the limit of 65,535 iterations of one invocation (first at input {index}); "
            "a loop without end, or one too long for the driver"
        )
