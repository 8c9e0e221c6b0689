"""Moments and supremum of the weight where half vectors have narrow lobes, by adaptive quadrature in their plane.

Near the rim, the horizon of wi, weight and density are powers of the distance to it. Those powers, measured there, say
whether the weight is bounded and which moments are infinite, and carry the integrals on to the rim itself.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from service.reference.entry import Array
from service.reference.half_vector_plane import legendre_rule
from service.reference.lobe_patches import (
    ORDER,
    Bools,
    Patches,
    coordinates,
    cut,
    first_patches,
    hidden_errors,
    integrals,
    promised_errors,
)
from service.reference.lobe_rays import OUTER_ENDS, Rays
from service.reference.moments import NEGLIGIBLE, Moments, Pair, tail_strength

GOALS = np.array([1e-11, 1e-10, 1e-9])
"""Share of the integrals behind mean, variance and fourth moment that a patch may be off by."""
ROUNDS = 40
MOST_PATCHES = 4000
SLOWEST = 1e-6  # a power of the distance to the rim this close to the edge of convergence counts as divergent
UNSEEN = 1e-64  # a tail that holds this share of the squared mean is not seen by any number of samples
LARGEST = 1e290  # float64 squares overflow not far above: moments and weights beyond it are called infinite
DEEP = 300.0  # zeta at which the last powers are read: mixtures change theirs where one density takes over from another
STARTS, NEAR_BEST, ZOOMS, GRID = 32, 0.8, 20, 9
BESIDE_ORIGIN = 1e-7  # zeta


@dataclass(frozen=True)
class Field:
    """A pair at nodes of patches, shapes (P, ORDER, ORDER). Reflected light and mass hold the node's solid angle."""

    reflected: Array  # f cos_i
    weight: Array
    mass: Array  # density

    @classmethod
    def at(cls, rays: Rays, zeta: Array, psi: Array, area: Array) -> "Field":
        """At coordinates of rays; `area` is that of a node in them."""
        wi, solid_angle = rays.at(zeta, psi)
        solid_angle = solid_angle * area * rays.plane.copies
        reflected, density = rays.pair.reflected(wi), rays.pair.density(wi)
        covered = density > 0.0
        weight = np.where(covered, reflected / np.where(covered, density, 1.0), 0.0)
        return cls(reflected * solid_angle, weight, density * solid_angle)

    def powers(self, centre: float) -> Array:
        """Integrands of mean, variance and fourth moment about `centre`, shape (3, ...)."""
        squared = (self.weight - centre) ** 2 * np.sqrt(self.mass)
        return np.stack([np.where(self.mass > 0.0, self.reflected, 0.0), squared * np.sqrt(self.mass), squared**2])

    def take(self, keep: Any) -> "Field":
        """A part of it, by mask or slices."""
        return Field(self.reflected[keep], self.weight[keep], self.mass[keep])


@dataclass(frozen=True)
class Rim:
    """How a pair behaves at the horizon: whether moments converge, (3,), what they hold beyond the last panel, (3,)."""

    converges: Bools
    beyond: Array
    bounded: bool


@dataclass
class LobeIntegrals:
    """The quadrature of one pair; `refine` does the work."""

    rays: Rays
    rim: Rim
    patches: list[Patches]
    fields: list[Field]
    finite: Bools
    error: float = 0.0

    @cached_property
    def _rule(self) -> Array:
        _, weights = legendre_rule(ORDER)
        return weights[:, None] * weights

    def total(self, name: str, where: str) -> float:
        """Sum of a part of the field over nodes that are drawn (`covered`), not drawn, or weigh nothing."""
        total = 0.0
        for field in self.fields:
            mask = {"covered": field.mass > 0.0, "uncovered": field.mass == 0.0, "weightless": field.reflected == 0.0}
            total += float(np.sum(np.where(mask[where], getattr(field, name), 0.0) * self._rule))
        return total

    def moments(self, centre: float) -> Array:
        """Integrals of `Field.powers`, shape (3,)."""
        inner = sum((integrals(field.powers(centre)).sum(axis=-1) for field in self.fields), np.zeros(3))
        return np.where(self.finite, inner + self.rim.beyond, np.inf)


def integrate_lobes(pair: Pair) -> tuple[Moments, float]:
    """Moments and supremum of the weight of a pair of which one part at least has half-vector lobes."""
    rays = Rays.of(pair)
    with np.errstate(all="ignore"):
        rim = rim_behaviour(rays)
        _, edge = tail_strength(pair)
        found = LobeIntegrals(rays, rim, [], [], rim.converges & np.array([True, not edge, not edge]))
        refine(found)
        mean = found.total("reflected", "covered") + float(rim.beyond[0])
        below = pair.technique.below_horizon(pair.wo, pair.parameters)
        variance, fourth = (float(value) for value in found.moments(mean)[1:] + below * np.array([mean**2, mean**4]))
        top = supremum(found) if rim.bounded and not edge else np.inf
    variance, fourth, top = (value if value < LARGEST else np.inf for value in (variance, fourth, top))
    uncovered = found.total("reflected", "uncovered")
    weightless = min(1.0, below + found.total("mass", "weightless"))
    return Moments(mean, variance, fourth if variance < np.inf else np.inf, uncovered, weightless, found.error), top


