"""A battery run on one subject, given as the command line does; each run is made once a session."""

from pathlib import Path

import pytest

from service.catalogue import load_catalogue
from service.checks.battery import Battery, run_battery
from service.checks.selection import select
from service.engine import Engine

BROKEN = Path(__file__).parents[2] / "broken"
_RESULTS = {}


@pytest.fixture
def battery(engine):
    def run(given, model=None, techniques=None, *, quick=True, seed=0):
        key = (str(given), model, tuple(techniques or ()), quick, seed)
        if key not in _RESULTS:
            subject = select(str(given), load_catalogue(), model, techniques)
            at = Engine(engine.device, subject.catalogue, engine.cache)
            _RESULTS[key] = run_battery(at, subject, Battery(seed=seed, quick=quick))
        return _RESULTS[key]

    return run


def failures(result):
    return {check["name"] for check in result["checks"] if check["status"] == "fail"}


def outcome(result, name):
    return next(check for check in result["checks"] if check["name"] == name)
