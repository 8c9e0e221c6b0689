"""Time bounds that hold on a busy machine too: what a process waited for a processor is not its fault."""

from __future__ import annotations

import os
import time
from pathlib import Path


def _waited_s(pid: int) -> float:
    """Seconds that the main thread of a process was ready to run and had no processor, so far."""
    return int(Path(f"/proc/{pid}/schedstat").read_text().split()[1]) / 1e9


class OwnTime:
    """Seconds since it was made, less those that this process and `others` waited for a processor meanwhile.

    For work that is done by the main threads of these processes in turn, as an answer is: on a free machine that is the
    wall time, and on a busy one about what it would be on a free one.
    """

    def __init__(self, *others: int) -> None:
        self._waited_before = {pid: _waited_s(pid) for pid in (os.getpid(), *others)}
        self._begin = time.monotonic()

    def seconds(self, *born: int) -> float:
        """The time so far. `born` are processes that were started since."""
        elapsed = time.monotonic() - self._begin
        waited = sum(_waited_s(pid) - before for pid, before in self._waited_before.items())
        return elapsed - waited - sum(map(_waited_s, born))
