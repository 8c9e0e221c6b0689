"""The parent's side: starts the worker, watches it, ends it with everything it started."""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from lavapipe import DeviceNotFound
from service.errors import SamplerscopeError

SILENCE_S = 45.0
"""A worker that says nothing for so long is ended."""

MEMORY_BYTES = 3 << 30
RESULT_BYTES = 1 << 30

Progress = Callable[[str, int, int], None]


class OwnFileFailed(SamplerscopeError):
    """A user's file that cannot be run: it breaks a rule, does not end, or takes the driver down with it."""


def run_isolated(
    task: str, arguments: Mapping[str, Any], progress: Progress = lambda *_: None, silence_s: float = SILENCE_S
) -> dict[str, Any]:
    """Run a task of `service.isolation.tasks` in a worker and return its result.

    Raises OwnFileFailed with what the worker said, or with how it ended; DeviceNotFound as the worker met it.
    """
    root = str(Path(__file__).resolve().parents[2])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in (root, os.environ.get("PYTHONPATH")) if p)}
    worker = subprocess.Popen(
        [sys.executable, "-c", "from service.isolation.worker import main; main()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=environment,
        start_new_session=True,
    )
    try:
        message = json.dumps({"task": task, "arguments": dict(arguments), "memory_bytes": MEMORY_BYTES})
        with contextlib.suppress(BrokenPipeError):
            assert worker.stdin is not None
            worker.stdin.write(message.encode() + b"\n")
            worker.stdin.close()
        return _follow(worker, progress, silence_s)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(worker.pid, signal.SIGKILL)
        worker.wait()
        assert worker.stdout is not None
        worker.stdout.close()


def _follow(worker: subprocess.Popen[bytes], progress: Progress, silence_s: float) -> dict[str, Any]:
    assert worker.stdout is not None
    pending, doing = bytearray(), "starting"
    with selectors.DefaultSelector() as selector:
        selector.register(worker.stdout, selectors.EVENT_READ)
        deadline = time.monotonic() + silence_s
        while True:
            if not selector.select(max(0.0, deadline - time.monotonic())):
                raise OwnFileFailed(
                    f"no answer for {silence_s:g} s ({doing}): code without end, or too heavy; it was ended"
                )
            chunk = os.read(worker.stdout.fileno(), 1 << 16)
            if not chunk:
                raise OwnFileFailed(f"{_end(worker.wait())} ({doing})")
            deadline = time.monotonic() + silence_s
            pending += chunk
            if len(pending) > RESULT_BYTES:
                raise OwnFileFailed("the result is too large")
            while (end := pending.find(b"\n")) >= 0:
                said = json.loads(pending[:end])
                del pending[: end + 1]
                if "progress" in said:
                    doing = str(said["progress"][0])
                    progress(*said["progress"])
                elif "result" in said:
                    return dict(said["result"])
                else:
                    raise (DeviceNotFound if said["no_device"] else OwnFileFailed)(said["error"])


def _end(code: int) -> str:
    if code < 0:
        name = signal.Signals(-code).name if -code in set(signal.Signals) else str(-code)
        return f"the driver did not survive this code: its process ended with {name}, for want of memory or of stack"
    return f"the worker ended with code {code}: out of memory, or the driver gave up"
