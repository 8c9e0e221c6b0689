"""One file for each kind of result; adding a kind means adding `KIND.py` here.

Such a file has any of these functions, each of one argument, the result:

- `rows`: (names of the columns, iterable of rows) for CSV
- `arrays`: name -> NumPy array for NPZ
- `chart`: an Altair chart for Vega-Lite, PNG and SVG
- `text`: a string for the terminal
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import Any


def part(kind: str, name: str) -> Callable[[Any], Any] | None:
    """The function `name` of the file of `kind`, or None where there is no such file or function."""
    module = f"{__name__}.{kind}"
    if not kind.isidentifier() or find_spec(module) is None:
        return None
    found: Callable[[Any], Any] | None = getattr(import_module(module), name, None)
    return found
