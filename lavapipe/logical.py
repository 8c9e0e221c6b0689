"""The logical device: a VkDevice with its queue, which lives until nothing uses it any more."""

from __future__ import annotations

import threading
from contextlib import ExitStack
from typing import Any

from lavapipe import _binding as vk
from lavapipe.instance import Instance
from lavapipe.physical import Physical

# What shaders may want, beside the basic features: field name of each structure.
_CORE_FEATURES = ("shaderFloat64", "shaderInt64", "shaderInt16", "robustBufferAccess")
_FEATURES_1_1 = ("storageBuffer16BitAccess",)
_FEATURES_1_2 = ("shaderFloat16", "shaderInt8", "storageBuffer8BitAccess", "scalarBlockLayout")


class Logical:
    """A VkDevice, its compute queue and the count of those who use it.

    NumPy views of device memory may outlive the device that made them; the VkDevice is destroyed when it has been
    released as often as it was retained (its maker counts as one).
    """

    def __init__(self, instance: Instance, physical: Physical) -> None:
        # The garbage collector may call `release` at any point of any thread, also within `retain`.
        self._lock = threading.RLock()
        self._users = 1
        with ExitStack() as teardown:
            teardown.callback(instance.close)
            self.features, self.handle = _create(teardown, physical)
            queue = vk.ffi.new("VkQueue *")
            vk.lib.vkGetDeviceQueue(self.handle, physical.queue_family, 0, queue)
            self.queue = queue[0]
            self.queue_lock = threading.Lock()
            self._teardown = teardown.pop_all()

    def retain(self) -> None:
        """Count one more user."""
        with self._lock:
            self._users += 1

    def release(self) -> None:
        """Count one user less; the last one destroys the device and its instance."""
        with self._lock:
            self._users -= 1
            last = self._users == 0
        if last:
            self._teardown.close()


def _create(teardown: ExitStack, physical: Physical) -> tuple[frozenset[str], Any]:
    arena = vk.Arena()
    enabled_1_2 = arena.struct("VkPhysicalDeviceVulkan12Features")
    enabled_1_1 = arena.struct("VkPhysicalDeviceVulkan11Features", pNext=enabled_1_2)
    enabled = arena.struct("VkPhysicalDeviceFeatures2", pNext=enabled_1_1)
    vk.lib.vkGetPhysicalDeviceFeatures2(physical.handle, enabled)
    names = {
        *_keep_only(enabled.features, _CORE_FEATURES),
        *_keep_only(enabled_1_1, _FEATURES_1_1),
        *_keep_only(enabled_1_2, _FEATURES_1_2),
    }
    queue = arena.struct(
        "VkDeviceQueueCreateInfo",
        queueFamilyIndex=physical.queue_family,
        queueCount=1,
        pQueuePriorities=arena.array("float", [1.0]),
    )
    info = arena.struct("VkDeviceCreateInfo", pNext=enabled, queueCreateInfoCount=1, pQueueCreateInfos=queue)
    handle = vk.create("VkDevice", "vkCreateDevice", physical.handle, info, vk.ffi.NULL)
    teardown.callback(vk.lib.vkDestroyDevice, handle, vk.ffi.NULL)
    return frozenset(names), handle


def _keep_only(features: Any, wanted: tuple[str, ...]) -> list[str]:
    """Clear all supported features but the wanted ones; returns those that are there."""
    for name in dir(features):
        if name not in ("sType", "pNext", *wanted):
            setattr(features, name, 0)
    return [name for name in wanted if getattr(features, name)]
