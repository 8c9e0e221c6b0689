"""Brings the peers, on demand: a virtual environment and, for Dr.Jit, Debian's LLVM, unpacked beside it."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent / "peers"
OUT = Path(__file__).resolve().parents[2] / "out" / "bench"
PACKAGES = {"numpy": "numpy>=2.0,<3", "numba": "numba>=0.61,<1", "drjit": "drjit>=1.0,<2"}
LLVM = "libllvm19"


@dataclass(frozen=True)
class Peer:
    """A program that speaks the peers' protocol, or the reason why there is none."""

    name: str
    command: tuple[str, ...] = ()
    environment: tuple[tuple[str, str], ...] = ()
    missing: str = ""


def peers() -> list[Peer]:
    """Every peer, installed where that is possible."""
    OUT.mkdir(parents=True, exist_ok=True)
    return [*(_python(name) for name in PACKAGES), *(_cpp(bits) for bits in (256, 512))]


def _python(name: str) -> Peer:
    label = {"numpy": "NumPy", "numba": "Numba", "drjit": "Dr.Jit (LLVM)"}[name]
    python = OUT / "venv" / "bin" / "python"
    try:
        if not python.exists():
            _run(sys.executable, "-m", "venv", str(OUT / "venv"))
        _run(str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", PACKAGES[name])
        environment = (("DRJIT_LIBLLVM_PATH", _llvm()),) if name == "drjit" else ()
    except _NotInstalled as error:
        return Peer(label, missing=str(error))
    return Peer(label, (str(python), str(HERE / f"{name}_peer.py")), environment)


def _llvm() -> str:
    """Path of the LLVM library: the one that is named, or Debian's package, unpacked without installing it."""
    if named := os.environ.get("DRJIT_LIBLLVM_PATH"):
        return named
    folder = OUT / "llvm"
    if not list(folder.rglob("libLLVM.so.*")):
        folder.mkdir(exist_ok=True)
        _run("apt-get", "download", LLVM, cwd=folder)
        _run("dpkg", "-x", str(next(folder.glob("*.deb"))), str(folder))
    return str(next(folder.rglob("libLLVM.so.*")))


def _cpp(bits: int) -> Peer:
    label = f"C++ (g++, {bits} bit)"
    program = OUT / f"eon-{bits}"
    flags = ("-Ofast", "-march=native", "-fopenmp", "-std=c++17", f"-mprefer-vector-width={bits}")
    try:
        if bits == 512 and "avx512f" not in Path("/proc/cpuinfo").read_text():
            return Peer(label, missing="this processor has no AVX-512")
        _run("g++", *flags, "-o", str(program), str(HERE / "eon.cpp"))
    except (_NotInstalled, OSError) as error:
        return Peer(label, missing=str(error))
    # Its threads would otherwise spin into the time of the next program.
    return Peer(label, (str(program),), (("OMP_WAIT_POLICY", "passive"),))


class _NotInstalled(Exception):
    pass


def _run(*command: str, cwd: Path | None = None) -> None:
    try:
        subprocess.run(command, check=True, capture_output=True, text=True, cwd=cwd, timeout=900)
    except subprocess.CalledProcessError as error:
        last = (error.stderr or error.stdout or "").strip().splitlines()[-1:]
        raise _NotInstalled(f"{' '.join(command[:3])} failed: {' '.join(last)}") from None
    except (OSError, subprocess.TimeoutExpired) as error:
        raise _NotInstalled(f"{command[0]}: {error}") from None