def rim_behaviour(rays: Rays) -> Rim:
    """Powers of the distance to the rim, from two places close to it on every ray."""
    psi, weights = rays.plane.turn_rule()
    end, fall_mass, fall_weight = _powers(rays, psi, 1.0 + OUTER_ENDS[-1])
    seen = (end.mass * end.weight**2 > UNSEEN) | (end.weight > UNSEEN)
    _, limit_mass, limit_weight = _powers(rays, psi, DEEP)
    converges, beyond = [True], []
    for power in (1, 2, 4):
        if power > 1:
            converges.append(not np.any(seen & (limit_mass + power * limit_weight <= SLOWEST)))
        fall = fall_mass + power * fall_weight
        held = end.mass * end.weight**power / fall
        beyond.append(float(np.sum(np.where((fall > SLOWEST) & np.isfinite(held), held, 0.0) * weights)))
    shares = np.array(beyond) / rays.plane.copies
    return Rim(np.array(converges), shares, not np.any(seen & (limit_weight < -SLOWEST)))


def _powers(rays: Rays, psi: Array, zeta: float) -> tuple[Field, Array, Array]:
    """The pair at one zeta, and the powers of the distance to the rim that mass and weight fall with there."""
    end, near = (Field.at(rays, np.full_like(psi, z), psi, np.ones_like(psi)) for z in (zeta, zeta - 10.0))
    return end, np.log(near.mass / end.mass) / 10.0, np.log(near.weight / end.weight) / 10.0


def refine(found: LobeIntegrals) -> None:
    """Cut patches until each keeps its goals, for all moments that are finite."""
    pending, count = first_patches(found.rays), 0
    off = np.zeros(3)
    for _ in range(ROUNDS):
        field, edges = _at_nodes(found.rays, pending)
        found.fields.append(field)
        centre = found.total("reflected", "covered")
        scale = np.maximum(found.moments(centre), (NEGLIGIBLE * centre * centre) ** np.array([0.5, 1.0, 2.0]))
        found.finite &= scale < LARGEST
        along_zeta, along_psi = promised_errors(field.powers(centre))
        along_psi += hidden_errors(field.powers(centre), edges.powers(centre))
        along_zeta[~found.finite] = along_psi[~found.finite] = 0.0
        limits = np.where(found.finite, GOALS * scale, np.inf)[:, None]
        cut_zeta, cut_psi = (np.asarray((errors > limits).any(axis=0)) for errors in (along_zeta, along_psi))
        fine = np.asarray(~(cut_zeta | cut_psi))
        count += len(fine)
        if count > MOST_PATCHES:
            fine[:] = True
        off += np.nansum(np.where(fine, along_zeta + along_psi, 0.0), axis=1)
        found.fields[-1] = field.take(fine)
        found.patches.append(pending.take(fine))
        pending = cut(pending, cut_zeta & ~fine, cut_psi & ~fine)
        if not len(pending):
            break
    found.error = float(np.max(np.where(found.finite, off / scale, 0.0)))


def _at_nodes(rays: Rays, patches: Patches) -> tuple[Field, Field]:
    """The pair at the nodes of patches, and at the two edges of psi, (P, ORDER, 2)."""
    nodes, _ = legendre_rule(ORDER)
    zeta, psi, area = coordinates(rays, patches, nodes[:, None], np.array([0.0, *nodes, 1.0]))
    field = Field.at(rays, zeta, psi, area)
    return field.take(np.s_[:, :, 1:-1]), field.take(np.s_[:, :, [0, -1]])


def supremum(found: LobeIntegrals) -> float:
    """Largest weight, by zooming into the best places of the best patches, of which the borders are a part."""
    patches = found.patches[0]
    for more in found.patches[1:]:
        patches = patches.join(more)
    line, reach = np.linspace(0.0, 1.0, GRID), 1.0 / (GRID - 1)
    v, u, best = _best(found.rays, patches, line[:, None], line)
    starts = np.argsort(best)[-STARTS:]
    starts = starts[best[starts] >= NEAR_BEST * best[starts[-1]]]
    patches, v, u = patches.take(starts), v[starts], u[starts]
    origin = Field.at(found.rays, np.zeros(1), found.rays.plane.turns[:1], np.ones(1))
    highest = max(float(np.max(best)), float(origin.weight[0]))
    for _ in range(ZOOMS):
        near_v = np.clip(v + reach * (2.0 * line[:, None] - 1.0), 0.0, 1.0)
        near_u = np.clip(u + reach * (2.0 * line[None, :] - 1.0), 0.0, 1.0)
        v, u, best = _best(found.rays, patches, near_v, near_u)
        highest, reach = max(highest, float(np.max(best))), 0.5 * reach
    return highest


def _best(rays: Rays, patches: Patches, v: Array, u: Array) -> tuple[Array, Array, Array]:
    """Place (P, 1, 1) and weight (P,) of the best point of a grid on every patch.

    Beside the origin, not at it, where all psi are one and nothing says which way the weight grows.
    """
    zeta, psi, area = coordinates(rays, patches, v, u)
    weight = Field.at(rays, np.maximum(zeta, BESIDE_ORIGIN), psi, area).weight.reshape(len(patches), -1)
    each, at = np.arange(len(patches)), np.argmax(weight, axis=1)
    row, column = np.divmod(at, GRID)
    best_v = np.broadcast_to(v, (len(patches), GRID, 1))[each, row, 0]
    best_u = np.broadcast_to(u, (len(patches), 1, GRID))[each, 0, column]
    return best_v[:, None, None], best_u[:, None, None], weight[each, at]
