"""JSON that is strict (no NaN, no Infinity) and readable: one line for each array of numbers and each short object.

Keys keep the order of the result, which is the contract's; equal results give equal bytes.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from typing import Any

_LONGEST = 240
"""An object of plain values stands on one line up to this length."""

_CONTAINERS = frozenset((dict, list, tuple))
_encoder = json.JSONEncoder(allow_nan=False, ensure_ascii=False)


def encode(value: Any) -> bytes:
    """Return `value` as indented JSON in UTF-8 with a final newline.

    Raises ValueError naming the place of the first number that is not finite, and TypeError for what JSON lacks.
    """
    try:
        return (_block(value, "") + "\n").encode()
    except ValueError:
        place = _not_finite(value, "")
        raise ValueError(f"a result may not hold a number that is not finite, but {place}") from None


def line(value: Any) -> str:
    """Return `value` as JSON on one line; raises as `encode` does, without the place."""
    return _encoder.encode(value)


def _block(value: Any, indent: str) -> str:
    if type(value) not in _CONTAINERS:
        return line(value)
    deeper = indent + "  "
    if isinstance(value, dict):
        for key in value:
            _check_key(key)
        if _flat(value.values()) and len(text := line(value)) <= _LONGEST:
            return text
        entries = [f"{deeper}{line(key)}: {_block(item, deeper)}" for key, item in value.items()]
        return "{\n" + ",\n".join(entries) + f"\n{indent}}}"
    if _flat(value):
        return line(value)
    return "[\n" + ",\n".join([deeper + _block(item, deeper) for item in value]) + f"\n{indent}]"


def _flat(items: Iterable[Any]) -> bool:
    return _CONTAINERS.isdisjoint(map(type, items))


def _check_key(key: Any) -> None:
    if not isinstance(key, str):
        raise TypeError(f"keys of a result are strings, not {type(key).__name__}")


def _not_finite(value: Any, place: str) -> str:
    if isinstance(value, dict):
        found = (_not_finite(item, f"{place}.{key}" if place else str(key)) for key, item in value.items())
    elif isinstance(value, list | tuple):
        found = (_not_finite(item, f"{place}[{index}]") for index, item in enumerate(value))
    else:
        bad = isinstance(value, float) and not math.isfinite(value)
        return f"{place or 'it'} is {value}" if bad else ""
    return next((text for text in found if text), "")
