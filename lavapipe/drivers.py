"""Which Vulkan driver the loader takes: lavapipe, unless the environment or the caller names another; and whether it
keeps what it compiles.
"""

from __future__ import annotations

import json
import os
import platform
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from lavapipe.errors import DeviceNotFound

# Loaders before 1.3.207 know only the second name, later ones prefer the first.
VARIABLES = ("VK_DRIVER_FILES", "VK_ICD_FILENAMES")
_NO_SHADER_CACHE = "MESA_SHADER_CACHE_DISABLE"
_lock = threading.RLock()


def chosen_variable() -> str | None:
    """The environment variable by which the user names drivers, or None."""
    return next((name for name in VARIABLES if os.environ.get(name)), None)


def check_choice() -> None:
    """Raise DeviceNotFound where the user's variable names no driver manifest at all."""
    variable = chosen_variable()
    if variable and not any(_is_manifest(Path(entry)) for entry in os.environ[variable].split(os.pathsep) if entry):
        raise DeviceNotFound(no_driver_in(variable))


def no_driver_in(variable: str) -> str:
    """What to say where this variable leads to no driver."""
    value = os.environ[variable]
    return f"{variable}={value} names no Vulkan driver that works here: unset it, or name a driver's .json file"


def lavapipe_manifest() -> Path | None:
    """The .json file of the installed lavapipe, this machine's architecture first, or None."""
    roots = os.environ.get("XDG_DATA_DIRS") or "/usr/local/share:/usr/share"
    folders = [Path(root) / "vulkan" / "icd.d" for root in ["/etc", *roots.split(os.pathsep)] if root]
    found = [path for folder in folders for path in sorted(folder.glob("lvp_icd*.json"))]
    found.sort(key=lambda path: platform.machine() not in path.name)
    return found[0] if found else None


@contextmanager
def pinned_to_lavapipe() -> Iterator[None]:
    """Let the loader see lavapipe only, while an instance is made; a choice of the user is left as it is.

    The loader reads the environment when an instance is made and not later, so the variables go away again.
    """
    manifest = None if chosen_variable() else lavapipe_manifest()
    with _environment(dict.fromkeys(VARIABLES, str(manifest)) if manifest else {}):
        yield


@contextmanager
def without_shader_cache() -> Iterator[None]:
    """Let Mesa's drivers compile every shader anew, on a device that is made meanwhile: they look at its start."""
    with _environment({_NO_SHADER_CACHE: "true"}):
        yield


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Set environment variables for a while; one thread at a time."""
    with _lock:
        before = {name: os.environ.get(name) for name in values}
        os.environ.update(values)
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value


def _is_manifest(path: Path) -> bool:
    if path.is_dir():
        return any(_is_manifest(entry) for entry in path.glob("*.json"))
    try:
        return "library_path" in json.loads(path.read_bytes())["ICD"]
    except (OSError, ValueError, KeyError, TypeError):
        return False
