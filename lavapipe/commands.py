"""Recording: a list of dispatches that runs as one submission."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral
from typing import TYPE_CHECKING

from lavapipe.buffer import Buffer
from lavapipe.errors import InvalidArgument
from lavapipe.pipeline import Pipeline
from lavapipe.submission import Submission

if TYPE_CHECKING:
    from lavapipe.device import Device


@dataclass(frozen=True)
class Dispatch:
    """One dispatch; `barrier` makes it wait for those before it."""

    pipeline: Pipeline
    buffers: tuple[Buffer, ...]
    groups: tuple[int, int, int]
    push_constants: bytes
    barrier: bool


class Commands:
    """A recording, made by `Device.record`. It holds no Vulkan objects before `submit`, and can be submitted again."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._dispatches: list[Dispatch] = []

    def dispatch(
        self,
        pipeline: Pipeline,
        buffers: Sequence[Buffer],
        groups: tuple[int, int, int],
        push_constants: bytes = b"",
        *,
        barrier: bool = True,
    ) -> None:
        """Add a dispatch of `groups` workgroups, buffer i at binding i.

        It sees what the dispatches before it wrote; with `barrier=False` it may run beside them. Raises
        InvalidArgument where an argument does not fit the pipeline or the device.
        """
        buffers = tuple(buffers)
        for thing in (pipeline, *buffers):
            thing.check_open()
            self._device.check_mine(thing)
        if len(buffers) != pipeline.buffers:
            raise InvalidArgument(f"buffers: {len(buffers)} given, the pipeline has {pipeline.buffers}")
        if len(push_constants) != pipeline.push_constant_bytes:
            raise InvalidArgument(
                f"push_constants: {len(push_constants)} bytes given, the pipeline has {pipeline.push_constant_bytes}"
            )
        self._dispatches.append(
            Dispatch(pipeline, buffers, self._checked_groups(groups), bytes(push_constants), barrier)
        )

    def submit(self, *, timed: bool = True) -> Submission:
        """Start the work; returns at once. Raises InvalidArgument where nothing was recorded.

        `timed=False` does without the device's clock, which on lavapipe takes longer than a small dispatch itself.
        """
        if not self._dispatches:
            raise InvalidArgument("nothing to submit: no dispatch was recorded")
        for dispatch in self._dispatches:
            for thing in (dispatch.pipeline, *dispatch.buffers):
                thing.check_open()
        return self._device.submit(tuple(self._dispatches), timed=timed)

    def _checked_groups(self, groups: tuple[int, int, int]) -> tuple[int, int, int]:
        limits = self._device.info.max_groups
        fits = [isinstance(n, Integral) and 1 <= n <= limit for n, limit in zip(groups, limits, strict=False)]
        if len(groups) != 3 or not all(fits):
            raise InvalidArgument(f"groups={groups!r}: three counts from 1 to {limits}")
        x, y, z = (int(count) for count in groups)
        return x, y, z
