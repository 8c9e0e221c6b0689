"""Compute pipelines: a SPIR-V module with its layout and specialization."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from lavapipe import _binding as vk
from lavapipe.errors import DriverError, InvalidArgument
from lavapipe.resource import Resource
from lavapipe.spirv import Module, read_module

if TYPE_CHECKING:
    from lavapipe.device import Device

# Capability of the SPIR-V specification -> the feature it needs. Those that need none are not listed.
_FEATURE_OF = {
    9: ("Float16", "shaderFloat16"),
    10: ("Float64", "shaderFloat64"),
    11: ("Int64", "shaderInt64"),
    22: ("Int16", "shaderInt16"),
    39: ("Int8", "shaderInt8"),
    4433: ("StorageBuffer16BitAccess", "storageBuffer16BitAccess"),
    4448: ("StorageBuffer8BitAccess", "storageBuffer8BitAccess"),
}
# Any address may be read and written with this one.
_PHYSICAL_ADDRESSES = 5347


class Pipeline(Resource):
    """A compute pipeline over the storage buffers 0 ... `buffers` - 1 of set 0; made by `Device.pipeline`."""

    def __init__(
        self,
        device: Device,
        spirv: bytes,
        *,
        buffers: int,
        push_constant_bytes: int,
        specialization: Mapping[int, int | float | bool],
        name: str,
    ) -> None:
        module = read_module(spirv)
        self.name = name
        self.buffers = buffers
        self.push_constant_bytes = push_constant_bytes
        self.instructions = module.instructions
        _check_capabilities(device, module)
        _check_interface(device, module, buffers, push_constant_bytes)
        values = _encoded(module, specialization)
        with ExitStack() as teardown:
            logical = device.logical.handle
            self.set_layout = _set_layout(teardown, logical, buffers)
            self.layout = _layout(teardown, logical, self.set_layout, push_constant_bytes)
            try:
                self.handle = _pipeline(teardown, logical, self.layout, spirv, values)
            except DriverError as error:
                said = device.messages.take_driver()
                raise DriverError(error.result, f"{error.call} ({name or 'unnamed'})", said) from None
            super().__init__(device.owner, f"pipeline {name!r}" if name else "pipeline", teardown)


def _check_capabilities(device: Device, module: Module) -> None:
    if _PHYSICAL_ADDRESSES in module.capabilities:
        raise InvalidArgument("spirv: buffer references are not allowed (capability PhysicalStorageBufferAddresses)")
    for capability in sorted(module.capabilities):
        name, feature = _FEATURE_OF.get(capability, ("", ""))
        if feature and feature not in device.logical.features:
            raise InvalidArgument(f"spirv: needs the capability {name}, which {device.info.name} lacks")


def _check_interface(device: Device, module: Module, buffers: int, push_constant_bytes: int) -> None:
    if "main" not in module.entry_points:
        raise InvalidArgument(f"spirv: the entry point must be 'main', not {', '.join(module.entry_points)}")
    if module.other_resources:
        raise InvalidArgument(
            "spirv: only single storage buffers can be bound, no images, samplers, uniform buffers or arrays of buffers"
        )
    if buffers < 0:
        raise InvalidArgument(f"buffers={buffers}: 0 or more")
    beyond = sorted(place for place in module.bindings if place[0] != 0 or place[1] >= buffers)
    if beyond:
        places = ", ".join(f"set {where[0]} binding {where[1]}" for where in beyond)
        raise InvalidArgument(
            f"buffers={buffers}: the shader declares {places}; set 0 bindings 0...{buffers - 1} are there"
        )
    limit = device.info.max_push_constant_bytes
    if not 0 <= push_constant_bytes <= limit or push_constant_bytes % 4:
        raise InvalidArgument(f"push_constant_bytes={push_constant_bytes}: a multiple of 4 from 0 to {limit}")
    if module.push_constant_bytes > push_constant_bytes:
        raise InvalidArgument(
            f"push_constant_bytes={push_constant_bytes}: the shader's block has {module.push_constant_bytes} bytes"
        )


def _encoded(module: Module, specialization: Mapping[int, int | float | bool]) -> dict[int, bytes]:
    values = {}
    for constant_id, value in specialization.items():
        constant = module.specialization.get(constant_id)
        if constant is None:
            known = ", ".join(map(str, sorted(module.specialization))) or "none"
            raise InvalidArgument(
                f"specialization={{{constant_id}: {value!r}}}: the shader's constant ids are: {known}"
            )
        try:
            values[constant_id] = constant.encode(value)
        except InvalidArgument as error:
            raise InvalidArgument(f"specialization={{{constant_id}: {value!r}}}: {error}") from None
    return values


def _set_layout(teardown: ExitStack, logical: Any, buffers: int) -> Any:
    arena = vk.Arena()
    bindings = [
        arena.struct(
            "VkDescriptorSetLayoutBinding",
            binding=index,
            descriptorType=vk.VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            descriptorCount=1,
            stageFlags=vk.VK_SHADER_STAGE_COMPUTE_BIT,
        )[0]
        for index in range(buffers)
    ]
    info = arena.struct(
        "VkDescriptorSetLayoutCreateInfo",
        bindingCount=buffers,
        pBindings=arena.array("VkDescriptorSetLayoutBinding", bindings),
    )
    return vk.create_owned(teardown, logical, "DescriptorSetLayout", info)


def _layout(teardown: ExitStack, logical: Any, set_layout: Any, push_constant_bytes: int) -> Any:
    arena = vk.Arena()
    constants = arena.struct(
        "VkPushConstantRange", stageFlags=vk.VK_SHADER_STAGE_COMPUTE_BIT, offset=0, size=push_constant_bytes
    )
    info = arena.struct(
        "VkPipelineLayoutCreateInfo",
        setLayoutCount=1,
        pSetLayouts=arena.array("VkDescriptorSetLayout", [set_layout]),
        pushConstantRangeCount=1 if push_constant_bytes else 0,
        pPushConstantRanges=constants,
    )
    return vk.create_owned(teardown, logical, "PipelineLayout", info)


def _pipeline(teardown: ExitStack, logical: Any, layout: Any, spirv: bytes, values: Mapping[int, bytes]) -> Any:
    arena = vk.Arena()
    code = arena.struct(
        "VkShaderModuleCreateInfo", codeSize=len(spirv), pCode=vk.ffi.cast("uint32_t *", arena.data(spirv))
    )
    with ExitStack() as module_teardown:
        module = vk.create_owned(module_teardown, logical, "ShaderModule", code)
        stage = arena.struct(
            "VkPipelineShaderStageCreateInfo",
            stage=vk.VK_SHADER_STAGE_COMPUTE_BIT,
            module=module,
            pName=arena.text("main"),
            pSpecializationInfo=_specialization(arena, values),
        )
        info = arena.struct("VkComputePipelineCreateInfo", stage=stage[0], layout=layout)
        handle = vk.create("VkPipeline", "vkCreateComputePipelines", logical, vk.ffi.NULL, 1, info, vk.ffi.NULL)
    teardown.callback(vk.lib.vkDestroyPipeline, logical, handle, vk.ffi.NULL)
    return handle


def _specialization(arena: vk.Arena, values: Mapping[int, bytes]) -> Any:
    entries, data = [], b""
    for constant_id, value in values.items():
        entry = arena.struct("VkSpecializationMapEntry", constantID=constant_id, offset=len(data), size=len(value))
        entries.append(entry[0])
        data += value
    return arena.struct(
        "VkSpecializationInfo",
        mapEntryCount=len(entries),
        pMapEntries=arena.array("VkSpecializationMapEntry", entries),
        dataSize=len(data),
        pData=arena.data(data),
    )
