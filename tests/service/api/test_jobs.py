"""Long questions become jobs: watched, cancelled, and gone on with after a restart."""

import json
import os
import resource
import signal
import sqlite3
from contextlib import closing

import httpx
import pytest
from http_server import HUGE, LONG, LONGER, PATIENCE_S, SMALL, seeded, wait_until, without_run


def events(server, path, most=10_000, when_watching=lambda: None):
    """(name, data) of the events of a job until its end, or of the first `most`."""
    found = []
    with httpx.stream("GET", f"{server.url}{path}/events", timeout=PATIENCE_S) as reply:
        assert reply.headers["content-type"].startswith("text/event-stream")
        name = None
        for line in reply.iter_lines():
            if name is None:
                when_watching()
            if line.startswith("event: "):
                name = line.removeprefix("event: ")
            elif line.startswith("data: "):
                found.append((name, json.loads(line.removeprefix("data: "))))
                if len(found) == most:
                    break
    return found


def test_a_question_estimated_above_the_limit_becomes_a_job(server):
    reply = server.ask(seeded(HUGE, 50))
    assert reply.status_code == 202
    path = reply.headers["location"]
    job = server.client.get(path).json()
    assert job["state"] in ("queued", "running")
    assert job["estimate_s"] > 3.0
    assert job["scene"]["estimator"]["samples"] == 10**10
    # The same question again is the same job; its result is not there yet.
    assert server.ask(seeded(HUGE, 50)).headers["location"] == path
    early = server.client.get(f"{path}/result")
    assert early.status_code == 409
    assert "retry-after" in early.headers
    assert server.client.delete(path).json()["state"] == "cancelled"


def test_prefer_respond_async_makes_any_new_question_a_job(server):
    scene = seeded(SMALL, 51)
    reply = server.ask(scene, headers={"prefer": "respond-async"})
    assert reply.status_code == 202
    server.await_job(reply.headers["location"])
    again = server.ask(scene, headers={"prefer": "respond-async"})
    assert again.status_code == 200
    result = server.client.get(f"{reply.headers['location']}/result")
    assert result.content == again.content
    assert result.headers["etag"] == again.headers["etag"]


def test_events_tell_progress_and_partial_statistics_that_plot(start_server):
    scene = seeded(LONGER, 52)
    server = start_server(beat_timeout_s=PATIENCE_S)
    # The worker stands still until someone watches, who so hears of the job from its beginning.
    worker = server.worker("jobs")
    os.kill(worker, signal.SIGSTOP)
    path = server.start_job(scene)
    told = events(server, path, when_watching=lambda: os.kill(worker, signal.SIGCONT))
    assert told[-1][0] == "done"
    progress = [data for name, data in told if name == "progress"]
    assert {data["technique"] for data in progress} >= {"cosine", "cltc-mis"}
    done = [data["done"] for data in progress]
    assert done == sorted(done)
    assert len(set(done)) > 8
    assert done[-1] == progress[-1]["total"] == 4 * 64 * 1_000_000
    partials = [data for name, data in told if name == "partial"]
    unfinished = [one for one in partials if 0 < min(one["samples"]) < 1_000_000]
    assert unfinished
    for one in partials:
        assert len(one["theta_o_deg"]) == len(one["mean"]) == len(one["variance"]) == len(one["max_weight"]) == 64
    result = server.client.get(f"{path}/result").json()
    last = {one["number"]: one for one in partials}
    assert [last[number]["mean"] for number in range(4)] == [series["mean"] for series in result["series"]]
    assert events(server, path) == [("done", {})]


def test_the_head_of_the_events_of_a_job_is_answered_at_once(server):
    path = server.start_job(seeded(HUGE, 65))
    reply = server.client.head(f"{path}/events")
    assert (reply.status_code, reply.headers["content-type"].partition(";")[0]) == (200, "text/event-stream")
    # The connection is free for the next request, although the job goes on.
    assert server.client.delete(path).json()["state"] == "cancelled"


def test_an_equal_question_finds_the_job_that_is_at_it_however_short_it_is(start_server):
    server = start_server(beat_timeout_s=PATIENCE_S)
    worker = server.worker("jobs")
    os.kill(worker, signal.SIGSTOP)
    path = server.start_job(seeded(SMALL, 66))
    assert server.ask(seeded(SMALL, 66)).headers["location"] == path
    os.kill(worker, signal.SIGCONT)
    server.await_job(path)
    assert server.ask(seeded(SMALL, 66)).content == server.client.get(f"{path}/result").content
    assert server.metric("samplerscope_answers_total", how="computed") == 0


def test_delete_cancels_at_the_next_launch_and_frees_the_device(server):
    path = server.start_job(seeded(HUGE, 53))
    server.await_job(path, wanted=("running",))
    before = server.client.get(path).json()["progress"]["done"]
    server.client.delete(path)
    cancelled = server.await_job(path, wanted=("cancelled",))
    # A launch draws some millions of samples: tens of them is soon, of the 640 thousand millions that were asked for.
    assert cancelled["progress"]["done"] - before < 10**9
    assert server.client.delete(path).json()["state"] == "cancelled"
    assert events(server, path) == [("cancelled", {})]
    assert server.client.get(f"{path}/result").status_code == 409
    # The lane is free: another job runs to its end, and the worker was not replaced for it.
    server.await_job(server.start_job(seeded(LONG, 54)))
    assert server.metric("samplerscope_worker_restarts_total", lane="jobs") == 0


