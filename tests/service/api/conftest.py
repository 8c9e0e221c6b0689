"""Real servers on real ports of the loopback interface, with real workers on lavapipe."""

from __future__ import annotations

import json

import pytest
from http_server import Server, without_run


@pytest.fixture
def start_server(tmp_path):
    """Start servers with settings of their own; all share one data folder unless told otherwise."""
    servers = []

    def start(**settings) -> Server:
        servers.append(Server(tmp_path, **settings))
        return servers[-1]

    yield start
    for server in servers:
        if server.process.poll() is None:
            server.stop()


@pytest.fixture(scope="session")
def server(tmp_path_factory, _own_cache):
    """One server for all tests that leave it as it is."""
    running = Server(tmp_path_factory.mktemp("server"))
    yield running
    assert running.stop() == 0


@pytest.fixture(scope="session")
def direct_answer(session_engine):
    """The result that a function call gives, without run and times."""
    from service.scene import parse_scene, resolve
    from service.statistics import compute_statistics

    known = {}

    def compute(scene):
        name = json.dumps(scene)
        if name not in known:
            known[name] = fresh(scene)
        return known[name]

    def fresh(scene):
        result = compute_statistics(resolve(parse_scene(scene), session_engine.catalogue), session_engine)
        return without_run(json.loads(json.dumps(result)))

    return compute
