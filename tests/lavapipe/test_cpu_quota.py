"""The quota of a control group, in both versions of its files."""

import os
from pathlib import Path

import pytest

from lavapipe.threads import cpu_quota, respect_quota


@pytest.mark.parametrize(
    ("files", "cpus"),
    [
        ({"cpu.max": "150000 100000\n"}, 1.5),
        ({"cpu.max": "max 100000\n"}, None),
        ({"cpu/cpu.cfs_quota_us": "50000\n", "cpu/cpu.cfs_period_us": "100000\n"}, 0.5),
        ({"cpu/cpu.cfs_quota_us": "-1\n", "cpu/cpu.cfs_period_us": "100000\n"}, None),
        ({}, None),
        ({"cpu.max": "nonsense"}, None),
    ],
)
def test_quota_is_read_in_cpus(files: dict[str, str], cpus: float | None, tmp_path: Path) -> None:
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    assert cpu_quota(tmp_path) == cpus


def test_a_quota_below_the_cpus_sets_the_threads_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cpu.max").write_text("50000 100000")
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2, 3})
    monkeypatch.delenv("LP_NUM_THREADS", raising=False)
    respect_quota(tmp_path)
    assert os.environ["LP_NUM_THREADS"] == "1"
    (tmp_path / "cpu.max").write_text("250000 100000")
    respect_quota(tmp_path)
    assert os.environ["LP_NUM_THREADS"] == "1"
