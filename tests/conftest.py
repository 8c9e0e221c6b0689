"""One validating device for the whole run, and a cache that leaves no trace."""

import os
from collections.abc import Iterator

import pytest

from lavapipe import Device


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    before = os.environ.get("SAMPLERSCOPE_CACHE_DIR")
    os.environ["SAMPLERSCOPE_CACHE_DIR"] = str(tmp_path_factory.mktemp("cache"))
    yield
    if before is None:
        del os.environ["SAMPLERSCOPE_CACHE_DIR"]
    else:
        os.environ["SAMPLERSCOPE_CACHE_DIR"] = before


@pytest.fixture(scope="session")
def _session_device() -> Iterator[Device]:
    with Device.open(validation=True) as device:
        yield device


@pytest.fixture
def device(_session_device: Device) -> Iterator[Device]:
    """The session's device; what the validation layer says during a test fails that test."""
    yield _session_device
    _session_device.check_messages()
