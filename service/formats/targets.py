"""Where a result is to go: checked before anything is computed, so that a long run does not end in a typing error."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from service.errors import BadInput, Problem
from service.formats.encoding import FORMATS, UnknownFormat, format_of


def require_format(name: str) -> None:
    """Raise BadInput unless a format of this name exists."""
    if name not in FORMATS:
        raise BadInput(Problem("format", name, "one of " + ", ".join(FORMATS)))


def target(path: str, format_name: str | None) -> tuple[Path, str]:
    """The path and format of an output file. BadInput where the format is unknown or the file cannot be written."""
    if format_name is None:
        try:
            format_name = format_of(path)
        except UnknownFormat as error:
            raise BadInput(Problem("output", path, str(error).rpartition("allowed: ")[2])) from None
    require_format(format_name)
    require_writable(Path(path))
    return Path(path), format_name


def require_writable(path: Path) -> None:
    """Raise BadInput unless a file can be made at this path; its missing folders are made."""
    try:
        if path.is_dir():
            raise IsADirectoryError(None, "is a folder")
        if path.exists() and not path.is_file():
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
        if path.exists() and not os.access(path, os.W_OK):
            raise PermissionError(None, "is not writable")
    except OSError as error:
        raise BadInput(Problem("output", str(path), f"a file that can be written ({error.strerror})")) from None
