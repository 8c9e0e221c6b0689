"""GLSL to SPIR-V with glslangValidator, in a child process that is bounded in time and memory."""

from __future__ import annotations

import hashlib
import os
import re
import resource
import shutil
import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path

from lavapipe.cache import Cache, default_cache
from lavapipe.errors import CompileError, DeviceNotFound, Diagnostic, InvalidArgument
from lavapipe.glsl import Composed, Define, compose

_COMMAND = "glslangValidator"
_FLAGS = ("--quiet", "--stdin", "-S", "comp", "--target-env", "vulkan1.2")
_MEMORY_BYTES = 1 << 30
_SPIRV_BYTES = 64 << 20
_MESSAGE_LIMIT = 100
# "ERROR: 3:12: 'x' : undeclared identifier": the file's number, the line, the message.
_LOCATED = re.compile(r"ERROR: (\d+|stdin):(\d+): (.*)")
_UNLOCATED = re.compile(r"ERROR: (.*)")
_SUMMARY = re.compile(r"\d+ compilation errors?\.|.*compilation terminated")


def compile_glsl(
    source: str,
    *,
    name: str = "shader.comp",
    include: Mapping[str, str] | None = None,
    defines: Mapping[str, Define] | None = None,
    cache: Cache | None = None,
    timeout_s: float = 60,
) -> bytes:
    """Compile a GLSL compute shader to SPIR-V for Vulkan 1.2.

    `name` stands for the source in error messages. `#include "NAME"` takes its text from `include` and from nowhere
    else. `defines` follow `#version` (460 where the source has none). `#line LINE "FILE"` is honoured. The result is
    kept in `cache`, by default the user's. Raises CompileError with file and line of each message, also where the
    compiler takes longer than `timeout_s` seconds or more memory than it may; InvalidArgument for a bad define;
    DeviceNotFound where glslangValidator is not installed and the result is not in the cache.
    """
    if timeout_s <= 0:
        raise InvalidArgument(f"timeout_s={timeout_s}: a positive number of seconds")
    composed = compose(source, name, include or {}, defines or {})
    found = shutil.which(_COMMAND)
    identity = _identity(Path(found)) if found else None
    cache = default_cache() if cache is None else cache
    key = "spirv-" + hashlib.sha256("\0".join([*_FLAGS, composed.text]).encode()).hexdigest()
    made_by, _, spirv = (cache.get(key) or b"").partition(b"\n")
    # Where there is no compiler, as in an image without one, what another has compiled is still right.
    if spirv and identity in (made_by, None):
        return spirv
    if found is None:
        raise DeviceNotFound(f"{_COMMAND} is not installed: run lavapipe/install.sh")
    spirv = _run(Path(found), composed, name, timeout_s)
    cache.put(key, _identity(Path(found)) + b"\n" + spirv)
    return spirv


def _identity(compiler: Path) -> bytes:
    """The compiler's own date and size: they stand for its version, which would cost a process start to ask for."""
    status = compiler.stat()
    return f"{status.st_mtime_ns} {status.st_size}".encode()


def _run(compiler: Path, composed: Composed, name: str, timeout_s: float) -> bytes:
    # The result goes to memory, so that no folder need be writable.
    with open(os.memfd_create("spirv"), "w+b") as output:
        path = f"/proc/self/fd/{output.fileno()}"
        child = subprocess.Popen(
            [compiler, *_FLAGS, "-o", path],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            pass_fds=[output.fileno()],
            cwd="/",
        )
        with child:
            try:
                _limit(child.pid, timeout_s)
                said, _ = child.communicate(composed.text.encode(), timeout_s)
            except subprocess.TimeoutExpired:
                raise _failed(name, f"the compiler was not done after {timeout_s} s") from None
            finally:
                child.kill()
        spirv = output.read()
    if child.returncode == 0 and spirv:
        return spirv
    raise CompileError(_diagnostics(said.decode(errors="replace"), composed, name) or _crash(child.returncode, name))


def _limit(child: int, timeout_s: float) -> None:
    """Bound the child's memory, time and output. It waits for its input meanwhile, so the limits come in time."""
    seconds = int(timeout_s) + 1
    limits = {
        resource.RLIMIT_AS: _MEMORY_BYTES,
        resource.RLIMIT_CPU: seconds,
        resource.RLIMIT_FSIZE: _SPIRV_BYTES,
        resource.RLIMIT_CORE: 0,
    }
    for kind, wanted in limits.items():
        try:
            _, hard = resource.prlimit(child, kind)
            bound = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
            resource.prlimit(child, kind, (bound, bound))
        except ProcessLookupError:
            return


def _diagnostics(said: str, composed: Composed, name: str) -> list[Diagnostic]:
    found = []
    for line in said.splitlines():
        if match := _LOCATED.fullmatch(line):
            number = int(match[1]) if match[1].isdecimal() else 0
            file = composed.files[number - 1] if 0 < number <= len(composed.files) else name
            diagnostic = Diagnostic(file, int(match[2]), match[3].strip())
        elif match := _UNLOCATED.fullmatch(line):
            diagnostic = Diagnostic(name, 0, match[1].strip())
        else:
            continue
        if not _SUMMARY.match(diagnostic.message):
            found.append(diagnostic)
    # Where lines are at fault, the linker's complaints only follow from them.
    return ([d for d in found if d.line] or found)[:_MESSAGE_LIMIT]


def _crash(code: int, name: str) -> list[Diagnostic]:
    if code >= 0:
        return [Diagnostic(name, 0, f"the compiler ended with code {code} and no message")]
    how = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    return [Diagnostic(name, 0, f"the compiler died ({how}): the source is too deep or too large for it")]


def _failed(name: str, message: str) -> CompileError:
    return CompileError([Diagnostic(name, 0, message)])
