"""What a shader comes to once it is specialized: its dead code removed by spirv-opt, for reports.

The driver does the same by itself and shows nothing of it, so nothing that runs goes through here.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
from collections.abc import Mapping

from lavapipe.cache import Cache, default_cache

_COMMAND = "spirv-opt"
_TIMEOUT_S = 30.0


def specialized(
    spirv: bytes, specialization: Mapping[int, int | float | bool], cache: Cache | None = None
) -> bytes | None:
    """The module with its specialization constants set to these values, folded, and dead code removed.

    None where spirv-opt is not installed or cannot do it. The result is kept in `cache`, by default the user's.
    """
    values = " ".join(f"{number}:{_literal(value)}" for number, value in sorted(specialization.items()))
    cache = default_cache() if cache is None else cache
    key = "specialized-2-" + hashlib.sha256(values.encode() + b"\0" + spirv).hexdigest()
    known = cache.get(key)
    if known is not None:
        return known
    found = shutil.which(_COMMAND)
    made = _run(found, values, spirv) if found else None
    if made is not None:
        cache.put(key, made)
    return made


def _literal(value: int | float | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


def _run(command: str, values: str, spirv: bytes) -> bytes | None:
    setting = [f"--set-spec-const-default-value={values}"] if values else []
    with open(os.memfd_create("given"), "wb") as given, open(os.memfd_create("made"), "rb") as made:
        given.write(spirv)
        given.flush()
        paths = [f"/proc/self/fd/{file.fileno()}" for file in (given, made)]
        try:
            done = subprocess.run(
                [
                    command,
                    *setting,
                    "--freeze-spec-const",
                    "--fold-spec-const-op-composite",
                    "-O",
                    paths[0],
                    "-o",
                    paths[1],
                ],
                pass_fds=[given.fileno(), made.fileno()],
                capture_output=True,
                timeout=_TIMEOUT_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None
        return made.read() or None if done.returncode == 0 else None
