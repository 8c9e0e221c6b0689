"""Numbers as plain data for JSON, which has no NaN and no infinities: None stands in their place."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


def finite_or_none(values: Iterable[Any]) -> list[float | None]:
    """The numbers as a list of floats; what is not finite becomes None."""
    return [float(value) if math.isfinite(value) else None for value in values]


def plain_data(value: Any) -> Any:
    """Mappings, sequences, NumPy arrays and numbers as dicts, lists and Python's own numbers, to any depth."""
    if isinstance(value, Mapping):
        return {str(key): plain_data(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain_data(value.tolist())
    if isinstance(value, list | tuple):
        return [plain_data(item) for item in value]
    if isinstance(value, np.generic):
        return plain_data(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
