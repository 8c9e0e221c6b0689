"""Patches of rays in the half-vector plane, what integrands on them promise, and cutting them."""

from dataclasses import dataclass, fields
from functools import cache

import numpy as np
from numpy.typing import NDArray

from service.reference.entry import Array
from service.reference.half_vector_plane import legendre_rule
from service.reference.lobe_rays import Rays

ORDER = 12  # nodes a side of a patch

Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Patches:
    """A panel between kinks, the part of it from `low` to `high`, and a range of psi; each of shape (P,)."""

    panel: NDArray[np.intp]
    low: Array
    high: Array
    start: Array
    stop: Array

    def __len__(self) -> int:
        return len(self.panel)

    def take(self, keep: Bools | NDArray[np.intp]) -> "Patches":
        """Those of a mask or of indices."""
        return Patches(*(getattr(self, field.name)[keep] for field in fields(self)))

    def join(self, other: "Patches") -> "Patches":
        """These and others."""
        return Patches(*(np.append(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)))

    def halved(self, along_psi: bool) -> "Patches":
        """Each cut in two."""
        if along_psi:
            middle = 0.5 * (self.start + self.stop)
            first = Patches(self.panel, self.low, self.high, self.start, middle)
            return first.join(Patches(self.panel, self.low, self.high, middle, self.stop))
        middle = 0.5 * (self.low + self.high)
        first = Patches(self.panel, self.low, middle, self.start, self.stop)
        return first.join(Patches(self.panel, middle, self.high, self.start, self.stop))


def first_patches(rays: Rays) -> Patches:
    """Every panel of every turn of the plane, whole."""
    turns = rays.plane.turns
    panels = rays.ends(turns[:1]).shape[-1] - 1
    panel, turn = (index.ravel() for index in np.indices((panels, len(turns) - 1)))
    zero = np.zeros(len(panel))
    return Patches(panel, zero, zero + 1.0, turns[turn], turns[turn + 1])


def coordinates(rays: Rays, patches: Patches, v: Array, u: Array) -> tuple[Array, Array, Array]:
    """Zeta (P, m, n), psi (P, 1, n) and the area per unit of (v, u), for v (., m, 1) and u (., 1, n) in [0, 1]."""
    panel, low, high, start, stop = (getattr(patches, field.name)[:, None, None] for field in fields(patches))
    psi = start + (stop - start) * u
    if rays.has_kinks:
        ends = _ends(rays, patches, psi)
        begin = np.take_along_axis(ends, panel[..., None], axis=-1)[..., 0]
        width = np.take_along_axis(ends, panel[..., None] + 1, axis=-1)[..., 0] - begin
    else:
        begin = rays.fixed_ends[panel]
        width = rays.fixed_ends[panel + 1] - begin
    return begin + width * (low + (high - low) * v), psi, width * (high - low) * (stop - start)


def _ends(rays: Rays, patches: Patches, psi: Array) -> Array:
    """Panel ends at the angles of every patch, found once for patches of the same range."""
    keys = np.stack([patches.start, patches.stop], axis=1)
    _, first, same = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return rays.ends(psi[first])[same.ravel()]


def integrals(values: Array) -> Array:
    """Integrals (K, P) of what has the values (K, P, ORDER, ORDER) at the nodes."""
    _, weights = legendre_rule(ORDER)
    return np.asarray(values @ weights @ weights)


def promised_errors(values: Array) -> tuple[Array, Array]:
    """Errors of the integrals to expect, each (K, P), from how Legendre coefficients fall along zeta and along psi.

    The rule integrates twice the degree of the last coefficient, so an error is as far below the last ones as those are
    below the middle ones.
    """
    to_legendre = _to_legendre()
    coefficients = np.abs(to_legendre @ values @ to_legendre.T)
    return _fall(coefficients.max(axis=-1)), _fall(coefficients.max(axis=-2))


def hidden_errors(values: Array, at_edges: Array) -> Array:
    """Errors (K, P) from kinks between the first or last angle of a patch and its edge, which coefficients miss.

    `at_edges` (K, P, ORDER, 2) is compared with what the nodes' values (K, P, ORDER, ORDER) continue to there.
    """
    nodes, weights = legendre_rule(ORDER)
    continued = values @ _to_legendre().T @ np.stack([(-1.0) ** np.arange(ORDER), np.ones(ORDER)], axis=1)
    return np.asarray(nodes[0] * (np.abs(at_edges - continued).sum(axis=-1) @ weights))


def _fall(coefficients: Array) -> Array:
    middle = coefficients[..., ORDER // 2 - 2 : ORDER // 2].max(axis=-1)
    last = coefficients[..., -2:].max(axis=-1)
    return np.asarray(last * np.minimum(last / np.maximum(middle, 1e-300), 1.0) ** 2)


@cache
def _to_legendre() -> Array:
    """The matrix from values at the nodes to Legendre coefficients."""
    nodes, weights = legendre_rule(ORDER)
    basis = np.polynomial.legendre.legvander(2.0 * nodes - 1.0, ORDER - 1)
    return np.asarray((2.0 * np.arange(ORDER) + 1.0)[:, None] * basis.T * weights)


def cut(patches: Patches, along_zeta: Bools, along_psi: Bools) -> Patches:
    """The patches of either mask, cut in two, or in four where both hold."""
    once = patches.take(along_zeta & ~along_psi).halved(False).join(patches.take(along_psi & ~along_zeta).halved(True))
    return once.join(patches.take(along_zeta & along_psi).halved(False).halved(True))
