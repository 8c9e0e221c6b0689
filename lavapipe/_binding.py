"""The only door to the `vulkan` package; every work-around for it is here.

Only its C declarations (`ffi`) and the loaded library (`lib`) are used, not its Python wrappers, because of these
faults of version 1.3.275.1:

* A structure is returned by value and its pointers are kept in a dictionary with weak keys. Nested by value in
  another structure (`VkComputePipelineCreateInfo.stage`) it dies before the call, and `pName` with it: nearly every
  pipeline creation failed. `Arena` keeps whatever a call needs until the caller's function returns.
* Results become exceptions of two unrelated families (`VkTimeout` and `VkNotReady` are no `VkError`). Plain results
  and `check` are one family, and a time-out needs no exception.
* `vkGetPipelineCacheData` has no wrapper, and a structure field that is zero is dropped.
* The debug callback is one global per structure type, shared by all instances of the process. `message_callback`
  makes one for each instance.

The package costs 30 ms to import, and its import fails where the Vulkan loader is missing. Names are therefore looked
up on first use: `vk.lib.vkCreateBuffer`, `vk.VK_QUEUE_COMPUTE_BIT`. Calls through `lib` release the GIL.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from types import ModuleType
from typing import Any

from lavapipe.errors import DeviceNotFound, DriverError, OutOfMemory

API_VERSION_1_2 = 1 << 22 | 2 << 12  # the package has no VK_API_VERSION_1_x


@functools.cache
def _package() -> ModuleType:
    try:
        import vulkan
    except OSError:
        raise DeviceNotFound("the Vulkan loader libvulkan.so.1 is not installed: run lavapipe/install.sh") from None
    return vulkan  # type: ignore[no-any-return]


def __getattr__(name: str) -> Any:
    if not name.startswith(("VK_", "ffi", "lib")):
        raise AttributeError(name)
    value = getattr(_package(), name)
    globals()[name] = value
    return value


def _ffi() -> Any:
    return _package().ffi


@functools.cache
def _structure_type(ctype: str) -> int | None:
    wrapper = getattr(_package(), ctype)
    if wrapper.__code__.co_varnames[0] != "sType":
        return None
    return int(wrapper.__defaults__[0])


@functools.cache
def result_name(result: int) -> str:
    """The name of a VkResult: `VK_ERROR_DEVICE_LOST` for -4."""
    for name, value in vars(_package()).items():
        if value == result and (
            name.startswith("VK_ERROR_") or name in ("VK_NOT_READY", "VK_TIMEOUT", "VK_INCOMPLETE")
        ):
            return name
    return f"VkResult {result}"


class Arena:
    """C structures that live as long as this object: make one a call, as a local variable."""

    def __init__(self) -> None:
        self._kept: list[object] = []

    def struct(self, ctype: str, **fields: Any) -> Any:
        """A pointer to a new structure with its `sType` filled in; what its fields point at is kept alive."""
        kind = _structure_type(ctype)
        if kind is not None:
            fields["sType"] = kind
        pointer = _ffi().new(f"{ctype} *", fields)
        self._kept.append((pointer, fields))
        return pointer

    def array(self, ctype: str, items: Iterable[Any]) -> Any:
        """A new C array of these items: handles, numbers or structures by value."""
        items = list(items)
        pointer = _ffi().new(f"{ctype}[]", items)
        self._kept.append((pointer, items))
        return pointer

    def text(self, value: str) -> Any:
        """A NUL-terminated string."""
        pointer = _ffi().new("char[]", value.encode())
        self._kept.append(pointer)
        return pointer

    def data(self, value: bytes) -> Any:
        """The bytes as a pointer, without a copy."""
        pointer = _ffi().from_buffer(value)
        self._kept.append(pointer)
        return pointer


def check(result: int, call: str, messages: Iterable[str] = ()) -> None:
    """Raise OutOfMemory or DriverError unless the result of this call is VK_SUCCESS."""
    if result == 0:
        return
    name = result_name(result)
    if name in ("VK_ERROR_OUT_OF_HOST_MEMORY", "VK_ERROR_OUT_OF_DEVICE_MEMORY"):
        raise OutOfMemory(f"{call}: {name}")
    raise DriverError(name, call, tuple(messages))


def create(ctype: str, call: str, *arguments: Any) -> Any:
    """Call a `vkCreate...` or `vkAllocate...` function that hands out one object; returns its handle."""
    handle = _ffi().new(f"{ctype} *")
    check(getattr(_package().lib, call)(*arguments, handle), call)
    return handle[0]


def create_owned(teardown: ExitStack, device: Any, kind: str, info: Any) -> Any:
    """Create a Vulkan object of a device (`kind` "Buffer" is a VkBuffer); the stack will destroy it."""
    lib, null = _package().lib, _ffi().NULL
    handle = create(f"Vk{kind}", f"vkCreate{kind}", device, info, null)
    teardown.callback(getattr(lib, f"vkDestroy{kind}"), device, handle, null)
    return handle


def enumerate_all(ctype: str, call: str, *arguments: Any) -> list[Any]:
    """What a Vulkan function of the form (..., count, array) lists."""
    function = getattr(_package().lib, call)
    count = _ffi().new("uint32_t *")
    check(function(*arguments, count, _ffi().NULL) or 0, call)
    items = _ffi().new(f"{ctype}[]", count[0])
    check(function(*arguments, count, items) or 0, call)
    return list(items[0 : count[0]])


def text(characters: Any) -> str:
    """A C string as Python text."""
    return str(_ffi().string(characters).decode(errors="replace"))


def instance_function(instance: Any, name: str) -> Any:
    """An extension's function of this instance."""
    arena = Arena()
    return _ffi().cast(f"PFN_{name}", _package().lib.vkGetInstanceProcAddr(instance, arena.text(name)))


def message_callback(receive: Callable[[int, str], None]) -> Any:
    """A callback for VkDebugUtilsMessengerCreateInfoEXT, given the kinds (bits) and text of each message.

    Keep it for as long as the messenger.
    """

    def forward(severity: int, kinds: int, message: Any, user: Any) -> int:
        receive(kinds, text(message.pMessage))
        return 0

    return _ffi().callback("PFN_vkDebugUtilsMessengerCallbackEXT", forward)
