"""Time per sample of several shaders, in one interleaved run.

On lavapipe the processor's own account of this process is read, not a clock: a busy machine takes the processor away
for a while, which is not time of the shader. What the calling thread itself spends is subtracted.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from lavapipe import Device, Pipeline
from service.convergence.cost import median_interval
from service.engine import BUFFERS, PUSH_CONSTANT_BYTES
from service.explain.shaders import Shader
from service.random_numbers import BLOCK_SAMPLES
from service.sampling import Sampler

Array = NDArray[np.float64]

ROUNDS = 51
LAUNCH_SAMPLES = 1 << 19
"""In a round, for each shader: about two milliseconds. Other programs seldom interrupt so short a launch."""
COMPILATIONS = 3


@dataclass(frozen=True)
class Spread:
    """Median and quartiles over rounds, and an interval of 95 % of the median by its order statistics."""

    median: float
    quartiles: tuple[float, float]
    interval: tuple[float, float]


def spread(values: Array) -> Spread:
    """The spread of one value a round, shape (rounds,)."""
    ordered = np.sort(values)
    low, high = median_interval(len(ordered))
    lower, median, upper = np.quantile(ordered, [0.25, 0.5, 0.75]).tolist()
    return Spread(median, (lower, upper), (float(ordered[low]), float(ordered[high])))


def sample_times(
    device: Device, shaders: Sequence[Shader], rounds: int = ROUNDS, advance: Callable[[int], None] = lambda _: None
) -> Array:
    """ns a sample on one driver thread, shape (rounds, shaders).

    Every round runs each shader once, in an order that turns from round to round; before the first, each runs once
    unmeasured. `advance` is called with the number of samples just drawn.
    """
    found = np.empty((rounds, len(shaders)))
    clock = _clock(device)
    with ExitStack() as stack:
        samplers = [stack.enter_context(Sampler(device, _pipeline(device, one), one.cells)) for one in shaders]
        blocks = [max(1, LAUNCH_SAMPLES // BLOCK_SAMPLES // len(one.cells)) for one in shaders]
        for sampler, some in zip(samplers, blocks, strict=True):
            sampler.launch(some)
        for number in range(rounds):
            for at in np.roll(np.arange(len(shaders)), number).tolist():
                samples = blocks[at] * BLOCK_SAMPLES * len(shaders[at].cells)
                found[number, at] = clock(partial(samplers[at].launch, blocks[at])) / samples
                advance(samples)
    return found


def compile_time(device: Device, shader: Shader) -> float:
    """Milliseconds from SPIR-V to machine code, at the first launch: the least of some, on a device without a cache."""
    took = []
    for _ in range(COMPILATIONS):
        begin = time.process_time_ns()
        pipeline = _pipeline(device, shader)
        built = time.process_time_ns()
        with Sampler(device, pipeline, shader.cells) as sampler:
            ready = time.process_time_ns()
            sampler.warm_up()
            took.append(built - begin + time.process_time_ns() - ready)
        pipeline.close()
    return min(took) / 1e6


def _clock(device: Device) -> Callable[[Callable[[], int]], int]:
    """A function that runs a launch and gives the ns that it takes of one driver thread."""
    if not device.info.is_lavapipe:
        return lambda launch: launch()

    def spent(launch: Callable[[], int]) -> int:
        before = time.process_time_ns() - time.thread_time_ns()
        launch()
        return time.process_time_ns() - time.thread_time_ns() - before

    return spent


def _pipeline(device: Device, shader: Shader) -> Pipeline:
    return device.pipeline(
        shader.spirv,
        buffers=BUFFERS["statistics"],
        push_constant_bytes=PUSH_CONSTANT_BYTES["statistics"],
        specialization=shader.constants,
        name=shader.name,
    )
