"""The physical devices that a driver offers: choosing one, and what is known of it."""

from __future__ import annotations

import os
import re
import time
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from lavapipe import _binding as vk
from lavapipe import drivers
from lavapipe.errors import DeviceNotFound
from lavapipe.instance import Instance, no_driver

_LOOP_LIMIT = 65535
_MOST_THREADS = 32  # measured on 22.3.6
_NAMING_S = 0.25


@dataclass(frozen=True)
class DeviceInfo:
    """What is known of a device.

    `threads` are those lavapipe computes with, 1 for other drivers. `loop_limit` is the number of loop iterations, all
    loops together, after which this driver silently ends every loop of a shader invocation; None where it has no such
    limit. `timestamp_ns` is the length of a timestamp tick, None where the device has no timestamps.
    """

    name: str
    driver_name: str
    driver_version: str
    api_version: str
    threads: int
    loop_limit: int | None
    subgroup_size: int
    max_groups: tuple[int, int, int]
    max_push_constant_bytes: int
    max_buffer_bytes: int
    timestamp_ns: float | None
    is_lavapipe: bool


@dataclass(frozen=True)
class Physical:
    """A VkPhysicalDevice with the queue family and the memory types that compute work needs."""

    handle: Any
    queue_family: int
    info: DeviceInfo

    def memory_type(self, allowed: int) -> int:
        """The index of the best host-visible coherent memory type among the bits `allowed`."""
        needed = vk.VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | vk.VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
        flags = self._memory_flags
        fitting = [index for index, flag in enumerate(flags) if allowed >> index & 1 and flag & needed == needed]
        if not fitting:
            raise DeviceNotFound(f"{self.info.name} has no memory that host and device share coherently")
        # Results are read on the host: uncached memory would make that many times slower.
        return max(fitting, key=lambda index: bool(flags[index] & vk.VK_MEMORY_PROPERTY_HOST_CACHED_BIT))

    @cached_property
    def _memory_flags(self) -> list[int]:
        """The properties of every memory type."""
        properties = vk.ffi.new("VkPhysicalDeviceMemoryProperties *")
        vk.lib.vkGetPhysicalDeviceMemoryProperties(self.handle, properties)
        return [properties.memoryTypes[index].propertyFlags for index in range(properties.memoryTypeCount)]


def choose(instance: Instance, name: str | None) -> Physical:
    """The device with this in its name or driver's name, in any case; lavapipe where `name` is None.

    A driver that the user's environment names counts as the choice where `name` is None. Raises DeviceNotFound.
    """
    devices = [device for handle in instance.physical_devices() if (device := _inspect(handle)) is not None]
    if not devices:
        raise DeviceNotFound(no_driver())
    if name is not None:
        found = [device for device in devices if _answers_to(device.info, name)]
        if not found:
            known = ", ".join(device.info.name for device in devices)
            raise DeviceNotFound(f"no Vulkan device is named {name!r}; there are: {known}")
        return found[0]
    found = [device for device in devices if device.info.is_lavapipe]
    if not found and drivers.chosen_variable():
        found = devices
    if not found:
        raise DeviceNotFound(no_driver())
    return found[0]


def _answers_to(info: DeviceInfo, name: str) -> bool:
    names = [info.name, info.driver_name, "lavapipe" if info.is_lavapipe else ""]
    return any(name.casefold() in candidate.casefold() for candidate in names)


def _inspect(handle: Any) -> Physical | None:
    family = _compute_queue_family(handle)
    if family is None:
        return None
    arena = vk.Arena()
    driver = arena.struct("VkPhysicalDeviceDriverProperties")
    subgroup = arena.struct("VkPhysicalDeviceSubgroupProperties", pNext=driver)
    properties = arena.struct("VkPhysicalDeviceProperties2", pNext=subgroup)
    vk.lib.vkGetPhysicalDeviceProperties2(handle, properties)
    base = properties.properties
    if base.apiVersion < vk.API_VERSION_1_2:
        return None
    lavapipe = driver.driverID == vk.VK_DRIVER_ID_MESA_LLVMPIPE
    version = vk.text(driver.driverInfo)
    index, timestamp_bits = family
    info = DeviceInfo(
        name=vk.text(base.deviceName),
        driver_name=vk.text(driver.driverName),
        driver_version=version,
        api_version=f"{base.apiVersion >> 22 & 0x7F}.{base.apiVersion >> 12 & 0x3FF}.{base.apiVersion & 0xFFF}",
        threads=1,
        loop_limit=_loop_limit(version) if lavapipe else None,
        subgroup_size=subgroup.subgroupSize,
        max_groups=tuple(base.limits.maxComputeWorkGroupCount),
        max_push_constant_bytes=base.limits.maxPushConstantsSize,
        max_buffer_bytes=base.limits.maxStorageBufferRange,
        timestamp_ns=base.limits.timestampPeriod if timestamp_bits else None,
        is_lavapipe=lavapipe,
    )
    return Physical(handle, index, info)


def _compute_queue_family(handle: Any) -> tuple[int, int] | None:
    families = vk.enumerate_all("VkQueueFamilyProperties", "vkGetPhysicalDeviceQueueFamilyProperties", handle)
    for index, family in enumerate(families):
        if family.queueFlags & vk.VK_QUEUE_COMPUTE_BIT:
            return index, family.timestampValidBits
    return None


def driver_threads() -> int:
    """How many threads lavapipe computes with in this process, once a device is open.

    They are counted and not derived from LP_NUM_THREADS and the processors: the driver has an upper limit of its own,
    and goes on with fewer, without a word, where the system refuses threads.
    """
    setting = os.environ.get("LP_NUM_THREADS", "")
    wanted = int(setting) if setting.isdecimal() else len(os.sched_getaffinity(0))
    deadline = time.monotonic() + _NAMING_S
    # A thread gives itself its name when it first runs, which may be a moment after the device is there.
    while (count := _named_threads()) < min(wanted, _MOST_THREADS) and time.monotonic() < deadline:
        time.sleep(0.001)
    # With LP_NUM_THREADS=0 there are none: the queue's own thread computes.
    return max(1, count)


def _named_threads() -> int:
    names = set()
    for file in Path("/proc/self/task").glob("*/comm"):
        with suppress(OSError):
            names.add(file.read_text().strip())
    # Every device names its threads from 0.
    return sum(re.fullmatch(r"llvmpipe-\d+", name) is not None for name in names)


def _loop_limit(driver_version: str) -> int | None:
    # Measured: 22.3.6 has the limit, 25.0.7 has not. Versions between count as limited, which is the safe side.
    match = re.match(r"Mesa (\d+)\.", driver_version)
    return None if match and int(match[1]) >= 25 else _LOOP_LIMIT
