"""How wide lavapipe's vectors are: as wide as the processor's, which the driver does not choose by itself.

Lavapipe takes 256 bits where the processor has AVX, also where it has AVX-512; the wider vectors draw samples 1.2 to
1.6 times as fast and give the same bits (docs/performance.md). The driver's cache of compiled shaders does not tell
widths apart: what was compiled for 256 bits would go on being used. So the wide code has a cache folder of its own.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_WIDTH = "LP_NATIVE_VECTOR_WIDTH"
_CACHE = "MESA_SHADER_CACHE_DIR"
_CPU = Path("/proc/cpuinfo")
_NEEDED = {"avx512f", "avx512bw", "avx512dq", "avx512vl"}  # what LLVM's code for 512 bits is built of


@contextmanager
def widest(cpu: Path = _CPU) -> Iterator[None]:
    """What the driver starts in here has 512-bit vectors where the processor has AVX-512; a width that is set stays."""
    if _WIDTH in os.environ or not _has_avx512(cpu):
        yield
        return
    before = os.environ.get(_CACHE)
    os.environ[_WIDTH] = "512"
    if folder := _cache_folder():
        wide = folder / "512-bit"
        with suppress(OSError):  # then the driver says that it goes without; by itself it makes one level, not two
            wide.mkdir(parents=True, exist_ok=True)
        os.environ[_CACHE] = str(wide)
    try:
        yield
    finally:
        del os.environ[_WIDTH]
        os.environ.pop(_CACHE, None)
        if before is not None:
            os.environ[_CACHE] = before


def _has_avx512(cpu: Path) -> bool:
    try:
        lines = cpu.read_text().splitlines()
    except OSError:
        return False
    flags = next((line.partition(":")[2].split() for line in lines if line.startswith("flags")), [])
    return set(flags) >= _NEEDED


def _cache_folder() -> Path | None:
    """Where the driver keeps compiled shaders; None where it would keep none."""
    if named := os.environ.get(_CACHE):
        return Path(named)
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mesa_shader_cache"
    except RuntimeError:
        return None
