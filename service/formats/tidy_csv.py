"""CSV in which every float reads back bit for bit: shortest round-trip decimals, a null is an empty field."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from typing import Any


def encode(table: tuple[list[str], Iterable[list[Any]]]) -> bytes:
    """(columns, rows) as CSV in UTF-8 with one header line; raises ValueError for a number not finite."""
    columns, rows = table
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow([_field(value, column) for column, value in zip(columns, row, strict=True)])
    return text.getvalue().encode()


def _field(value: Any, column: str) -> str:
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"a result may not hold a number that is not finite, but a {column} is {value}")
        return float.__repr__(value)
    return "" if value is None else str(value)
