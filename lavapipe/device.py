"""The device: opens a Vulkan driver, makes buffers and pipelines, runs work, and closes it all in reverse order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from types import TracebackType
from typing import Self

import numpy.typing as npt

from lavapipe import drivers, vectors
from lavapipe.buffer import Budget, Buffer
from lavapipe.commands import Commands, Dispatch
from lavapipe.errors import InvalidArgument, ValidationFailed
from lavapipe.instance import Instance
from lavapipe.logical import Logical
from lavapipe.physical import DeviceInfo, choose, driver_threads
from lavapipe.pipeline import Pipeline
from lavapipe.resource import Owner, Resource
from lavapipe.submission import DeviceTime, Submission

_GIB = 1 << 30


class Device:
    """An open Vulkan device; a context manager. Make one with `Device.open`.

    What it made and was not closed lives until the device is closed, which waits for submitted work. A device may be
    used by several threads. It is of no use in a forked child process.
    """

    def __init__(self, instance: Instance, name: str | None, memory_limit_bytes: int) -> None:
        self.messages = instance.messages
        self.physical = choose(instance, name)
        self.logical = Logical(instance, self.physical)
        self._info = self.physical.info
        if self._info.is_lavapipe:
            self._info = replace(self._info, threads=driver_threads())
        self.owner = Owner()
        self.budget = Budget(memory_limit_bytes)
        self._closed = False

    @classmethod
    def open(
        cls,
        name: str | None = None,
        *,
        validation: bool = False,
        memory_limit_bytes: int = 2 * _GIB,
        shader_cache: bool = True,
    ) -> Device:
        """Open lavapipe, or the Vulkan device with `name` in its name or in that of its driver.

        Where VK_DRIVER_FILES or VK_ICD_FILENAMES is set, that choice of drivers is respected. With `validation`, a
        message of the validation layer is a ValidationFailed at the next call. `memory_limit_bytes` bounds all
        buffers together. Without `shader_cache` the driver compiles every shader anew, as if it had never seen it.
        Raises DeviceNotFound with one line that says what to run or unset.
        """
        if memory_limit_bytes <= 0:
            raise InvalidArgument(f"memory_limit_bytes={memory_limit_bytes}: a positive number of bytes")
        cached = nullcontext() if shader_cache else drivers.without_shader_cache()
        with ExitStack() as undo, cached, vectors.widest():
            instance = Instance(validation=validation, any_driver=name is not None)
            undo.callback(instance.close)
            device = cls(instance, name, memory_limit_bytes)
            undo.pop_all()
        device.check_messages()
        return device

    @property
    def info(self) -> DeviceInfo:
        """Names, versions and limits of the device and its driver."""
        return self._info

    @property
    def live_objects(self) -> int:
        """How many buffers, pipelines and submissions still hold Vulkan objects."""
        return len(self.owner)

    def buffer(self, shape: int | tuple[int, ...], dtype: npt.DTypeLike) -> Buffer:
        """A storage buffer of zeros. Raises OutOfMemory over the memory limit, InvalidArgument for a bad shape."""
        self._check_open()
        buffer = Buffer(self, shape, dtype)
        self.check_messages()
        return buffer

    def pipeline(
        self,
        spirv: bytes,
        *,
        buffers: int,
        push_constant_bytes: int = 0,
        specialization: Mapping[int, int | float | bool] | None = None,
        name: str = "",
    ) -> Pipeline:
        """A compute pipeline of a SPIR-V module whose storage buffers are set 0, bindings 0 ... `buffers` - 1.

        `specialization` gives values by constant id, converted to the type that the shader declares. `name` is for
        error messages. Raises InvalidArgument where module and arguments disagree, DriverError where the driver
        refuses the module.
        """
        self._check_open()
        pipeline = Pipeline(
            self,
            spirv,
            buffers=buffers,
            push_constant_bytes=push_constant_bytes,
            specialization=specialization or {},
            name=name,
        )
        self.check_messages()
        return pipeline

    def record(self) -> Commands:
        """An empty recording."""
        self._check_open()
        return Commands(self)

    def run(
        self,
        pipeline: Pipeline,
        buffers: Sequence[Buffer],
        groups: tuple[int, int, int],
        push_constants: bytes = b"",
        *,
        timeout_s: float | None = None,
    ) -> DeviceTime:
        """Record one dispatch, submit it and wait for it: see `Commands.dispatch` and `Submission.wait`."""
        commands = self.record()
        commands.dispatch(pipeline, buffers, groups, push_constants)
        return commands.submit().wait(timeout_s)

    def submit(self, dispatches: Sequence[Dispatch], *, timed: bool) -> Submission:
        """Start recorded work; `Commands.submit` is the door to it."""
        self._check_open()
        submission = Submission(self, dispatches, timed=timed)
        self.check_messages()
        return submission

    def check_messages(self) -> None:
        """Raise ValidationFailed with what the validation layer said since the last call, if anything."""
        self.messages.check()

    def check_mine(self, thing: Resource) -> None:
        """Raise InvalidArgument for a thing that another device made."""
        if not thing.belongs_to(self.owner):
            raise InvalidArgument(f"this {type(thing).__name__.lower()} belongs to another device")

    def close(self) -> None:
        """Wait for submitted work, close everything in reverse order of creation; again is harmless.

        Raises ValidationFailed where the validation layer has something to say about that.
        """
        if self._closed:
            return
        self._closed = True
        if self.owner.same_process:
            try:
                self.owner.close_all()
            finally:
                self.logical.release()
            self.check_messages()

    def _check_open(self) -> None:
        self.owner.check_process()
        if self._closed:
            raise InvalidArgument("this device is closed")

    def __enter__(self) -> Self:
        self._check_open()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.close()
        except ValidationFailed as failure:
            if error is None:
                raise
            error.add_note(str(failure))
