"""Storage buffers: device memory that is a NumPy array on the host."""

from __future__ import annotations

import math
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from lavapipe import _binding as vk
from lavapipe.errors import InvalidArgument, OutOfMemory
from lavapipe.resource import Resource

if TYPE_CHECKING:
    from lavapipe.device import Device


class Budget:
    """Bytes of device memory in use, and how many there may be.

    The project keeps its own account because lavapipe overcommits: it grants any amount and the process dies later.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.used = 0

    def take(self, count: int) -> None:
        """Account for so many bytes more; raises OutOfMemory over the limit."""
        if self.used + count > self.limit:
            raise OutOfMemory(
                f"a buffer of {count:,} bytes is over the device's memory limit of {self.limit:,} bytes"
                f" ({self.used:,} in use)"
            )
        self.used += count

    def give_back(self, count: int) -> None:
        """Account for so many bytes less."""
        self.used -= count


class Buffer(Resource):
    """A storage buffer in memory that host and device share; made by `Device.buffer`.

    After `close` its array can no longer be asked for. An array taken before stays valid: the memory itself, and its
    share of the memory limit, goes with the last array that shows it.
    """

    def __init__(self, device: Device, shape: int | tuple[int, ...], dtype: npt.DTypeLike) -> None:
        self.dtype = _checked_dtype(dtype)
        self.shape = _checked_shape(shape)
        self.nbytes = math.prod(self.shape) * self.dtype.itemsize
        if self.nbytes > device.info.max_buffer_bytes:
            limit = device.info.max_buffer_bytes
            raise InvalidArgument(f"shape={shape}, dtype={self.dtype}: {self.nbytes:,} bytes, one buffer has {limit:,}")
        with ExitStack() as teardown:
            teardown.callback(self._forget_array)
            arena = vk.Arena()
            info = arena.struct("VkBufferCreateInfo", size=self.nbytes, usage=vk.VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)
            logical = device.logical.handle
            self.handle = vk.create_owned(teardown, logical, "Buffer", info)
            pages, memory = _mapped_memory(device, self.handle)
            vk.check(vk.lib.vkBindBufferMemory(logical, self.handle, memory, 0), "vkBindBufferMemory")
            flat = np.frombuffer(vk.ffi.buffer(pages, self.nbytes), dtype=np.uint8)
            flat.fill(0)
            self._array = flat.view(self.dtype).reshape(self.shape)
            super().__init__(device.owner, "buffer", teardown)

    @property
    def array(self) -> npt.NDArray[Any]:
        """The memory itself, writable, of the shape and dtype asked for; zeros at first.

        Raises InvalidArgument after `close`.
        """
        self.check_open()
        return self._array

    def _forget_array(self) -> None:
        self.__dict__.pop("_array", None)


def _checked_dtype(dtype: npt.DTypeLike) -> np.dtype[Any]:
    try:
        checked = np.dtype(dtype)
    except TypeError:
        raise InvalidArgument(f"dtype={dtype!r}: not a NumPy dtype") from None
    if checked.hasobject or checked.itemsize == 0:
        raise InvalidArgument(f"dtype={dtype!r}: a fixed number of plain bytes is needed")
    return checked


def _checked_shape(shape: int | tuple[int, ...]) -> tuple[int, ...]:
    checked = (shape,) if isinstance(shape, int | np.integer) else tuple(shape)
    if not all(isinstance(length, int | np.integer) and length > 0 for length in checked):
        raise InvalidArgument(f"shape={shape!r}: positive whole numbers are needed")
    return tuple(int(length) for length in checked)


def _mapped_memory(device: Device, buffer: Any) -> tuple[Any, Any]:
    """Allocate and map memory for a buffer: (pointer, VkDeviceMemory).

    The memory is freed when the pointer is garbage, that is with the last array made from it.
    """
    arena, logical, budget = vk.Arena(), device.logical, device.budget
    needs = vk.ffi.new("VkMemoryRequirements *")
    vk.lib.vkGetBufferMemoryRequirements(logical.handle, buffer, needs)
    size = int(needs.size)
    info = arena.struct(
        "VkMemoryAllocateInfo",
        allocationSize=size,
        memoryTypeIndex=device.physical.memory_type(needs.memoryTypeBits),
    )
    with ExitStack() as undo:
        with device.owner.lock:
            budget.take(size)
        undo.callback(budget.give_back, size)
        memory = vk.create("VkDeviceMemory", "vkAllocateMemory", logical.handle, info, vk.ffi.NULL)
        undo.callback(vk.lib.vkFreeMemory, logical.handle, memory, vk.ffi.NULL)
        address = vk.ffi.new("void **")
        vk.check(vk.lib.vkMapMemory(logical.handle, memory, 0, size, 0, address), "vkMapMemory")
        undo.pop_all()
    logical.retain()

    def free(pointer: Any) -> None:
        if device.owner.same_process:
            vk.lib.vkFreeMemory(logical.handle, memory, vk.ffi.NULL)
            with device.owner.lock:
                budget.give_back(size)
            logical.release()

    return vk.ffi.gc(address[0], free), memory
