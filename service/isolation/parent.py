"""The parent's side: starts the worker, watches it, ends it with everything it started."""

from __future__ import annotations

import contextlib
import json
import math
import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lavapipe import DeviceNotFound
from service.errors import SamplerscopeError

if TYPE_CHECKING:
    from service.statistics import Progress

SILENCE_S = 45.0
"""A worker that says nothing for so long is ended."""

MEMORY_BYTES = 3 << 30
RESULT_BYTES = 1 << 30
PAUSE_S = 0.25


class OwnFileFailed(SamplerscopeError):
    """A user's file that cannot be run: it breaks a rule, does not end, or takes the driver down with it.

    `diagnostics` are the compiler's messages (file, line, message), `problems` the wrong fields (field, value, allowed)
    of what was asked about it; either may be empty.
    """

    def __init__(self, message: str, diagnostics: Sequence[Any] = (), problems: Sequence[Any] = ()) -> None:
        super().__init__(message)
        self.diagnostics = diagnostics
        self.problems = problems


@dataclass(frozen=True)
class Bounds:
    """How long a worker may be silent, and how long it may take in all.

    With `strict` it refuses to run where it cannot be confined: files and network closed to it, and root given up.
    """

    silence_s: float = SILENCE_S
    total_s: float = math.inf
    strict: bool = False


def run_isolated(
    task: str,
    arguments: Mapping[str, Any],
    progress: Progress = lambda *_: None,
    bounds: Bounds = Bounds(),
    pause: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """Run a task of `service.isolation.tasks` in a worker and return its result.

    `pause` is called several times a second; what it raises ends the worker. Raises OwnFileFailed with what the worker
    said, or with how it ended; DeviceNotFound as the worker met it.
    """
    worker = subprocess.Popen(
        [sys.executable, "-c", "from service.isolation.worker import main; main()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=_environment(),
        start_new_session=True,
    )
    try:
        limits = {"memory_bytes": MEMORY_BYTES, "strict": bounds.strict}
        message = json.dumps({"task": task, "arguments": dict(arguments), **limits})
        with contextlib.suppress(BrokenPipeError):
            assert worker.stdin is not None
            worker.stdin.write(message.encode() + b"\n")
            worker.stdin.close()
        return _follow(worker, progress, bounds, pause)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(worker.pid, signal.SIGKILL)
        worker.wait()
        assert worker.stdout is not None
        worker.stdout.close()


def _environment() -> dict[str, str]:
    """This process's, without settings and keys of the service, and with no cache to write to."""
    root = str(Path(__file__).resolve().parents[2])
    kept = {name: value for name, value in os.environ.items() if not name.startswith("SAMPLERSCOPE_")}
    return kept | {
        "PYTHONPATH": os.pathsep.join(path for path in (root, os.environ.get("PYTHONPATH")) if path),
        "SAMPLERSCOPE_CACHE_DIR": "off",
        "MESA_SHADER_CACHE_DISABLE": "true",
    }


def _follow(
    worker: subprocess.Popen[bytes], progress: Progress, bounds: Bounds, pause: Callable[[], None]
) -> dict[str, Any]:
    assert worker.stdout is not None
    pending, doing = bytearray(), "starting"
    end = time.monotonic() + bounds.total_s
    heard = time.monotonic()
    with selectors.DefaultSelector() as selector:
        selector.register(worker.stdout, selectors.EVENT_READ)
        while True:
            pause()
            if not selector.select(min(PAUSE_S, bounds.silence_s)):
                _check_time(heard, end, bounds, doing)
                continue
            chunk = os.read(worker.stdout.fileno(), 1 << 16)
            if not chunk:
                raise OwnFileFailed(f"{_end(worker.wait())} ({doing})")
            heard = time.monotonic()
            _check_time(heard, end, bounds, doing)
            pending += chunk
            if len(pending) > RESULT_BYTES:
                raise OwnFileFailed("the result is too large")
            while (newline := pending.find(b"\n")) >= 0:
                said = json.loads(pending[:newline])
                del pending[: newline + 1]
                if "progress" in said:
                    doing = str(said["progress"][0])
                    progress(*said["progress"])
                elif "result" in said:
                    return dict(said["result"])
                elif said["no_device"]:
                    raise DeviceNotFound(said["error"])
                else:
                    raise OwnFileFailed(said["error"], said["diagnostics"], said["problems"])


def _check_time(heard: float, end: float, bounds: Bounds, doing: str) -> None:
    now = time.monotonic()
    if now > end:
        raise OwnFileFailed(f"not done within {bounds.total_s:g} s ({doing}); it was ended")
    if now - heard > bounds.silence_s:
        raise OwnFileFailed(
            f"no answer for {bounds.silence_s:g} s ({doing}): code without end, or too heavy; it was ended"
        )


def _end(code: int) -> str:
    if code < 0:
        name = signal.Signals(-code).name if -code in set(signal.Signals) else str(-code)
        return f"the driver did not survive this code: its process ended with {name}, for want of memory or of stack"
    return f"the worker ended with code {code}: out of memory, or the driver gave up"
