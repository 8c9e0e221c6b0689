"""Answers without a server: one key has one answer, in memory, on its way to the disk, and on it."""

import asyncio

from service.jobs import answers as module
from service.jobs.answers import Answers
from service.jobs.estimates import Costs
from service.jobs.store import Store, Stored
from service.worker.lane import Lane, LaneSettings


def with_answers(folder, use):
    """Run `use(answers)` in an event loop, end as a server does, and return what is stored by key."""

    async def run():
        lane = Lane(LaneSettings("none"))
        store = Store(folder, 10**9, 1000.0, 10)
        answers = Answers(store, lane, lane, Costs(), client_limit=1, timeout_s=1.0)
        await use(answers)
        answers.close()
        keys = store.keys()
        kept = {key: store.result(key) for key in keys}
        store.close()
        return kept

    return asyncio.run(run())


async def arrive(answers, key, content):
    """A direct answer has been computed."""
    stored = await answers.settle(key, content)
    answers._store_soon(key, stored)
    return stored


def test_the_first_answer_of_a_key_stays_wherever_it_is(tmp_path, monkeypatch):
    first = Stored.of(b"first")

    async def use(answers):
        assert await arrive(answers, "key", b"first") == first
        assert await arrive(answers, "key", b"second") == first
        # Room for one: the next answer takes its place in memory, before it is on disk and after.
        monkeypatch.setattr(module, "MEMORY_BYTES", 1)
        await arrive(answers, "other", b"other")
        assert await answers.settle("key", b"third") == first
        await asyncio.sleep(2 * module.STORE_AFTER_S)
        await arrive(answers, "another", b"another")
        assert await answers.settle("key", b"fourth") == first

    assert with_answers(tmp_path, use)["key"] == first


def test_an_answer_that_went_out_just_before_the_end_is_stored(tmp_path):
    async def use(answers):
        await arrive(answers, "key", b"late")

    assert with_answers(tmp_path, use) == {"key": Stored.of(b"late")}


def test_an_answer_that_cannot_be_stored_is_still_answered(tmp_path, monkeypatch):
    async def use(answers):
        monkeypatch.setattr(answers.store, "keep_results", lambda results: 1 / 0)
        await arrive(answers, "key", b"kept in memory")
        await asyncio.sleep(2 * module.STORE_AFTER_S)
        assert await answers.find("key") == Stored.of(b"kept in memory")

    assert with_answers(tmp_path, use) == {}
