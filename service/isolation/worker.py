"""The worker: reads one task from stdin, limits itself, runs it, and writes JSON lines to the stdout it was given."""

from __future__ import annotations

import json
import os
import sys
from contextlib import AbstractContextManager, nullcontext, suppress
from importlib import import_module
from typing import Any

_LAZY = ("numpy.fft", "numpy.linalg", "numpy.ma", "numpy.polynomial", "numpy.random")
"""What NumPy loads when it is first used, itself too: its median asks for masked arrays."""


def main() -> None:
    """Run the task on stdin. The driver may write to stdout, so messages have a descriptor of their own."""
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def say(**message: Any) -> None:
        channel.write(json.dumps(message) + "\n")
        channel.flush()

    job = json.loads(sys.stdin.readline())
    # What is read is read before the right to read goes: modules, the catalogue, the jobs, the references. Who root
    # becomes may not even enter the folder that this program is in.
    for part in _LAZY:
        import_module(part)
    with suppress(OSError):  # without a Vulkan loader; Engine.open says so
        import_module("vulkan")
    from lavapipe import CompileError, DeviceNotFound, LavapipeError
    from service.catalogue import hemisphere, load_catalogue
    from service.engine import Engine
    from service.errors import BadInput, SamplerscopeError
    from service.isolation import confinement, tasks
    from service.reference_store import load_references
    from service.variant import job_texts

    def as_strict_as_asked() -> AbstractContextManager[None]:
        """Within it a worker that need not be strict goes on where the system cannot confine it."""
        return nullcontext() if job["strict"] else suppress(confinement.CannotConfine)

    def seal(engine: Engine, pairs: tasks.Pairs) -> None:
        """Compile all that the task may need, which takes a program, and give up everything but computing."""
        engine.compile_all(pairs, truth=job["task"] in tasks.WITH_TRUTH)
        with as_strict_as_asked():
            confinement.allow_computing_only()

    try:
        load_references(load_catalogue())
        hemisphere()
        job_texts()
        confinement.limit(job["memory_bytes"])
        with as_strict_as_asked():
            confinement.become_unprivileged()
        say(result=tasks.TASKS[job["task"]](job["arguments"], lambda *what: say(progress=what), seal))
    except (SamplerscopeError, LavapipeError, OSError) as error:
        say(
            error=str(error),
            no_device=isinstance(error, DeviceNotFound),
            diagnostics=[vars(one) for one in error.diagnostics] if isinstance(error, CompileError) else [],
            problems=[vars(one) for one in error.problems] if isinstance(error, BadInput) else [],
        )
    except MemoryError:
        say(error="out of memory", no_device=False, diagnostics=[], problems=[])
    except Exception as error:
        fault = f"a fault of samplerscope itself, not of the file: {type(error).__name__}: {error}"
        say(error=fault, no_device=False, diagnostics=[], problems=[])
    channel.flush()
    # The driver's threads may still be at work; nothing of theirs is wanted.
    os._exit(0)
