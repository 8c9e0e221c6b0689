"""A lane without a server: who gets the device, and when a task is given up."""

import asyncio
import itertools
import json
import os
import signal
import time

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


def unresumable(kind, scene, **more):
    return Task({"do": "answer", "kind": kind, "scene": scene}, **more)


MINUTES = {"model": "eon", "estimator": {"samples": 2**24}}
"""A convergence of minutes: it has no checkpoints."""


async def begun(lane, task):
    while lane.running is not task:
        await asyncio.sleep(0.01)


def test_small_tasks_are_guests_of_a_long_one_that_cannot_be_resumed_and_a_cancel_ends_it_at_its_next_step():
    async def use(lane):
        host = unresumable("convergence", MINUTES)
        lane.submit(host)
        await begun(lane, host)
        for small in (task(SMALL), task(LONG), unresumable("stability", {"model": "lambert"}, estimate_s=0.0)):
            lane.submit(small)
            assert (await small.future).head["say"] == "done"
            assert lane.at_work == [host]
        lane.cancel(host)
        with pytest.raises(Cancelled):
            await host.future
        assert lane.restarts == 0
        assert not lane.at_work

    with_lane(use)


def test_a_host_and_a_guest_of_an_hour_share_the_device():
    async def use(lane):
        heard = []
        host = unresumable("convergence", MINUTES, hear=lambda message: heard.append("host"))
        guest = task(HUGE, hear=lambda message: heard.append("guest"))
        lane.submit(host)
        await begun(lane, host)
        lane.submit(guest)
        while sum(before != after for before, after in itertools.pairwise(heard)) < 6:
            await asyncio.sleep(0.01)
        for one in (guest, host):
            lane.cancel(one)
            with pytest.raises(Cancelled):
                await one.future
        assert lane.restarts == 0

    with_lane(use)


def test_a_task_that_had_guests_ends_with_the_result_of_one_that_had_none():
    async def use(lane):
        results = []
        for guests in (False, True):
            host = unresumable("stability", {"model": "eon", "techniques": ["cosine", "cltc-mis"]})
            lane.submit(host)
            served = 0
            while guests and not host.future.done():
                small = task(SMALL | {"estimator": {"samples": 20000, "seed": served}})
                lane.submit(small)
                served += (await small.future).head["say"] == "done"
            results.append(json.loads((await host.future).blobs[0]))
            assert bool(served) == guests
        alone, interrupted = ({k: v for k, v in one.items() if k != "run"} for one in results)
        assert interrupted == alone

    with_lane(use)


def test_a_worker_that_is_killed_with_a_guest_costs_both_and_is_replaced():
    async def use(lane):
        host, guest = unresumable("convergence", MINUTES), task(HUGE)
        lane.submit(host)
        await begun(lane, host)
        lane.submit(guest)
        while lane.at_work != [host, guest]:
            await asyncio.sleep(0.01)
        os.kill(lane.worker.process.pid, signal.SIGKILL)
        for one in (host, guest):
            with pytest.raises(WorkerLost):
                await one.future
        small = task(SMALL)
        lane.submit(small)
        assert (await small.future).head["say"] == "done"

    with_lane(use)


def test_a_worker_that_hangs_is_found_out_while_tasks_keep_coming():
    async def use(lane):
        os.kill(lane.worker.process.pid, signal.SIGSTOP)
        end = time.monotonic() + PATIENCE_S
        tasks = []
        while not lane.restarts and time.monotonic() < end:
            tasks.append(task(SMALL, tries=2))
            lane.submit(tasks[-1])
            await asyncio.sleep(0.1)
        assert len(tasks) < 50
        assert {(await one.future).head["say"] for one in tasks} == {"done"}

    with_lane(use, beat_timeout_s=1.0, limit=10**6)


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
