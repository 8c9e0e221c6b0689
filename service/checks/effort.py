"""How much the battery spends: the full one, and a quick one of lower power."""

from __future__ import annotations

from dataclasses import dataclass

FALSE_ALARM = 1e-5
"""Probability that chance alone fails one statistical check of a correct subject; three checks are statistical."""


@dataclass(frozen=True)
class Effort:
    """Sizes of the battery's parts.

    points: random inputs of the point checks. rows: parameter settings of the statistical checks; views: their angles
    in degrees. samples: directions drawn in each cell. depth: the directions of a cell are counted in 2^depth bins.
    quadrature: evaluations of the adaptive quadrature. tail_*: the search for large weights. energy_*: settings,
    refinements and quadrature of the search for the largest albedo.
    """

    points: int
    rows: int
    views: tuple[float, ...]
    samples: int
    depth: int
    quadrature: int
    tail_rows: int
    tail_views: tuple[float, ...]
    tail_particles: int
    tail_levels: int
    tail_moves: int
    energy_rows: int
    energy_rounds: int
    energy_quadrature: int


FULL = Effort(
    points=1 << 17,
    rows=8,
    views=(0.0, 30.0, 60.0, 80.0, 88.0),
    samples=1 << 17,
    depth=8,
    quadrature=12_000_000,
    tail_rows=6,
    tail_views=(0.3, 45.0, 75.0, 85.0),
    tail_particles=768,
    tail_levels=24,
    tail_moves=6,
    energy_rows=48,
    energy_rounds=3,
    energy_quadrature=6_000_000,
)
QUICK = Effort(
    points=1 << 14,
    rows=3,
    views=(20.0, 75.0),
    samples=1 << 15,
    depth=6,
    quadrature=2_000_000,
    tail_rows=3,
    tail_views=(20.0, 75.0),
    tail_particles=256,
    tail_levels=24,
    tail_moves=4,
    energy_rows=12,
    energy_rounds=1,
    energy_quadrature=600_000,
)
