"""Results to files and stdout, progress to stderr."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from service.cli import EXIT_FAILED
from service.errors import BadInput, Problem

if TYPE_CHECKING:
    from service.formats.encoding import Draw
    from service.statistics import Progress


NARROWEST = 60
"""Columns that a table takes at least, whatever the terminal."""

MANY_SAMPLES = 10_000_000
"""From here on the line of progress counts them."""


class ProgressLine:
    """Progress on stderr: a line that is rewritten on a terminal, else one line for each technique."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._last = ""

    def __enter__(self) -> Progress:
        return self._advance

    def _advance(self, name: str, done: int, total: int) -> None:
        if self._terminal:
            counts = f"{done / 1e6:.0f} of {total / 1e6:.0f} million samples  " if total >= MANY_SAMPLES else ""
            line = f"{done / total:4.0%}  {counts}{name}"
            click.echo(f"\r{line:<{len(self._last)}}", nl=False, err=True)
            self._last = line
        elif name != self._last:
            click.echo(f"{done / total:4.0%}  {name}", err=True)
            self._last = name

    def __exit__(self, *_: object) -> None:
        if self._terminal and self._last:
            click.echo(f"\r{'':<{len(self._last)}}\r", nl=False, err=True)


class StageLine(ProgressLine):
    """Progress in stages: what is being done, rewritten on a terminal, else a line a stage."""

    def _advance(self, name: str, done: int, total: int) -> None:
        if self._terminal:
            click.echo(f"\r{name:<{len(self._last)}}", nl=False, err=True)
        elif name != self._last:
            click.echo(name, err=True)
        self._last = name


def deliver(
    kind: str,
    compute: Callable[[], dict[str, Any]],
    format_: str | None,
    outputs: tuple[str, ...],
    draw: Draw | None = None,
) -> dict[str, Any]:
    """Write a result of this kind to the files asked for, else to stdout. Formats and paths are checked before anything
    is computed.

    With files in the formats of their suffixes, the table still goes to stdout. `draw` makes the chart for pictures, by
    default that of the result's kind.
    """
    from service import formats
    from service.formats.targets import STDOUT, require_format, target

    require_format(format_ or "table", kind)
    targets = [target(path, format_, kind) for path in outputs]
    if format_ and not targets and formats.FORMATS[format_].binary and sys.stdout.isatty():
        raise BadInput(Problem("output", None, f"-o FILE, or a pipe: {format_} is not for a terminal"))
    result = compute()
    for path, name in targets:
        if path not in STDOUT:
            formats.write(result, path, name, draw)
    if format_ is None or not targets or any(path in STDOUT for path, _ in targets):
        shown = _fitted(kind, result) if (format_ or "table") == "table" else None
        sys.stdout.buffer.write(shown or formats.encode(result, format_ or "table", draw))
        sys.stdout.buffer.flush()
    return result


def _fitted(kind: str, result: dict[str, Any]) -> bytes | None:
    """The table of statistics for a terminal that is narrower than the table otherwise is; else None."""
    width = shutil.get_terminal_size().columns
    if kind != "statistics" or not sys.stdout.isatty():
        return None
    from service.formats.table import WIDTH, statistics_table

    return statistics_table(result, max(width, NARROWEST)).encode() if width < WIDTH else None


def deliver_with_reports(
    kind: str,
    compute: Callable[[], dict[str, Any]],
    reports: tuple[str, ...],
    format_: str | None,
    outputs: tuple[str, ...],
) -> None:
    """As `deliver`, with report cards beside the result; ends the process with EXIT_FAILED where a check failed."""
    from service.reports import require_report, write_report

    for path in reports:
        require_report(path)

    def compute_and_report() -> dict[str, Any]:
        result = compute()
        for path in reports:
            write_report(result, path)
        return result

    if deliver(kind, compute_and_report, format_, outputs)["status"] == "fail":
        sys.exit(EXIT_FAILED)
