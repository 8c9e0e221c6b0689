"""Writing a report card in the form that its file name asks for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from service.errors import BadInput, Problem
from service.formats import strict_json, write_bytes
from service.formats.targets import require_writable

SUFFIXES = (".html", ".json", ".md")


def require_report(path: str) -> None:
    """Raise BadInput unless a report can be written there."""
    if Path(path).suffix.lower() not in SUFFIXES:
        raise BadInput(Problem("report", path, "a file name that ends in " + ", ".join(SUFFIXES)))
    require_writable(Path(path))


def write_report(result: Mapping[str, Any], path: str) -> None:
    """Write the card of a result of kind `check` or `stability`, whole or not at all."""
    suffix = Path(path).suffix.lower()
    if suffix == ".json":
        write_bytes(path, strict_json.encode(result))
        return
    from service.reports import html, markdown

    write_bytes(path, (html if suffix == ".html" else markdown).render(result).encode())
