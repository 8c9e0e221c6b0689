"""Writing a result to a file: whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
from pathlib import Path

from service.formats.encoding import Draw, Result, encode, format_of


def write(
    result: Result,
    path: str | os.PathLike[str],
    format: str | None = None,  # noqa: A002 (the word of the CLI and the API)
    chart: Draw | None = None,
) -> None:
    """Write `result` to `path` in `format`, by default the one its suffix names; missing folders are made.

    Raises as `format_of` and `encode` do, and OSError where the file cannot be written; the file is then as before.
    """
    write_bytes(path, encode(result, format or format_of(path), chart))


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write `content` to `path`, replacing a file in one step; missing folders are made; raises OSError."""
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        # A device or a pipe (/dev/stdout) is written to, never replaced; a folder raises here.
        target.write_bytes(content)
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{target.name[:64]}.{secrets.token_hex(6)}")
    try:
        with part.open("xb") as out:
            out.write(content)
        part.replace(target)
    except OSError as error:
        raise OSError(error.errno, error.strerror, os.fspath(path)) from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