def test_jobs_are_listed_newest_first(server):
    first, second = (server.start_job(seeded(SMALL, seed)) for seed in (55, 56))
    listed = [job["links"]["self"] for job in server.client.get("/v1/jobs").json()["jobs"]]
    assert listed.index(second) < listed.index(first)
    newest = server.client.get("/v1/jobs?limit=1").json()["jobs"]
    assert [job["links"]["self"] for job in newest] == [second]
    for wrong in ("limit=0", "limit=101", "limit=x", "limit=1&limit=2", "limit=", "limit=%D9%A3", "offset=1"):
        reply = server.client.get(f"/v1/jobs?{wrong}")
        assert (reply.status_code, reply.json()["errors"][0]["field"]) == (422, wrong.partition("=")[0])


@pytest.mark.parametrize("how", ["stop", "kill"])
def test_a_job_survives_a_restart_of_the_server_and_ends_with_the_same_bits(start_server, direct_answer, how):
    """`stop` is SIGTERM: the job is put off in order. `kill` is SIGKILL: what was stored last is gone on with."""
    scene = seeded(LONGER, 57)
    first = start_server()
    path = first.start_job(scene)
    reached = first.await_job(path, wanted=(), until=lambda job: job["progress"]["done"] > 0)["progress"]["done"]
    if how == "stop":
        assert first.stop() == 0
    else:
        with closing(sqlite3.connect(first.folder / "data" / "results-1.sqlite3")) as database:
            wait_until(
                lambda: database.execute("SELECT COUNT(*) FROM checkpoint").fetchone() != (0,), "a checkpoint is stored"
            )
        first.kill()
    second = start_server()
    resumed = [line for line in second.lines() if line["message"] == "going on with a job"]
    assert len(resumed) == 1
    assert resumed[0]["runs_begun"] >= 1
    if how == "stop":
        assert second.client.get(path).json()["progress"]["done"] >= reached
    second.await_job(path)
    assert without_run(second.client.get(f"{path}/result").json()) == direct_answer(scene)


def test_with_a_full_disk_questions_are_answered_and_jobs_refused_and_no_job_lives_on(start_server):
    server = start_server()
    stored = server.ask(SMALL)
    path = server.start_job(seeded(LONGER, 61))
    server.await_job(path, wanted=("running",))
    _, hard = resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (4096, resource.RLIM_INFINITY))
    assert server.ask(seeded(SMALL, 62)).status_code == 200
    assert server.ask(SMALL).content == stored.content
    assert server.client.post("/v1/jobs", json={"scene": seeded(HUGE, 63)}).status_code == 500
    assert server.await_job(path, wanted=("failed",))["error"]["status"] == 500
    server.await_lane("jobs", running=0, waiting=0)
    resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (hard, hard))
    server.await_job(server.start_job(seeded(SMALL, 64)))


def test_watchers_are_told_that_the_server_stops(start_server):
    server = start_server()
    path = server.start_job(seeded(HUGE, 58))
    server.await_job(path, wanted=("running",))
    with httpx.stream("GET", f"{server.url}{path}/events", timeout=PATIENCE_S) as reply:
        lines = reply.iter_lines()
        next(lines)
        # It ends at once, by what `stop` waits at most: the job itself takes an hour.
        assert server.stop() == 0
        assert "event: interrupted" in list(lines)


def test_a_watcher_that_goes_away_leaves_the_job_running(server):
    path = server.start_job(seeded(LONG, 59))
    assert len(events(server, path, most=2)) == 2
    assert server.await_job(path)["state"] == "done"


def test_convergence_is_a_job_whose_result_then_answers_the_question(server):
    link = (
        "/v1/convergence?model=eon&techniques=cosine&theta_o_deg=0,45&samples=512&reference=false"
        "&estimators=mc&replicates=32&target_error=0.1"
    )
    reply = server.client.get(link)
    assert reply.status_code == 202
    assert server.await_job(reply.headers["location"])["kind"] == "convergence"
    answer = server.client.get(link)
    assert answer.status_code == 200
    result = answer.json()
    assert (result["kind"], result["target_error"]) == ("convergence", 0.1)
    assert [one["technique"] for one in result["series"]] == ["cosine"]
    assert len(result["series"][0]["theta_o_deg"]) == 2
    wrong = server.client.get(
        link.replace("replicates=32", "replicates=2").replace("target_error=0.1", "target_error=7")
    )
    assert {error["field"] for error in wrong.json()["errors"]} == {"replicates", "target_error"}


def test_small_jobs_overtake_a_long_convergence_and_delete_ends_it(server):
    scene = {"model": "eon", "estimator": {"samples": 2**24}, "reference": False}
    long = server.client.post("/v1/jobs", json={"kind": "convergence", "scene": scene}).headers["location"]
    server.await_lane("jobs", running=1, waiting=0)
    server.await_job(server.start_job(seeded(SMALL, 60)))
    assert server.client.get(long).json()["state"] in ("queued", "running")
    server.client.delete(long)
    server.await_job(long, wanted=("cancelled",))
    server.await_lane("jobs", running=0, waiting=0)
    assert server.metric("samplerscope_worker_restarts_total", lane="jobs") == 0


def test_stability_is_a_job_whose_result_then_answers_the_question(server):
    path = "/v1/stability?model=lambert&techniques=cosine"
    reply = server.client.get(path)
    assert reply.status_code == 202
    found = server.await_job(reply.headers["location"])
    assert (found["kind"], found["state"]) == ("stability", "done")
    result = server.client.get(path).json()
    assert (result["kind"], result["status"]) == ("stability", "pass")
    assert sum(region["nonfinite"] for region in result["regions"]) == 0
