"""What the tests of the service share: an engine on the real driver with validation, scenes answered, inputs probed."""

from __future__ import annotations

import numpy as np
import pytest

from lavapipe import default_cache
from service.catalogue import load_catalogue
from service.engine import Engine
from service.probe import Probe
from service.scene import parse_scene, resolve
from service.statistics import compute_statistics


@pytest.fixture(scope="session")
def session_engine(_session_device):
    return Engine(_session_device, load_catalogue(), default_cache())


@pytest.fixture
def engine(device, session_engine):
    """The session's engine; `device` fails the test on what the validation layer says."""
    return session_engine


@pytest.fixture
def compute(engine):
    """Answer a scene given as keywords; the model is eon unless said."""

    def run(catalogue=None, **scene):
        at = engine if catalogue is None else Engine(engine.device, catalogue, engine.cache)
        return compute_statistics(resolve(parse_scene({"model": "eon", **scene}), at.catalogue), at)

    return run


@pytest.fixture
def probe(engine):
    """Evaluate a model and technique at (u1, u2) or at wi, for one view each: arrays of the probe's outputs."""

    def run(model, technique, wo, *, u=None, wi=None, catalogue=None, **parameters):
        at = engine if catalogue is None else Engine(engine.device, catalogue, engine.cache)
        one = Probe(at, at.catalogue.model(model), at.catalogue.technique(technique))
        row = [parameters.get(name, parameter.default) for name, parameter in one.declared.items()]
        wo, row = np.asarray(wo, np.float32), np.array([row], np.float32)
        found = one.draw(wo, u, row) if wi is None else one.evaluate(wo, wi, row)
        return vars(found)

    return run


def view(theta_o, phi_o=0.0):
    """wo for angles in radians, shape (..., 3)."""
    theta_o, phi_o = np.broadcast_arrays(np.asarray(theta_o, float), np.asarray(phi_o, float))
    return np.stack([np.sin(theta_o) * np.cos(phi_o), np.sin(theta_o) * np.sin(phi_o), np.cos(theta_o)], axis=-1)


def column(series, *names):
    """A column of a series, by the names on the way to it, as an array; null becomes NaN."""
    value = series
    for name in names:
        value = value[name]
    return np.array(value, float)
