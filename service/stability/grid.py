"""The edge grid: inputs at the ends of their ranges, next to them, and where formulas are known to break."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.catalogue import Parameter

Array = NDArray[Any]
STEP = 2.0**-24

EDGE_COSINES = (1.0, 1 - STEP, 0.5, 1e-2, 1e-4, 1e-6, 1e-7, 2.0**-126, 0.0)
EDGE_NUMBERS = (0.0, STEP, 2 * STEP, 0.5, 1 - 2 * STEP, 1 - STEP)
NEXT_TO_SEAMS = (2.0**-23, 0.25 - 2.0**-25, 1 - 2.0**-23)
EDGE_TURNS = tuple(sorted((0.0, 0.125, 0.25, 0.5, 0.61, 0.75, *NEXT_TO_SEAMS)))
"""Azimuths of the view in turns: quarters, next to them, and on both sides of the seam."""

_NEAR_ZERO = (1e-38, 1e-30, 1e-12, 1e-7, 1e-6, 1e-3)


def edge_values(p: Parameter, beyond: bool) -> list[float]:
    """Values of a parameter: its ends and default, next to the ends, the middle, and one step beyond where asked."""
    low, high = np.float32(p.min), np.float32(p.max)
    values = [float(low), float(high), p.default, 0.5 * (p.min + p.max), float(np.nextafter(high, low))]
    if p.min == 0.0:
        values += [share * min(1.0, p.max) for share in _NEAR_ZERO]
    else:
        values.append(float(np.nextafter(low, high)))
    if beyond:
        values += [float(np.nextafter(low, np.float32(-np.inf))), float(np.nextafter(high, np.float32(np.inf)))]
    return list(dict.fromkeys(float(np.float32(value)) for value in values))


def edge_settings(declared: Mapping[str, Parameter], limit: int, beyond: bool) -> Array:
    """Rows of edge values (n, p) in float32: the whole product where it fits in `limit`, else a spread selection of it.

    A selection holds every value of every parameter at least once, with the defaults and with all minima of the others.
    """
    columns = [edge_values(p, beyond) for p in declared.values()]
    total = int(np.prod([float(len(column)) for column in columns])) if columns else 1
    if total <= limit:
        rows = list(itertools.product(*columns))
    else:
        low = [p.min for p in declared.values()]
        default = [p.default for p in declared.values()]
        rows = [tuple(default), tuple(low), tuple(p.max for p in declared.values())]
        for i, column in enumerate(columns):
            rows += [(*base[:i], value, *base[i + 1 :]) for value in column for base in (default, low)]
        rng = np.random.default_rng(0)
        while len(dict.fromkeys(rows)) < limit:
            rows.append(tuple(column[rng.integers(len(column))] for column in columns))
    unique = list(dict.fromkeys(rows))
    return np.array(unique, np.float32).reshape(len(unique), len(columns))
