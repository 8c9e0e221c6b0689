"""Moments of the throughput weight by tensor Gauss-Legendre quadrature on the patches of the hemisphere."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from service.reference.entry import Array, Edge, Model, Parameters, Technique
from service.reference.partition import Partition, partition_hemisphere

COARSE, FINE = 12, 18  # nodes a side of a patch
GOAL = 1e-10  # difference of the two rules at which refining stops
MOST_PIECES = 8  # a patch is cut into this many pieces a side at the most
ROUNDING = 1e-14  # of a weight, with room for the sums
NEGLIGIBLE = 1e-18  # of the squared mean: a variance below it is made of rounded weights; its error is then absolute


@dataclass(frozen=True)
class Pair:
    """One model and one technique with their parameters, seen from one view direction `wo`, shape (3,)."""

    model: Model
    technique: Technique
    parameters: Parameters
    wo: Array

    @property
    def edge(self) -> Edge | None:
        """Edge of the density inside the hemisphere."""
        return self.technique.kinks(self.wo, self.parameters).edge

    def partition(self) -> Partition:
        """Patches on which BRDF and density are smooth."""
        kinks = [part.kinks(self.wo, self.parameters) for part in (self.model, self.technique)]
        return partition_hemisphere(kinks, self._smoothing())

    def _smoothing(self) -> float:
        edge = self.edge
        if edge is None:
            return 0.0
        steepest = float(np.max(edge.slope(edge_points(edge, np.linspace(0.0, 0.5 * np.pi, 9)))))
        return edge.floor / steepest

    def directions(self, elevation: Array, azimuth: Array) -> Array:
        """Unit vectors of shape (..., 3); the azimuth counts from wo. z keeps its relative accuracy at the horizon."""
        turned = azimuth + np.arctan2(self.wo[1], self.wo[0])
        up = np.cos(elevation)
        z = np.broadcast_to(np.sin(elevation), turned.shape)
        # Components are stacked first and moved last, so that each is contiguous for the arithmetic that follows.
        return np.moveaxis(np.stack([up * np.cos(turned), up * np.sin(turned), z]), 0, -1)

    def reflected(self, wi: Array) -> Array:
        """f cos_i at `wi`, shape (...)."""
        return self.model.brdf(wi, self.wo, self.parameters) * wi[..., 2]

    def density(self, wi: Array) -> Array:
        """Density of the technique at `wi`, shape (...)."""
        return self.technique.density(self.wo, wi, self.parameters)

    def weight(self, wi: Array) -> Array:
        """Throughput weight at `wi`, shape (...); 0 where the density is."""
        density = self.density(wi)
        covered = density > 0.0
        return np.where(covered, self.reflected(wi) / np.where(covered, density, 1.0), 0.0)


@dataclass(frozen=True)
class Moments:
    """Integrals over the hemisphere; `error` is the largest relative difference of two rules."""

    mean: float
    variance: float
    fourth: float
    uncovered: float
    weightless: float
    error: float


def edge_points(edge: Edge, angle: Array) -> Array:
    """Directions on the edge, shape (..., 3), in the frame of wo; `angle` counts from its highest point."""
    side = np.sign(edge.normal_x)
    lean, height = -edge.normal_z * side, edge.normal_x * side
    return np.stack([np.cos(angle) * lean, np.sin(angle), np.cos(angle) * height], axis=-1)


def tail_strength(pair: Pair) -> tuple[float, bool]:
    """kappa in P(w > W) ~ kappa / (2 W^2), and whether the weight is without bound.

    Both come from the edge beyond which the density is zero. At a distance n inside it p = k n, so w > W within
    n = f cos / (k W), which holds the probability (f cos)^2 / (2 k W^2) per unit of length; kappa is the integral of
    (f cos)^2 / k along the edge.
    """
    edge = pair.edge
    if edge is None or edge.floor > 0.0:
        return 0.0, False
    nodes, weights = _rule(24, 4)
    points = edge_points(edge, nodes * 0.5 * np.pi)
    turned = pair.directions(np.arcsin(points[..., 2]), np.arctan2(points[..., 1], points[..., 0]))
    reflected = pair.reflected(turned)
    return float(np.pi * np.sum(weights * reflected**2 / edge.slope(points))), bool(np.any(reflected > 0.0))


def integrate_moments(pair: Pair, finite: bool) -> Moments:
    """Moments of the weight, refined until two rules agree; `finite` False leaves variance and fourth infinite."""
    partition, pieces = pair.partition(), 1
    fine = _integrate(pair, partition, FINE, pieces, finite)
    error = _difference(_integrate(pair, partition, COARSE, pieces, finite), fine)
    # Weights that deviate little from their mean carry few digits of the deviation, which no refining brings back.
    goal = max(GOAL, ROUNDING * abs(fine["mean"]) / max(fine["variance"], np.finfo(float).tiny) ** 0.5)
    while error > goal and pieces < MOST_PIECES:
        pieces *= 2
        coarse, fine = fine, _integrate(pair, partition, FINE, pieces, finite)
        error = _difference(coarse, fine)
    return Moments(**fine, error=error)


@cache
def _rule(order: int, pieces: int) -> tuple[Array, Array]:
    """Composite Gauss-Legendre rule on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    starts = np.arange(pieces)[:, None] / pieces
    return (starts + 0.5 * (nodes + 1.0) / pieces).ravel(), np.tile(0.5 * weights / pieces, pieces)


def _integrate(pair: Pair, partition: Partition, order: int, pieces: int, finite: bool) -> dict[str, float]:
    nodes, weights = _rule(order, pieces)
    elevation, azimuth, jacobian = partition.angles(nodes[:, None], nodes[None, :])
    solid_angle = 2.0 * jacobian * np.cos(elevation) * weights[:, None] * weights
    wi = pair.directions(elevation, azimuth)
    reflected, density = pair.reflected(wi), pair.density(wi)
    covered, mass = density > 0.0, density * solid_angle
    mean = float(np.sum(reflected * solid_angle, where=covered))
    uncovered = float(np.sum(reflected * solid_angle, where=~covered))
    below = pair.technique.below_horizon(pair.wo, pair.parameters)
    weightless = min(1.0, below + float(np.sum(mass, where=reflected == 0.0)))
    variance = fourth = np.inf
    if finite:
        # About the mean from the start, so that a technique of constant weight gives 1e-28 and not 1e-16.
        squared = (reflected / np.where(covered, density, 1.0) - mean) ** 2
        variance = float(np.sum(mass * squared)) + below * mean**2
        fourth = float(np.sum(mass * squared**2)) + below * mean**4
    return {"mean": mean, "variance": variance, "fourth": fourth, "uncovered": uncovered, "weightless": weightless}


def _difference(coarse: Mapping[str, float], fine: Mapping[str, float]) -> float:
    mean = abs(fine["mean"])
    scales = {"mean": mean, "uncovered": mean, "weightless": 1.0}
    if np.isfinite(fine["variance"]):
        scales["variance"] = max(fine["variance"], NEGLIGIBLE * mean**2)
        scales["fourth"] = max(fine["fourth"], NEGLIGIBLE**2 * mean**4)
    return max(abs(fine[name] - coarse[name]) / scale if scale > 0.0 else 0.0 for name, scale in scales.items())
