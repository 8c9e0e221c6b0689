"""A run that is interrupted after every launch and goes on from packed checkpoints ends with the same bits."""

import itertools
import json

import pytest
from http_server import without_run

from service.scene import parse_scene, resolve
from service.statistics import compute_statistics
from service.worker import checkpoints
from service.worker.kinds import KINDS


class Interruption(Exception):
    pass


class Journals:
    """Keeps checkpoints as bytes, and raises at the first that it was not given before."""

    def __init__(self, kept):
        self.kept = kept

    def __call__(self, series):
        return SeriesJournal(self.kept, series)


class SeriesJournal:
    def __init__(self, kept, series):
        self._kept, self._series, self._runs = kept, series, 0

    def begin(self):
        self._runs += 1
        packed = self._kept.get((self._series, self._runs))
        return None if packed is None else checkpoints.unpack(packed)

    def save(self, checkpoint):
        self._kept[self._series, self._runs] = checkpoints.pack(checkpoint)
        raise Interruption


@pytest.mark.parametrize(
    "estimator",
    [
        {"samples": 8_000_000, "seed": 7},
        {"samples": 8_000_000, "seed": 7, "method": "qmc"},
        {"tolerance": 0.02, "seed": 7, "method": "mc"},
    ],
    ids=["mc", "qmc", "tolerance"],
)
def test_an_interrupted_run_ends_with_the_same_bits(engine, estimator):
    scene = {
        "model": "eon",
        "techniques": ["cosine", "cltc-mis"],
        "theta_o_deg": [0.0, 45.0, 88.0],
        "estimator": estimator,
        "reference": False,
    }
    question = resolve(parse_scene(scene), engine.catalogue)
    kept, interruptions = {}, 0
    while True:
        try:
            result = compute_statistics(question, engine, journal=Journals(kept))
            break
        except Interruption:
            interruptions += 1
    whole = compute_statistics(question, engine)
    assert interruptions >= 3
    assert without_run(json.loads(json.dumps(result))) == without_run(json.loads(json.dumps(whole)))


@pytest.mark.parametrize(
    ("kind", "scene"),
    [
        ("convergence", {"techniques": "cosine", "theta_o_deg": [45.0], "estimator": {"samples": 512}}),
        ("stability", {"techniques": "cosine"}),
    ],
)
def test_work_without_checkpoints_is_ended_at_any_step_and_leaves_nothing_on_the_device(
    engine, monkeypatch, kind, scene
):
    question = resolve(KINDS[kind].parse({"model": "eon", "reference": False, **scene}), engine.catalogue)
    steps = itertools.count()
    monkeypatch.setattr(engine, "pause", lambda: next(steps) and None)
    KINDS[kind].compute(question, engine, lambda *_: None)
    before, count = engine.device.live_objects, next(steps)
    assert count >= 5
    for last in range(0, count, count // 5):
        left = iter(range(last))

        def pause(left=left):
            if next(left, None) is None:
                raise Interruption

        monkeypatch.setattr(engine, "pause", pause)
        with pytest.raises(Interruption):
            KINDS[kind].compute(question, engine, lambda *_: None)
        assert engine.device.live_objects == before


def test_an_interruption_leaves_nothing_on_the_device(engine):
    question = resolve(
        parse_scene({"model": "eon", "techniques": "cosine", "estimator": {"samples": 1_000_000}, "reference": False}),
        engine.catalogue,
    )
    compute_statistics(question, engine)
    before = engine.device.live_objects
    with pytest.raises(Interruption):
        compute_statistics(question, engine, journal=Journals({}))
    assert engine.device.live_objects == before
