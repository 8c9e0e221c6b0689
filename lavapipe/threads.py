"""How many threads the driver should start: the CPUs it may use, which it does not find out by itself under a quota.

Lavapipe starts a thread for every CPU that the process may run on. A control group's quota (a container's `--cpus`) is
not seen by it: more threads than the quota allows then only take turns.
"""

from __future__ import annotations

import math
import os
from pathlib import Path

_VARIABLE = "LP_NUM_THREADS"
_GROUPS = Path("/sys/fs/cgroup")


def respect_quota(groups: Path = _GROUPS) -> None:
    """Set LP_NUM_THREADS to the CPU quota of the control group where it is below the CPUs; a value set stays."""
    quota = cpu_quota(groups)
    if quota is not None and _VARIABLE not in os.environ and math.ceil(quota) < len(os.sched_getaffinity(0)):
        os.environ[_VARIABLE] = str(math.ceil(quota))


def cpu_quota(groups: Path = _GROUPS) -> float | None:
    """The quota in CPUs of the control group seen at `groups` (version 2, else 1); None where there is none."""
    try:
        quota, period = (groups / "cpu.max").read_text().split()
    except (OSError, ValueError):
        quota, period = (_read(groups / "cpu" / f"cpu.cfs_{name}_us") for name in ("quota", "period"))
    try:
        cpus = int(quota) / int(period)
    except (ValueError, ZeroDivisionError):
        return None
    return cpus if cpus > 0 else None


def _read(path: Path) -> str:
    try:
        return path.read_text().strip()
    except OSError:
        return ""
