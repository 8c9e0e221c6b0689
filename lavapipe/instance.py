"""The Vulkan instance: loader, validation layer and the messenger that collects what both say."""

from __future__ import annotations

from contextlib import ExitStack, nullcontext
from typing import Any

from lavapipe import _binding as vk
from lavapipe import drivers, threads
from lavapipe.errors import DeviceNotFound, DriverError
from lavapipe.messages import Messages

_LAYER = "VK_LAYER_KHRONOS_validation"
_DEBUG = "VK_EXT_debug_utils"


class Instance:
    """A VkInstance with the debug messenger; `any_driver` lets the loader see every installed driver.

    Raises DeviceNotFound where there is no loader, no driver, or no validation layer though one is asked for.
    """

    def __init__(self, *, validation: bool, any_driver: bool) -> None:
        drivers.check_choice()
        threads.respect_quota()
        self.messages = Messages()
        self._callback = vk.message_callback(self.messages.receive)
        with ExitStack() as teardown, nullcontext() if any_driver else drivers.pinned_to_lavapipe():
            self.handle = self._create(teardown, validation)
            self._teardown = teardown.pop_all()

    def close(self) -> None:
        """Destroy the messenger and the instance; again is harmless."""
        self._teardown.close()

    def physical_devices(self) -> list[Any]:
        """The VkPhysicalDevice handles, in the loader's order. Raises DeviceNotFound where every driver fails."""
        try:
            return vk.enumerate_all("VkPhysicalDevice", "vkEnumeratePhysicalDevices", self.handle)
        except DriverError as error:
            if error.result == "VK_ERROR_INITIALIZATION_FAILED":  # a driver whose hardware is not here
                raise DeviceNotFound(no_driver()) from None
            raise

    def _create(self, teardown: ExitStack, validation: bool) -> Any:
        arena = vk.Arena()
        if validation and not _layer_installed():
            raise DeviceNotFound(f"the Vulkan validation layer {_LAYER} is not installed: run lavapipe/install.sh")
        layers = arena.array("char *", [arena.text(_LAYER)] if validation else [])
        debug = _debug_extension_present()
        extensions = arena.array("char *", [arena.text(_DEBUG)] if debug else [])
        messenger = self._messenger_info(arena) if debug else vk.ffi.NULL
        application = arena.struct(
            "VkApplicationInfo", pApplicationName=arena.text("lavapipe"), apiVersion=vk.API_VERSION_1_2
        )
        info = arena.struct(
            "VkInstanceCreateInfo",
            # Chained here the messenger also hears what is said while the instance is made and destroyed.
            pNext=messenger,
            pApplicationInfo=application,
            enabledLayerCount=len(layers),
            ppEnabledLayerNames=layers,
            enabledExtensionCount=len(extensions),
            ppEnabledExtensionNames=extensions,
        )
        try:
            handle = vk.create("VkInstance", "vkCreateInstance", info, vk.ffi.NULL)
        except DriverError as error:
            if error.result == "VK_ERROR_INCOMPATIBLE_DRIVER":
                raise DeviceNotFound(no_driver()) from None
            raise
        teardown.callback(vk.lib.vkDestroyInstance, handle, vk.ffi.NULL)
        if debug:
            self._attach(handle, messenger, teardown)
        return handle

    def _messenger_info(self, arena: vk.Arena) -> Any:
        return arena.struct(
            "VkDebugUtilsMessengerCreateInfoEXT",
            messageSeverity=vk.VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT
            | vk.VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
            messageType=vk.VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT
            | vk.VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT
            | vk.VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
            pfnUserCallback=self._callback,
        )

    @staticmethod
    def _attach(handle: Any, info: Any, teardown: ExitStack) -> None:
        make = vk.instance_function(handle, "vkCreateDebugUtilsMessengerEXT")
        destroy = vk.instance_function(handle, "vkDestroyDebugUtilsMessengerEXT")
        messenger = vk.ffi.new("VkDebugUtilsMessengerEXT *")
        vk.check(make(handle, info, vk.ffi.NULL, messenger), "vkCreateDebugUtilsMessengerEXT")
        teardown.callback(destroy, handle, messenger[0], vk.ffi.NULL)


def no_driver() -> str:
    """What to say where the loader finds no driver."""
    variable = drivers.chosen_variable()
    if variable:
        return drivers.no_driver_in(variable)
    return "Mesa's software Vulkan driver lavapipe is not installed: run lavapipe/install.sh"


def _layer_installed() -> bool:
    layers = vk.enumerate_all("VkLayerProperties", "vkEnumerateInstanceLayerProperties")
    return any(vk.text(layer.layerName) == _LAYER for layer in layers)


def _debug_extension_present() -> bool:
    extensions = vk.enumerate_all("VkExtensionProperties", "vkEnumerateInstanceExtensionProperties", vk.ffi.NULL)
    return any(vk.text(extension.extensionName) == _DEBUG for extension in extensions)
