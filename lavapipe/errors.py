"""The error tree: everything this package raises on purpose derives from `LavapipeError`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class LavapipeError(Exception):
    """The base of every error of this package.

    ::

        LavapipeError
        +-- DeviceNotFound     no such device, or no Vulkan driver, loader, layer or compiler; says what to run or unset
        +-- OutOfMemory        over the device's memory budget, or refused by the driver (also a MemoryError)
        +-- CompileError       GLSL that does not compile; carries file and line of every message
        +-- WaitTimeout        the work was not done in time; it may be waited for again (also a TimeoutError)
        +-- ValidationFailed   the validation layer had something to say
        +-- DriverError        any other Vulkan result, with its name and the call
        +-- InvalidArgument    a bad argument, with its value and what is allowed (also a ValueError)
    """


class DeviceNotFound(LavapipeError):
    """No such device, or something that must be installed is not: loader, driver, layer, glslangValidator."""


class OutOfMemory(LavapipeError, MemoryError):
    """The memory budget of the device is spent, or the driver has none left."""


class WaitTimeout(LavapipeError, TimeoutError):
    """The time limit of a wait passed before the work was done."""


class InvalidArgument(LavapipeError, ValueError):
    """An argument that cannot work, named with its value and what is allowed."""


@dataclass(frozen=True)
class Diagnostic:
    """One message of the shader compiler.

    `file` is a name as the caller knows it (the source's name, an include name, or that of a `#line` directive);
    `line` counts from 1, and is 0 where the message belongs to no line.
    """

    file: str
    line: int
    message: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.message}" if self.line else f"{self.file}: {self.message}"


class CompileError(LavapipeError):
    """GLSL that does not compile, or takes more time or memory than a compile may."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        super().__init__(tuple(diagnostics))
        self.diagnostics: tuple[Diagnostic, ...] = tuple(diagnostics)

    def __str__(self) -> str:
        return "\n".join(str(diagnostic) for diagnostic in self.diagnostics)


class ValidationFailed(LavapipeError):
    """Messages of the Vulkan validation layer: the program uses Vulkan wrongly."""

    def __init__(self, messages: Sequence[str]) -> None:
        super().__init__(tuple(messages))
        self.messages: tuple[str, ...] = tuple(messages)

    def __str__(self) -> str:
        return "\n".join(self.messages)


class DriverError(LavapipeError):
    """A Vulkan call failed.

    `result` is the name of the result (`VK_ERROR_DEVICE_LOST`), `call` that of the function, `messages` what the
    driver said about it.
    """

    def __init__(self, result: str, call: str, messages: Sequence[str] = ()) -> None:
        super().__init__(result, call, tuple(messages))
        self.result = result
        self.call = call
        self.messages: tuple[str, ...] = tuple(messages)

    def __str__(self) -> str:
        return "\n".join([f"{self.call}: {self.result}", *self.messages])
