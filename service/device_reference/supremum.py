"""The supremum of the weight, by zooming into the highest panels of the quadrature in double precision.

The same search as the reference in Python does on its patches (`service.reference.supremum`), but where the weight is
smooth is unknown, so it zooms to the end of double precision. Steps that shrink mean a bound; steps that do not, none.
"""

from __future__ import annotations

import numpy as np

from service.device_reference.drawn import u_of
from service.estimators.cubature import Integrals
from service.estimators.panels import Array, Integers
from service.probe import Probe
from service.sampling import Cells

GRID = 9
STARTS = 8
ZOOMS = 26
"""The window falls to a quarter each time, to 2^-52 of a panel."""

LATE = 12
"""The last zooms, whose steps tell growth from convergence."""

LAST = 1.0 - 2.0**-53
SETTLED = 1e-6
"""Share of the largest weight that the last steps may still add."""


def suprema(probe: Probe, cells: Cells, seen: Integrals, splits: Array) -> Array:
    """Largest weight that each cell can reach or come near to: inf where it has no bound, NaN where that is open."""
    cell, part, centre, reach = _starts(seen, len(cells))
    line = np.linspace(-1.0, 1.0, GRID)
    grid = np.stack([np.repeat(line, GRID), np.tile(line, GRID)], axis=1)
    rows = np.arange(len(cell))
    history = []
    highest = np.full(len(cell), -np.inf)
    for _ in range(ZOOMS):
        square = np.clip(centre[:, None] + reach[:, None] * grid, 0.0, LAST)
        weight = _weights(probe, cells, cell, u_of(part[:, None], square, splits[cell, None]))
        best = np.argmax(weight, axis=1)
        better = weight[rows, best] > highest
        highest = np.where(better, weight[rows, best], highest)
        centre = np.where(better[:, None], square[rows, best], centre)
        history.append(np.maximum.reduceat(highest, np.searchsorted(cell, np.arange(len(cells)))))
        reach = 0.25 * reach
    return _limits(np.stack(history))


def _starts(seen: Integrals, cells: int) -> tuple[Integers, Integers, Array, Array]:
    """The highest panels of every cell, sorted by cell: cell, part, middle (n, 2) and half widths (n, 2)."""
    panels, highest = seen.panels, seen.highest
    order = np.lexsort((-highest, panels.cell))
    rank = np.arange(len(order)) - np.searchsorted(panels.cell[order], np.arange(cells))[panels.cell[order]]
    chosen = panels.pick(order[rank < STARTS])
    half = 0.5 * chosen.corner[:, 2:]
    # The neighbours belong to the window: the highest node may be the next panel's foot.
    return chosen.cell, chosen.part, chosen.corner[:, :2] + half, 2.0 * half


def _weights(probe: Probe, cells: Cells, cell: Integers, u: Array) -> Array:
    count = u.shape[1]
    wo, parameters = (np.repeat(a[cell], count, axis=0) for a in (cells.wo, cells.parameters))
    found = probe.draw(wo, np.minimum(u, LAST).reshape(-1, 2), parameters, "double").weight.reshape(-1, count)
    return np.where(np.isnan(found), -np.inf, found)


def _limits(history: Array) -> Array:
    last = history[-1]
    with np.errstate(invalid="ignore", divide="ignore"):
        steps = np.diff(history[-LATE - 1 :], axis=0)
        early, late = steps[: LATE // 2].sum(axis=0), steps[LATE // 2 :].sum(axis=0)
        settled = late <= SETTLED * np.abs(last)
        growing = ~np.isfinite(last) | (~settled & (late > 0.5 * early))
    return np.where(growing, np.inf, np.where(settled, last, np.nan))
