"""Vulkan compute on Mesa lavapipe. Knows nothing of BRDFs.

::

    spirv = lavapipe.compile_glsl(source)
    with lavapipe.Device.open() as device:
        data = device.buffer(1024, np.float32)
        pipeline = device.pipeline(spirv, buffers=1)
        device.run(pipeline, [data], (16, 1, 1))
        print(data.array)

Nothing of Vulkan is loaded before a device opens.
"""

from lavapipe.buffer import Buffer
from lavapipe.cache import Cache, default_cache
from lavapipe.commands import Commands
from lavapipe.compiler import compile_glsl
from lavapipe.device import Device
from lavapipe.errors import (
    CompileError,
    DeviceNotFound,
    Diagnostic,
    DriverError,
    InvalidArgument,
    LavapipeError,
    OutOfMemory,
    ValidationFailed,
    WaitTimeout,
)
from lavapipe.optimizer import specialized
from lavapipe.physical import DeviceInfo
from lavapipe.pipeline import Pipeline
from lavapipe.spirv import Module, SpecConstant, read_module
from lavapipe.submission import DeviceTime, Submission

__all__ = [
    "Buffer",
    "Cache",
    "Commands",
    "CompileError",
    "Device",
    "DeviceInfo",
    "DeviceNotFound",
    "DeviceTime",
    "Diagnostic",
    "DriverError",
    "InvalidArgument",
    "LavapipeError",
    "Module",
    "OutOfMemory",
    "Pipeline",
    "SpecConstant",
    "Submission",
    "ValidationFailed",
    "WaitTimeout",
    "compile_glsl",
    "default_cache",
    "read_module",
    "specialized",
]
