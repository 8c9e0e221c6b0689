"""The store: whole or not at all, bounded in size, age and number, and one server at a time."""

import sqlite3
import time
from contextlib import closing
from dataclasses import replace

import pytest

from service.errors import BadInput
from service.jobs import store as module
from service.jobs.store import Job, Store, Stored


@pytest.fixture
def opened(tmp_path):
    stores = []

    def make(limit_bytes=10**6, max_age_s=1000.0, max_jobs=10):
        stores.append(Store(tmp_path, limit_bytes, max_age_s, max_jobs))
        return stores[-1]

    yield make
    for store in stores:
        store.close()


def a_job(number, state="queued"):
    now = time.time()
    return Job(f"job{number}", f"key{number}", "statistics", {"model": "eon"}, state, now, now, 0, 100, 1.0)


def test_what_came_first_under_a_key_stays(opened):
    store = opened()
    first, second = Stored.of(b"first"), Stored.of(b"second")
    for one in (first, second):
        store.keep_results({"key": one})
        assert store.result("key") == first
    store.finish_job(replace(a_job(1), key="key"), second)
    assert store.result("key") == first
    assert first.etag != second.etag


def test_results_beyond_the_limit_go_least_recently_used_first(opened):
    store = opened(limit_bytes=350)
    for number in range(3):
        store.keep_results({f"key{number}": Stored.of(bytes([number]) * 100)})
        time.sleep(0.002)
    assert store.result("key0") is not None  # used now
    time.sleep(0.002)
    store.keep_results({"key3": Stored.of(b"3" * 100)})
    store.prune()
    assert [number for number in range(4) if store.result(f"key{number}")] == [0, 2, 3]


def test_the_bytes_of_results_are_counted_as_they_come_and_go_and_of_an_older_file_once(tmp_path, opened):
    store = opened(limit_bytes=350)
    for key, size in (("a", 100), ("a", 100), ("b", 200), ("c", 150)):
        store.keep_results({key: Stored.of(b"x" * size)})
    store.prune()
    store.close()
    with closing(sqlite3.connect(tmp_path / "results-1.sqlite3")) as database:
        assert database.execute("SELECT bytes, (SELECT SUM(LENGTH(content)) FROM result) FROM total").fetchall() == [
            (350, 350)
        ]
        database.executescript("DROP TRIGGER result_came; DROP TRIGGER result_went; DROP TABLE total;")
    store = opened(limit_bytes=300)
    assert sorted(store.keys()) == ["c"]


def test_of_much_that_is_to_go_some_goes_at_a_time(opened, monkeypatch):
    monkeypatch.setattr(module, "PRUNED_AT_ONCE", 2)
    store = opened(limit_bytes=1)
    store.keep_results({f"key{number}": Stored.of(b"x") for number in range(6)})
    gone = [store.prune() for _ in range(4)]
    assert [len(keys) for keys in gone] == [2, 2, 1, 0]
    assert store.keys().isdisjoint(set().union(*gone))


def test_old_results_and_old_finished_jobs_go_and_unfinished_jobs_stay(opened):
    store = opened(max_age_s=0.05)
    store.keep_results({"key": Stored.of(b"old")})
    store.keep_job(a_job(1, "done"))
    store.keep_job(a_job(2, "running"))
    time.sleep(0.1)
    store.prune()
    assert store.result("key") is None
    assert store.job("job1") is None
    assert store.job("job2") is not None


def test_finished_jobs_beyond_their_number_go_oldest_first(opened):
    store = opened(max_jobs=2)
    for number in range(4):
        store.keep_job(a_job(number, "done"))
        time.sleep(0.002)
    store.prune()
    assert [job.id for job in store.jobs(10)] == ["job3", "job2"]


def test_checkpoints_of_a_finished_job_are_forgotten_and_cannot_come_back(opened):
    store = opened()
    job = a_job(1)
    store.keep_checkpoint(job, "0.1", b"too early")
    assert store.checkpoints("job1") == {}
    store.keep_job(job)
    store.keep_checkpoint(job, "0.1", b"one")
    store.keep_checkpoint(job, "0.1", b"two")
    store.keep_checkpoint(job, "1.1", b"three")
    assert store.checkpoints("job1") == {"0.1": b"two", "1.1": b"three"}
    store.finish_job(job, Stored.of(b"result"))
    store.keep_checkpoint(job, "0.1", b"too late")
    assert store.checkpoints("job1") == {}
    assert store.job("job1").state == "done"


def test_a_job_comes_back_as_it_was_stored(opened):
    store = opened()
    job = replace(a_job(1, "failed"), error={"title": "x"}, done=7)
    store.keep_job(job)
    assert store.job("job1") == job
    assert store.unfinished_jobs() == []


def test_a_second_server_is_refused_and_a_closed_one_gives_the_folder_free(tmp_path, opened):
    store = opened()
    with pytest.raises(BadInput, match="no other server"):
        opened()
    store.keep_results({"key": Stored.of(b"kept")})
    store.close()
    again = Store(tmp_path, 10**6, 1000.0, 10)
    assert again.result("key") == Stored.of(b"kept")
    again.close()


def test_a_damaged_file_is_put_aside(tmp_path):
    (tmp_path / "results-1.sqlite3").write_bytes(b"not a database" * 1000)
    store = Store(tmp_path, 10**6, 1000.0, 10)
    store.keep_results({"key": Stored.of(b"new")})
    assert store.result("key") is not None
    store.close()
    assert (tmp_path / "results-1.sqlite3.damaged").exists()
