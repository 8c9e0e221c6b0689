"""Recorded and submitted work: order, times, limits, signals and threads."""

import os
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import kernels
import numpy as np
import pytest

from lavapipe import Buffer, Device, LavapipeError, Pipeline, WaitTimeout, compile_glsl


@pytest.fixture
def values(device: Device) -> Iterator[Buffer]:
    with device.buffer(64, "u4") as buffer:
        yield buffer


@pytest.fixture
def slow(device: Device) -> Iterator[Pipeline]:
    with device.pipeline(compile_glsl(kernels.SLOW), buffers=1, name="slow") as pipeline:
        yield pipeline


@pytest.fixture
def step(device: Device) -> Iterator[Pipeline]:
    with device.pipeline(compile_glsl(kernels.STEP), buffers=1, name="step") as pipeline:
        yield pipeline


def test_dispatches_run_in_order(device: Device, values: Buffer, step: Pipeline) -> None:
    commands = device.record()
    for _ in range(10):
        commands.dispatch(step, [values], (1, 1, 1))
    submission = commands.submit()
    elapsed = submission.wait(30)
    assert (values.array == (3**10 - 1) // 2).all()
    assert len(elapsed.dispatch_ns) == 10
    assert submission.done
    assert submission.wait(0) == elapsed


def test_a_recording_can_be_submitted_again(device: Device, values: Buffer, step: Pipeline) -> None:
    commands = device.record()
    commands.dispatch(step, [values], (1, 1, 1), barrier=False)
    for submission in [commands.submit() for _ in range(3)]:
        submission.wait(30)
    assert (values.array == 13).all()


def test_device_time_is_close_to_the_clock(device: Device, values: Buffer, slow: Pipeline) -> None:
    device.run(slow, [values], (1, 1, 1))
    start = time.perf_counter_ns()
    elapsed = device.run(slow, [values], (8, 1, 1))
    wall = time.perf_counter_ns() - start
    assert 0.3 * wall < elapsed.total_ns <= wall
    assert elapsed.total_ns == sum(elapsed.dispatch_ns)


def test_work_that_is_not_timed_does_the_same(device: Device, values: Buffer, step: Pipeline) -> None:
    commands = device.record()
    for _ in range(10):
        commands.dispatch(step, [values], (1, 1, 1))
    begin = time.perf_counter_ns()
    elapsed = commands.submit(timed=False).wait(30)
    assert (values.array == (3**10 - 1) // 2).all()
    assert elapsed.dispatch_ns == ()
    assert 0 < elapsed.total_ns <= time.perf_counter_ns() - begin


def test_timeout_raises_and_the_work_can_be_waited_for_again(device: Device, values: Buffer, slow: Pipeline) -> None:
    commands = device.record()
    commands.dispatch(slow, [values], (200, 1, 1))
    submission = commands.submit()
    assert not submission.done
    for limit in (0, 0.01):
        with pytest.raises(WaitTimeout, match=f"after {limit} s"):
            submission.wait(limit)
        assert not submission.done
    assert submission.wait(60).total_ns > 0
    assert submission.done
    assert issubclass(WaitTimeout, TimeoutError)


def test_buffers_closed_meanwhile_live_until_the_work_is_done(device: Device) -> None:
    before = device.live_objects
    buffer = device.buffer(64, "f4")
    pipeline = device.pipeline(compile_glsl(kernels.SLOW), buffers=1)
    commands = device.record()
    commands.dispatch(pipeline, [buffer], (40, 1, 1))
    with commands.submit() as submission:
        buffer.close()
        pipeline.close()
        assert device.live_objects == before + 3
    assert submission.done
    assert device.live_objects == before


def test_loops_end_at_the_known_limit(device: Device) -> None:
    limit = device.info.loop_limit
    with (
        device.pipeline(compile_glsl(kernels.COUNT), buffers=1, push_constant_bytes=4) as pipeline,
        device.buffer(1, "u4") as count,
    ):
        for wanted in (1000, 65_536, 200_000):
            device.run(pipeline, [count], (1, 1, 1), struct.pack("I", wanted))
            assert count.array[0] == (wanted if limit is None else min(wanted, limit))


def test_threads_share_a_device(device: Device, step: Pipeline) -> None:
    wrong: list[object] = []

    def work(number: int) -> None:
        for _ in range(20):
            with device.buffer(64, "u4") as buffer:
                buffer.array[:] = number
                device.run(step, [buffer], (1, 1, 1))
                if (buffer.array != 3 * number + 1).any():
                    wrong.append(buffer.array.copy())

    threads = [threading.Thread(target=work, args=(n,)) for n in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_threads_may_wait_for_one_submission(device: Device, values: Buffer, slow: Pipeline) -> None:
    commands = device.record()
    commands.dispatch(slow, [values], (20, 1, 1))
    submission = commands.submit()
    times: list[object] = []
    threads = [threading.Thread(target=lambda: times.append(submission.wait(30))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert times == [submission.wait()] * 4


def test_other_threads_run_during_a_wait(device: Device, values: Buffer, slow: Pipeline) -> None:
    ticks, stop = [0], threading.Event()

    def tick() -> None:
        while not stop.wait(0.001):
            ticks[0] += 1

    thread = threading.Thread(target=tick)
    thread.start()
    device.run(slow, [values], (40, 1, 1))
    stop.set()
    thread.join()
    assert ticks[0] > 20


INTERRUPTED = """
import sys; sys.path.insert(0, sys.argv[1])
import kernels, lavapipe, os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs begin with it ignored
device = lavapipe.Device.open()
pipeline = device.pipeline(lavapipe.compile_glsl(kernels.SLOW), buffers=1)
commands = device.record()
commands.dispatch(pipeline, [device.buffer(64, "f4")], (4000, 1, 1))
submission = commands.submit()
try:
    print("started", flush=True)
    submission.wait()
except KeyboardInterrupt:
    print("interrupted", submission.done, flush=True)
    os._exit(0)
"""


def test_ctrl_c_ends_a_wait() -> None:
    folder = str(Path(__file__).parent)
    with subprocess.Popen([sys.executable, "-c", INTERRUPTED, folder], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "started\n"
        time.sleep(0.2)
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "interrupted False\n"
    assert child.returncode == 0


def test_a_forked_child_is_told_to_open_its_own(device: Device, values: Buffer, step: Pipeline) -> None:
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            device.run(step, [values], (1, 1, 1))
        except LavapipeError as error:
            os.write(writer, str(error).encode())
        values.close()
        os._exit(0)
    os.close(writer)
    with open(reader) as pipe:
        assert "fork" in pipe.read()
    os.waitpid(child, 0)


def test_a_run_costs_little(device: Device) -> None:
    with device.pipeline(compile_glsl(kernels.EMPTY), buffers=0) as pipeline, Device.open() as plain:
        device.run(pipeline, [], (1, 1, 1))
        bare = plain.pipeline(compile_glsl(kernels.EMPTY), buffers=0)
        seconds = []
        for _ in range(200):
            start = time.perf_counter()
            plain.run(bare, [], (1, 1, 1))
            seconds.append(time.perf_counter() - start)
    assert np.min(seconds) < 0.5e-3
