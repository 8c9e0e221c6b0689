"""A lane without a server: who gets the device, and when a task is given up."""

import asyncio
import itertools
import os
import signal

import pytest
from http_server import HUGE, LONG, PATIENCE_S, SMALL

from service.sampling import CellSums, Checkpoint
from service.worker import checkpoints
from service.worker.lane import Cancelled, Lane, LaneSettings, QueueFull, Task
from service.worker.process import WorkerLost


def task(scene, **more):
    return Task({"do": "answer", "kind": "statistics", "scene": scene, "partial": True}, resumable=True, **more)


def with_lane(use, **settings):
    """Run `use(lane)` in an event loop with a started lane, and close it."""

    async def run():
        lane = Lane(LaneSettings("test", **settings))
        await lane.start()
        try:
            return await use(lane)
        finally:
            await lane.close()

    return asyncio.run(run())


def test_a_task_that_loses_every_worker_is_given_up_after_as_many_tries_as_it_has():
    async def use(lane):
        # 256 cells: the first launch takes longer than the kill.
        fatal = task(HUGE | {"theta_o_deg": {"count": 256}}, tries=3)
        lane.submit(fatal)
        killed = set()
        while not fatal.future.done():
            worker = lane.worker
            if lane.running is fatal and worker is not None and worker.process.pid not in killed:
                killed.add(worker.process.pid)
                os.kill(worker.process.pid, signal.SIGKILL)
            await asyncio.sleep(0.001)
        with pytest.raises(WorkerLost):
            await fatal.future
        assert len(killed) == 3
        small = task(SMALL)
        lane.submit(small)
        assert (await small.future).head["say"] == "done"

    with_lane(use)


def test_equal_tasks_share_the_device_and_both_end():
    async def use(lane):
        order = []
        first = task(LONG, hear=lambda message: order.append("first"))
        second = task(LONG, hear=lambda message: order.append("second"))
        lane.submit(first)
        lane.submit(second)
        await asyncio.gather(first.future, second.future)
        turns = sum(before != after for before, after in itertools.pairwise(order))
        assert turns >= 3  # one after the other would be a single turn

    with_lane(use, quantum_s=0.05)


def test_a_full_queue_refuses_and_cancelled_tasks_leave_it():
    async def use(lane):
        running = task(HUGE)
        lane.submit(running)
        while lane.running is None:
            await asyncio.sleep(0.001)
        waiting = [task(HUGE), task(HUGE)]
        for one in waiting:
            lane.submit(one)
        with pytest.raises(QueueFull):
            lane.submit(task(SMALL))
        for one in (*waiting, running):
            lane.cancel(one)
        for one in (*waiting, running):
            with pytest.raises(Cancelled):
                await asyncio.wait_for(one.future, PATIENCE_S)
        assert lane.running is None or not lane.waiting
        assert lane.restarts == 0

    with_lane(use, limit=2)


def test_a_closed_lane_leaves_no_process():
    async def use(lane):
        lane.submit(task(HUGE))
        return lane.worker.process.pid

    pid = with_lane(use)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_checkpoints_keep_every_bit():
    import numpy as np

    rng = np.random.default_rng(1)
    counts = {name: rng.integers(0, 2**60, 7) for name in ("drawn", "zero", "nonfinite", "negative", "first_bad")}
    sums = CellSums(
        **counts, shift=rng.normal(size=7), powers=rng.normal(size=(4, 7)), largest=np.full(7, -np.inf), device_ns=2**40
    )
    back = checkpoints.unpack(checkpoints.pack(Checkpoint(12, sums)))
    assert (back.launches, back.sums.device_ns) == (12, 2**40)
    for name, value in vars(sums).items():
        assert np.array_equal(getattr(back.sums, name), value)
