"""The formats a result can be written in, and the one function that writes them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from service.errors import SamplerscopeError
from service.formats import kinds

if TYPE_CHECKING:
    from service.figures import AnyChart

Result = Mapping[str, Any]
Draw = Callable[[Result], "AnyChart"]


class UnknownFormat(SamplerscopeError, ValueError):
    """A format, or a suffix of a file name, that a result cannot be written in."""


@dataclass(frozen=True)
class Format:
    """One representation of a result.

    `suffixes` are the file name endings that mean it, lower case, the preferred one first. `binary` says that the
    bytes are not UTF-8 text. `part` is the function of a kind's module that the format is made from; None means that
    every kind has the format.
    """

    name: str
    media_type: str
    suffixes: tuple[str, ...]
    binary: bool
    part: str | None


_ALL = (
    Format("json", "application/json", (".json",), False, None),
    Format("csv", "text/csv", (".csv",), False, "rows"),
    Format("npz", "application/x-npz", (".npz",), True, "arrays"),
    Format("vega", "application/vnd.vegalite.v6+json", (".vl.json", ".vega.json"), False, "chart"),
    Format("png", "image/png", (".png",), True, "chart"),
    Format("svg", "image/svg+xml", (".svg",), False, "chart"),
    Format("table", "text/plain", (".txt",), False, "text"),
)

FORMATS: Mapping[str, Format] = MappingProxyType({entry.name: entry for entry in _ALL})


def format_of(path: str | os.PathLike[str]) -> str:
    """The name of the format that the file name of `path` ends in; the longest suffix wins.

    Raises UnknownFormat where no format has that suffix.
    """
    name = os.path.basename(os.fspath(path)).lower()
    suffixes = {suffix: entry.name for entry in _ALL for suffix in entry.suffixes}
    for suffix in sorted(suffixes, key=len, reverse=True):
        if name.endswith(suffix):
            return suffixes[suffix]
    raise UnknownFormat(
        f"no format is known by the name of the file {os.fspath(path)!r}; allowed: {', '.join(suffixes)}"
    )


def encode(result: Result, format: str, chart: Draw | None = None) -> bytes:  # noqa: A002 (the word of the CLI and the API)
    """`result` as bytes in `format`, one of FORMATS.

    `chart` draws the picture for vega, png and svg; without it the chart of the result's kind is drawn.
    Raises UnknownFormat where the format does not exist or the result's kind does not have it, and ValueError where
    the result holds a number that is not finite.
    """
    if format not in FORMATS:
        raise UnknownFormat(f"there is no format {format!r}; allowed: {', '.join(FORMATS)}")
    entry = FORMATS[format]
    if entry.part is None:
        from service.formats import strict_json

        return strict_json.encode(result)
    if entry.part == "chart":
        from service.formats import pictures

        return pictures.encode((chart or _part(result, entry))(result), format)
    content = _part(result, entry)(result)
    if entry.part == "rows":
        from service.formats import tidy_csv

        return tidy_csv.encode(content)
    if entry.part == "arrays":
        from service.formats import npz

        return npz.encode(content)
    return str(content).encode()


def formats_of(kind: str) -> list[str]:
    """Names of the formats that a result of this kind can be written in, JSON first."""
    return [entry.name for entry in _ALL if entry.part is None or kinds.part(kind, entry.part) is not None]


def _part(result: Result, entry: Format) -> Callable[[Result], Any]:
    kind = str(result.get("kind"))
    part = kinds.part(kind, entry.part or "")
    if part is None:
        allowed = ", ".join(formats_of(kind))
        raise UnknownFormat(f"a result of kind {kind!r} has no format {entry.name!r}; allowed: {allowed}")
    return part
