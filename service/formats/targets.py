"""Where a result is to go: checked before anything is computed, so that a long run does not end in a typing error."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from service.errors import BadInput, Problem
from service.formats.encoding import FORMATS, UnknownFormat, format_of, formats_of

STDOUT = ("-", "/dev/stdout")
"""What means standard output in the place of a file's name."""


def require_format(name: str, kind: str) -> None:
    """Raise BadInput unless a format of this name exists and results of this kind have it."""
    if name not in formats_of(kind):
        raise BadInput(Problem("format", name, "one of " + ", ".join(formats_of(kind))))


def target(path: str, format_name: str | None, kind: str) -> tuple[str, str]:
    """The path and format of an output file for a result of this kind. BadInput where that has no such format, or the
    file cannot be written.
    """
    if format_name is None and path in STDOUT:
        format_name = "table"
    if format_name is None:
        try:
            format_name = format_of(path)
        except UnknownFormat:
            format_name = ""
        if format_name not in formats_of(kind):
            suffixes = [suffix for name in formats_of(kind) for suffix in FORMATS[name].suffixes]
            raise BadInput(Problem("output", path, ", ".join(suffixes)))
    require_format(format_name, kind)
    if path not in STDOUT:
        require_writable(Path(path))
    return path, format_name


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
