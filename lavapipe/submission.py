"""Submitted work: recorded for the driver, run by its queue, waited for with a fence, timed by the device."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from lavapipe import _binding as vk
from lavapipe.errors import WaitTimeout
from lavapipe.resource import Resource

if TYPE_CHECKING:
    from lavapipe.commands import Dispatch
    from lavapipe.device import Device

# A signal is delivered only between two waits of the driver, so none may be long.
_LONGEST_WAIT_NS = 50_000_000


@dataclass(frozen=True)
class DeviceTime:
    """How long the device worked, in ns: in all, and for each dispatch in order.

    The first dispatch of a pipeline includes its compilation by the driver. A device without timestamps, and work that
    is not to be timed, gives the host's time between submit and the end of the wait as the whole, and no dispatches.
    """

    total_ns: int
    dispatch_ns: tuple[int, ...]


class Submission(Resource):
    """Work on its way, made by `Commands.submit`. Closing it waits for its end."""

    def __init__(self, device: Device, dispatches: Sequence[Dispatch], *, timed: bool) -> None:
        self._device = device
        self._logical = device.logical.handle
        self._time: DeviceTime | None = None
        self._stamps = len(dispatches) + 1 if timed and device.info.timestamp_ns is not None else 0
        with ExitStack() as teardown:
            for thing in {thing for d in dispatches for thing in (d.pipeline, *d.buffers)}:
                thing.hold()
                teardown.callback(thing.let_go)
            self._queries = self._query_pool(teardown)
            commands = self._record(teardown, dispatches)
            arena = vk.Arena()
            self._fence = vk.create_owned(teardown, self._logical, "Fence", arena.struct("VkFenceCreateInfo"))
            buffers = arena.array("VkCommandBuffer", [commands])
            info = arena.struct("VkSubmitInfo", commandBufferCount=1, pCommandBuffers=buffers)
            with device.logical.queue_lock:
                self._started = time.perf_counter_ns()
                vk.check(vk.lib.vkQueueSubmit(device.logical.queue, 1, info, self._fence), "vkQueueSubmit")
            super().__init__(device.owner, "submission", teardown)

    @property
    def done(self) -> bool:
        """Whether the work is finished."""
        return self._time is not None or self._finished_within(0)

    def wait(self, timeout_s: float | None = None) -> DeviceTime:
        """Wait for the end of the work, for `timeout_s` seconds at most (None: for ever), and return its times.

        Ctrl-C works and other threads run meanwhile. Raises WaitTimeout when the time is up: the work goes on and
        may be waited for again. Raises DriverError where the device is lost.
        """
        finished = self._wait(timeout_s)
        self._device.messages.check()
        return finished

    def close(self) -> None:
        """Wait for the end of the work, however long, and free what it used; again is harmless.

        Raises DriverError where the device is lost.
        """
        try:
            if not self.closed and self._owner.same_process:
                self._wait(None)
        finally:
            super().close()

    def _wait(self, timeout_s: float | None) -> DeviceTime:
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        while self._time is None:
            left = None if deadline is None else max(0.0, deadline - time.monotonic())
            slice_ns = _LONGEST_WAIT_NS if left is None else min(_LONGEST_WAIT_NS, int(left * 1e9))
            if not self._finished_within(slice_ns) and left == 0:
                raise WaitTimeout(f"the device was not done after {timeout_s} s")
        return self._time

    def _finished_within(self, limit_ns: int) -> bool:
        self._owner.check_process()
        with self._owner.lock:
            if self._time is not None:
                return True
            self.hold()
        try:
            fences = vk.Arena().array("VkFence", [self._fence])
            result = vk.lib.vkWaitForFences(self._logical, 1, fences, vk.VK_TRUE, limit_ns)
            if result == vk.VK_TIMEOUT:
                return False
            vk.check(result, "vkWaitForFences")
            self._finish()
            return True
        finally:
            self.let_go()

    def _finish(self) -> None:
        with self._owner.lock:
            if self._time is None:
                self._time = self._read_time()
                super().close()

    def _read_time(self) -> DeviceTime:
        if not self._stamps:
            return DeviceTime(time.perf_counter_ns() - self._started, ())
        ticks = vk.ffi.new("uint64_t[]", self._stamps)
        flags = vk.VK_QUERY_RESULT_64_BIT | vk.VK_QUERY_RESULT_WAIT_BIT
        size = 8 * self._stamps
        vk.check(
            vk.lib.vkGetQueryPoolResults(self._logical, self._queries, 0, self._stamps, size, ticks, 8, flags),
            "vkGetQueryPoolResults",
        )
        period = self._device.info.timestamp_ns or 1.0
        each = tuple(round((after - before) * period) for before, after in pairwise(ticks))
        return DeviceTime(sum(each), each)

    def _query_pool(self, teardown: ExitStack) -> Any:
        if not self._stamps:
            return None
        info = vk.Arena().struct("VkQueryPoolCreateInfo", queryType=vk.VK_QUERY_TYPE_TIMESTAMP, queryCount=self._stamps)
        return vk.create_owned(teardown, self._logical, "QueryPool", info)

    def _record(self, teardown: ExitStack, dispatches: Sequence[Dispatch]) -> Any:
        sets = _descriptor_sets(teardown, self._logical, dispatches)
        commands = _command_buffer(teardown, self._logical, self._device.physical.queue_family)
        arena = vk.Arena()
        begin = arena.struct("VkCommandBufferBeginInfo", flags=vk.VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT)
        vk.check(vk.lib.vkBeginCommandBuffer(commands, begin), "vkBeginCommandBuffer")
        if self._stamps:
            vk.lib.vkCmdResetQueryPool(commands, self._queries, 0, self._stamps)
            vk.lib.vkCmdWriteTimestamp(commands, vk.VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, self._queries, 0)
        for index, (dispatch, descriptor_set) in enumerate(zip(dispatches, sets, strict=True)):
            if index and dispatch.barrier:
                _barrier(commands, vk.VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, vk.VK_ACCESS_SHADER_READ_BIT)
            _dispatch(commands, dispatch, descriptor_set)
            if self._stamps:
                stage = vk.VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT
                vk.lib.vkCmdWriteTimestamp(commands, stage, self._queries, index + 1)
        _barrier(commands, vk.VK_PIPELINE_STAGE_HOST_BIT, vk.VK_ACCESS_HOST_READ_BIT)
        vk.check(vk.lib.vkEndCommandBuffer(commands), "vkEndCommandBuffer")
        return commands


def _descriptor_sets(teardown: ExitStack, logical: Any, dispatches: Sequence[Dispatch]) -> list[Any]:
    """A descriptor set for each dispatch, written with its buffers."""
    arena = vk.Arena()
    size = arena.struct(
        "VkDescriptorPoolSize",
        type=vk.VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        # A pool of no descriptors is not allowed.
        descriptorCount=max(1, sum(len(dispatch.buffers) for dispatch in dispatches)),
    )
    info = arena.struct("VkDescriptorPoolCreateInfo", maxSets=len(dispatches), poolSizeCount=1, pPoolSizes=size)
    pool = vk.create_owned(teardown, logical, "DescriptorPool", info)
    layouts = arena.array("VkDescriptorSetLayout", [dispatch.pipeline.set_layout for dispatch in dispatches])
    allocate = arena.struct(
        "VkDescriptorSetAllocateInfo", descriptorPool=pool, descriptorSetCount=len(dispatches), pSetLayouts=layouts
    )
    sets = vk.ffi.new("VkDescriptorSet[]", len(dispatches))
    vk.check(vk.lib.vkAllocateDescriptorSets(logical, allocate, sets), "vkAllocateDescriptorSets")
    writes = [
        _write(arena, descriptor_set, dispatch)
        for descriptor_set, dispatch in zip(sets, dispatches, strict=True)
        if dispatch.buffers
    ]
    if writes:
        array = arena.array("VkWriteDescriptorSet", writes)
        vk.lib.vkUpdateDescriptorSets(logical, len(writes), array, 0, vk.ffi.NULL)
    return list(sets)


def _write(arena: vk.Arena, descriptor_set: Any, dispatch: Dispatch) -> Any:
    infos = [{"buffer": buffer.handle, "offset": 0, "range": buffer.nbytes} for buffer in dispatch.buffers]
    # One write of n descriptors starting at binding 0 runs on over the bindings 1 ... n - 1, which are all alike
    # (Vulkan specification, "consecutive binding updates").
    return arena.struct(
        "VkWriteDescriptorSet",
        dstSet=descriptor_set,
        dstBinding=0,
        descriptorCount=len(infos),
        descriptorType=vk.VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        pBufferInfo=arena.array("VkDescriptorBufferInfo", infos),
    )[0]


def _command_buffer(teardown: ExitStack, logical: Any, queue_family: int) -> Any:
    arena = vk.Arena()
    info = arena.struct(
        "VkCommandPoolCreateInfo", flags=vk.VK_COMMAND_POOL_CREATE_TRANSIENT_BIT, queueFamilyIndex=queue_family
    )
    pool = vk.create_owned(teardown, logical, "CommandPool", info)
    allocate = arena.struct(
        "VkCommandBufferAllocateInfo",
        commandPool=pool,
        level=vk.VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        commandBufferCount=1,
    )
    return vk.create("VkCommandBuffer", "vkAllocateCommandBuffers", logical, allocate)


def _barrier(commands: Any, stage: int, access: int) -> None:
    """Make what shaders wrote visible to a later stage."""
    if access == vk.VK_ACCESS_SHADER_READ_BIT:
        access |= vk.VK_ACCESS_SHADER_WRITE_BIT
    barrier = vk.Arena().struct("VkMemoryBarrier", srcAccessMask=vk.VK_ACCESS_SHADER_WRITE_BIT, dstAccessMask=access)
    before, null = vk.VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, vk.ffi.NULL
    vk.lib.vkCmdPipelineBarrier(commands, before, stage, 0, 1, barrier, 0, null, 0, null)


def _dispatch(commands: Any, dispatch: Dispatch, descriptor_set: Any) -> None:
    arena, pipeline, point = vk.Arena(), dispatch.pipeline, vk.VK_PIPELINE_BIND_POINT_COMPUTE
    vk.lib.vkCmdBindPipeline(commands, point, pipeline.handle)
    if dispatch.buffers:
        sets = arena.array("VkDescriptorSet", [descriptor_set])
        vk.lib.vkCmdBindDescriptorSets(commands, point, pipeline.layout, 0, 1, sets, 0, vk.ffi.NULL)
    if dispatch.push_constants:
        data, size = arena.data(dispatch.push_constants), len(dispatch.push_constants)
        vk.lib.vkCmdPushConstants(commands, pipeline.layout, vk.VK_SHADER_STAGE_COMPUTE_BIT, 0, size, data)
    vk.lib.vkCmdDispatch(commands, *dispatch.groups)
