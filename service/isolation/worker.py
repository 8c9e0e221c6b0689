"""The worker: reads one task from stdin, limits itself, runs it, and writes JSON lines to the stdout it was given."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import resource
import signal
import sys
from typing import Any

_PR_SET_PDEATHSIG, _PR_SET_NO_NEW_PRIVS = 1, 38


def main() -> None:
    """Run the task on stdin. The driver may write to stdout, so messages have a descriptor of their own."""
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def say(**message: Any) -> None:
        channel.write(json.dumps(message) + "\n")
        channel.flush()

    job = json.loads(sys.stdin.readline())
    limit(job["memory_bytes"])
    from lavapipe import DeviceNotFound, LavapipeError
    from service.errors import SamplerscopeError
    from service.isolation import tasks

    try:
        run = tasks.TASKS[job["task"]]
        say(result=run(job["arguments"], lambda *what: say(progress=what)))
    except (SamplerscopeError, LavapipeError, OSError) as error:
        say(error=str(error), no_device=isinstance(error, DeviceNotFound))
    except MemoryError:
        say(error="out of memory", no_device=False)
    channel.flush()
    # The driver's threads may still be at work; nothing of theirs is wanted.
    os._exit(0)


def limit(memory_bytes: int) -> None:
    """Bound what this process may take, and let it end with its parent."""
    prctl = ctypes.CDLL(None).prctl
    prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    for kind, wanted in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, 1 << 28),
    ):
        _, hard = resource.getrlimit(kind)
        bound = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(kind, (bound, bound))
