"""Supremum of the throughput weight over the hemisphere, by zooming into the best places of every patch.

Within a patch the weight is smooth, so the search only has to look at a grid that includes the borders: kinks, the
plane of wo and the horizon all lie on borders. The horizon itself is 0/0 for most densities; its limit is taken at an
elevation too small to differ from it.
"""

import numpy as np

from service.reference.entry import Array
from service.reference.moments import Pair
from service.reference.partition import Partition

GRID = 9  # points a side of a patch, and of each window
STARTS = 6  # patches that are searched further
ZOOMS = 9  # the spacing falls by 4 each time, to 5e-7; at a smooth maximum that leaves 1e-13 of its value


def supremum(pair: Pair) -> float:
    """Largest weight that the pair can reach or come near to; only for a density without uncovered directions."""
    partition = pair.partition()
    line = np.linspace(0.0, 1.0, GRID)
    centre_t, centre_u, best = _best(pair, partition, line[:, None], line[None, :])
    starts = np.argsort(best[:, 0, 0])[-STARTS:]
    partition, centre_t, centre_u = partition.select(starts), centre_t[starts], centre_u[starts]
    highest, reach = float(np.max(best)), 1.0 / (GRID - 1)
    for _ in range(ZOOMS):
        t = np.clip(centre_t + reach * (2.0 * line[:, None] - 1.0), 0.0, 1.0)
        u = np.clip(centre_u + reach * (2.0 * line[None, :] - 1.0), 0.0, 1.0)
        centre_t, centre_u, best = _best(pair, partition, t, u)
        highest, reach = max(highest, float(np.max(best))), 2.0 * reach / (GRID - 1)
    return highest


def _best(pair: Pair, partition: Partition, t: Array, u: Array) -> tuple[Array, Array, Array]:
    """Coordinates and weight, each (P, 1, 1), of the best point of every patch's grid."""
    elevation, azimuth, _ = partition.angles(t, u)
    lowest = max(1e-18 * partition.lowest_panel, 1e-150)
    weight = pair.weight(pair.directions(np.maximum(elevation, lowest), azimuth))
    row, column = np.divmod(np.argmax(weight.reshape(len(weight), -1), axis=1), GRID)
    patch = np.arange(len(weight))
    t, u = np.broadcast_to(t, (len(weight), GRID, 1)), np.broadcast_to(u, (len(weight), 1, GRID))
    column_shape = (-1, 1, 1)
    return (
        t[patch, row, 0].reshape(column_shape),
        u[patch, 0, column].reshape(column_shape),
        weight[patch, row, column].reshape(column_shape),
    )
