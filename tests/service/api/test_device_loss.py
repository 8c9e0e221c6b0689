"""Workers that are killed or hang: who waited on them hears of it, nobody else does, and no result is lost."""

import os
import signal
import threading
from concurrent.futures import ThreadPoolExecutor

import httpx
from http_server import HUGE, LONG, LONGER, PATIENCE_S, SMALL, seeded, wait_until, without_run
from own_time import OwnTime

BACK_S = 3.0
"""A worker that was lost is replaced within this; for one that hangs, counted from when it is found out."""

BEAT_TIMEOUT_S = 1.0


def ask_in_background(server, scene):
    pool = ThreadPoolExecutor(1)
    return pool.submit(httpx.post, f"{server.url}/v1/statistics", json=scene, timeout=PATIENCE_S)


def await_replacement(server, lane, lost, clock):
    """Wait until another worker than `lost` is ready. Returns the seconds of `clock` until then."""
    wait_until(lambda: server.worker(lane) != lost, f"lane {lane} has another worker")
    return clock.seconds(server.worker(lane))


def start_direct_server(start_server, **settings):
    """A server that answers whatever it is asked directly."""
    return start_server(direct_limit_s=1e6, request_timeout_s=1e6, **settings)


def test_a_killed_worker_costs_one_answer_and_is_back_within_3_seconds(start_server):
    # The worker stands still while questions queue up behind it, so that it is at the first of them when it dies.
    server = start_direct_server(start_server, beat_timeout_s=PATIENCE_S)
    stored = server.ask(SMALL)
    victim = ask_in_background(server, HUGE)
    server.await_lane("direct", running=1, waiting=0)
    killed = server.worker("direct")
    os.kill(killed, signal.SIGSTOP)
    waiting = [ask_in_background(server, seeded(LONG, seed)) for seed in range(3)]
    server.await_lane("direct", running=1, waiting=3)
    clock = OwnTime(server.process.pid)
    os.kill(killed, signal.SIGKILL)
    assert await_replacement(server, "direct", killed, clock) < BACK_S
    lost = victim.result()
    problem = lost.json()
    assert problem["status"] == lost.status_code == 503
    assert problem["type"] == "urn:samplerscope:problem:worker-lost"
    assert int(lost.headers["retry-after"]) >= 1
    # Who waited, and who comes later, is served by the next worker.
    assert server.ask(seeded(SMALL, 2)).status_code == 200
    assert [future.result().status_code for future in waiting] == [200, 200, 200]
    assert server.ask(SMALL).content == stored.content
    assert server.metric("samplerscope_worker_restarts_total", lane="direct") == 1


def test_a_hanging_worker_is_found_out_and_replaced(start_server):
    server = start_direct_server(start_server, beat_timeout_s=BEAT_TIMEOUT_S)
    victim = ask_in_background(server, HUGE)
    server.await_lane("direct", running=1, waiting=0)
    hanging = server.worker("direct")
    clock = OwnTime(server.process.pid)
    os.kill(hanging, signal.SIGSTOP)
    wait_until(lambda: server.client.get("/healthz").status_code == 200 and victim.done(), "the loss is told")
    assert clock.seconds() < BEAT_TIMEOUT_S + 1.0
    found_out = OwnTime(server.process.pid)
    assert victim.result().status_code == 503
    assert "retry-after" in victim.result().headers
    assert await_replacement(server, "direct", hanging, found_out) < BACK_S
    assert server.ask(SMALL).status_code == 200
    assert not os.path.exists(f"/proc/{hanging}")


def test_an_idle_worker_that_dies_is_replaced_before_anyone_asks(start_server):
    server = start_direct_server(start_server)
    lost = server.worker("direct")
    clock = OwnTime(server.process.pid)
    os.kill(lost, signal.SIGKILL)
    assert await_replacement(server, "direct", lost, clock) < BACK_S
    assert server.client.get("/readyz").status_code == 200


def test_every_child_killed_under_load_and_the_service_goes_on(start_server):
    """Each worker is killed while all lanes have work: jobs end, other answers are results or problems with a hint."""
    server = start_server()
    job = server.start_job(LONGER)
    stop = threading.Event()
    replies = []

    def load(first):
        with httpx.Client(base_url=server.url, timeout=PATIENCE_S) as client:
            for seed in range(first, first + 10_000):
                if stop.is_set():
                    return
                name = ("json", "csv")[seed % 2]
                replies.append(client.post("/v1/statistics", json=seeded(SMALL, seed), params={"format": name}))

    def await_answers(count):
        enough = sum(reply.status_code == 200 for reply in replies) + count
        wait_until(lambda: sum(reply.status_code == 200 for reply in replies) >= enough, "there are more answers")

    threads = [threading.Thread(target=load, args=(first,)) for first in (10_000, 30_000, 50_000)]
    for thread in threads:
        thread.start()
    for lane in ("direct", "jobs", "encode"):
        await_answers(10)
        lost = server.worker(lane)
        os.kill(lost, signal.SIGKILL)
        wait_until(lambda lane=lane, lost=lost: server.worker(lane) != lost, f"lane {lane} has another worker")
    await_answers(10)
    stop.set()
    for thread in threads:
        thread.join()
    assert server.await_job(job)["state"] == "done"
    assert server.metric("samplerscope_worker_restarts_total") == 3
    assert {reply.status_code for reply in replies} <= {200, 503}
    # At most the one task that the direct or the encoding worker was at when it died, whoever shared it.
    assert sum(reply.status_code == 503 for reply in replies) <= 2
    assert all("retry-after" in reply.headers for reply in replies if reply.status_code == 503)


def test_a_job_whose_worker_is_killed_goes_on_where_it_was_and_ends_with_the_same_bits(start_server, direct_answer):
    server = start_server()
    job = server.start_job(LONGER)
    for _ in range(2):
        begun = server.client.get(job).json()["progress"]["done"]
        reached = server.await_job(job, wanted=(), until=lambda now, begun=begun: now["progress"]["done"] > begun)
        lost = server.worker("jobs")
        os.kill(lost, signal.SIGKILL)
        after = server.client.get(job).json()["progress"]["done"]
        assert after >= reached["progress"]["done"]
        wait_until(lambda lost=lost: server.worker("jobs") != lost, "the job has another worker")
    assert server.await_job(job)["state"] == "done"
    assert server.metric("samplerscope_worker_restarts_total", lane="jobs") == 2
    result = server.client.get(f"{job}/result").json()
    assert without_run(result) == direct_answer(LONGER)
