"""Checks of many drawn directions against integrals of the density: normalisation, chi-square, coverage, mean."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.checks.binning import ChiSquare, Tree, boxes_of, chi_square, is_certain, partition
from service.checks.effort import FALSE_ALARM, Effort
from service.checks.outcome import Outcome, failed, not_applicable, passed
from service.checks.sphere_quadrature import Integrals, Known, coordinates, cut, integrate
from service.inputs import Cells, cells_of, replay
from service.moments import bernstein_half_width
from service.probe import Probe, Values
from service.random_numbers import cell_key, random_pairs

Array = NDArray[Any]

PILOT = 8192
SHOWN = 40_960
"""Directions of a cell at which the quadrature is told the density, so that it does not miss a lobe."""

GOAL = 1e-6
PIECE = np.pi / 32
"""Area of a first box of the quadrature at the most: features of this size are seen."""
NORMALISATION = 1e-4
"""Difference of a density's integral from what it should be that counts, the quadrature's own error apart."""

BLIND = 0.05
"""Settings and views at which the quadrature leaves more than this open are told as such."""

LOST = 1e-7
"""Share of the reflected light on directions of density zero that counts as not covered."""

EXPECTED_REST = 1e-4
"""Share of samples without a density from which they are a bin of their own."""

TRUNCATION = 8.0
"""Weights are compared up to so many times their 99.9th percentile: a mean with known bounds, whatever the tail."""


@dataclass(frozen=True)
class Sampled:
    """Drawn directions of every cell and the integrals that they are compared with.

    Integrands: 0 density; 1 f cos; 2 f cos where the density is zero; 3 min(w, limit) p; 4 min(w, limit)^2 p.
    """

    cells: Cells
    u: list[Array]
    weights: list[Array]
    counted: list[Array]  # whether a sample has a density above zero
    trees: list[Tree]
    limits: Array
    integrals: Integrals
    bad: Array  # cells with values that are not finite: other checks speak of them


def draw_and_integrate(probe: Probe, effort: Effort, seed: int) -> Sampled:
    """Draw directions in float32, bin them, and integrate the density in double precision over the same bins."""
    cells = cells_of(probe, effort.views, effort.rows)
    u_all, weights, counted, trees, shown, bad = [], [], [], [], [], []
    for i in range(len(cells)):
        key = cell_key(seed, float(i))
        u = random_pairs(key, np.arange(PILOT + effort.samples, dtype=np.uint64))
        values = probe.draw(cells.wo[i], u, cells.parameters[i])
        finite = np.isfinite(values.wi).all(axis=1) & np.isfinite(values.pdf) & np.isfinite(values.weight)
        counts = finite & (values.pdf > 0)
        t, phi = coordinates(np.where(counts[:, None], values.wi, (0.0, 0.0, 1.0)))
        pilot = int(counts[:PILOT].sum())
        tree = partition(t[counts], phi[counts], pilot, effort.depth)
        shown.append((t[counts][:SHOWN], phi[counts][:SHOWN], tree.leaf[:SHOWN], values[counts][:SHOWN]))
        u_all.append(u[PILOT:])
        weights.append(np.where(finite, values.weight, 0.0)[PILOT:].astype(np.float64))
        counted.append(counts[PILOT:])
        trees.append(tree)
        bad.append(not finite.all())
    limits = np.array([TRUNCATION * max(float(np.quantile(w, 0.999)), 1e-30) for w in weights])
    integrals = _integrals(probe, cells, trees, _known(shown, limits), limits, effort)
    return Sampled(cells, u_all, weights, counted, trees, limits, integrals, np.array(bad))


def _known(shown: list[tuple[Array, Array, Array, Values]], limits: Array) -> Known:
    """Directions of all cells (t, phi, leaf and values of each) with the integrands there; float32 will do."""
    t, phi, leaf = (np.concatenate(column) for column in list(zip(*shown, strict=True))[:3])
    cell = np.repeat(np.arange(len(shown)), [len(one[0]) for one in shown])
    z = np.concatenate([np.maximum(values.wi[:, 2], 0.0) for *_, values in shown])
    p, brdf = (np.concatenate([getattr(values, k) for *_, values in shown]) for k in ("direction_pdf", "brdf"))
    known = p > 0  # the density that came with it is another function's; where this one says 0 nothing is known
    values = _integrands(p[known].astype(np.float64), brdf[known].astype(np.float64) * z[known], limits[cell[known]])
    return Known(t[known], phi[known], cell[known], leaf[known], values.T)


def _integrands(p: Array, reflected: Array, limit: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        weight = np.where(p > 0, np.minimum(reflected / p, limit), 0.0)
    return np.stack([p, reflected, np.where(p > 0, 0.0, reflected), weight * p, weight**2 * p])


def _integrals(probe: Probe, cells: Cells, trees: list[Tree], known: Known, limits: Array, effort: Effort) -> Integrals:
    def integrands(wi: Array, cell: Array) -> Array:
        values = probe.evaluate(cells.wo[cell], wi, cells.parameters[cell], "double")
        p = np.where(np.isfinite(values.direction_pdf), values.direction_pdf, 0.0)
        brdf = np.where(np.isfinite(values.brdf), values.brdf, 0.0)
        return _integrands(p, brdf * np.maximum(wi[:, 2], 0.0), limits[cell])

    bins = max(len(tree.boxes) for tree in trees)
    boxes = cut(boxes_of(trees), PIECE)
    return integrate(boxes, integrands, (len(cells), bins), GOAL, effort.quadrature, known=known)


def _sample_in_leaf(s: Sampled, cell: int, leaf: int) -> int:
    """A counted sample of this leaf, or the first sample where it has none."""
    tree = s.trees[cell]
    members = np.flatnonzero(tree.leaf == leaf)
    counted = int(s.counted[cell].sum())
    after_pilot = members - (len(tree.leaf) - counted)
    after_pilot = after_pilot[after_pilot >= 0]
    return int(np.flatnonzero(s.counted[cell])[after_pilot[0]]) if len(after_pilot) else 0


def _replay(probe: Probe, s: Sampled, cell: int, sample: int) -> dict[str, Any]:
    return replay(probe, s.cells.wo[cell], s.cells.parameters[cell], u=s.u[cell][sample])


def _where(s: Sampled, cell: int) -> dict[str, Any]:
    return {"cell": cell, "theta_o_deg": math.degrees(s.cells.theta_o[cell]), "parameters": s.cells.parameters[cell]}


def check_normalisation(probe: Probe, s: Sampled) -> Outcome:
    """The density integrates to the share of samples that have one: 1, unless some are thrown away with density 0."""
    integral, error = s.integrals.total[0], s.integrals.error[0]
    share = np.array([c.mean() for c in s.counted])
    n = len(s.counted[0])
    half = bernstein_half_width(share * (1 - share), np.ones(len(share)), n, FALSE_ALARM / len(share))
    chance = np.where(share < 1, half, 0.0)
    # The error estimate is the last difference of two levels; next to a pole of the density more than that is left.
    allowed = chance + 4 * error + NORMALISATION
    excess = np.abs(integral - share) - allowed
    known = allowed <= BLIND
    if not known.any():
        return not_applicable(
            "pdf-normalisation", f"at every setting the density is too sharp to be integrated within {BLIND:g}"
        )
    blind = int((~known).sum())
    power = (
        f"{len(share)} settings and views; an integral off by more than {np.median(allowed[known]):.1g} (median)"
        + (f"; at {blind} of them the density is too sharp to be integrated within {BLIND:g}" if blind else "")
    )
    worst = int(np.argmax(excess))
    evidence = {
        **_where(s, worst),
        "integral": float(integral[worst]),
        "should_be": float(share[worst]),
        "quadrature_error": float(error[worst]),
    }
    if excess[worst] <= 0:
        off = float(np.max(np.abs(integral - share)[known]))
        return passed(
            "pdf-normalisation", f"the density integrates to what it should within {off:.1g}", power, **evidence
        )
    return failed(
        "pdf-normalisation",
        f"the density integrates to {integral[worst]:.6g}, and should to {share[worst]:.6g}",
        power,
        _replay(probe, s, worst, 0),
        **evidence,
    )


def _chi_squares(s: Sampled) -> tuple[list[ChiSquare], list[Array]]:
    """The test of every cell, and its bins' differences in standard deviations, 0 where a bin takes no part."""
    tests, residuals = [], []
    for i, tree in enumerate(s.trees):
        n, size = len(s.counted[i]), len(tree.boxes)
        expected = n * s.integrals.by_bin[0, i, :size]
        observed = tree.hits
        dead = n - int(s.counted[i].sum())
        rest = n - float(expected.sum())
        unsure = 2 * n * s.integrals.error_by_bin[0, i, :size]
        if dead or rest > EXPECTED_REST * n:
            observed, expected = np.append(observed, dead), np.append(expected, max(rest, 0.0))
            unsure = np.append(unsure, unsure.sum())
        tests.append(chi_square(observed, expected, unsure))
        difference = (observed - expected) / np.sqrt(np.maximum(expected, 1.0))
        residuals.append(np.where(is_certain(expected, unsure), difference, 0.0)[:size])
    return tests, residuals


def check_chi_square(probe: Probe, s: Sampled) -> Outcome:
    """Directions fall where the density says."""
    tests, residuals = _chi_squares(s)
    if not any(t.freedom for t in tests):
        return not_applicable("chi-square", "at every setting the density is too sharp to be integrated")
    rate = FALSE_ALARM / len(tests)
    probability = np.array([t.probability for t in tests])
    freedom = float(np.median([t.freedom for t in tests]))
    n = len(s.counted[0])
    power = (
        f"{len(tests)} settings and views, {n:,} directions each in {int(freedom) + 1} bins; finds a density whose "
        f"averages over bins are off by {math.sqrt((8.5 * math.sqrt(2 * freedom) + 10) / n):.1%} (root mean square), "
        f"at a false-alarm rate of {FALSE_ALARM:g}"
    )
    left_out = max(t.left_out for t in tests)
    if left_out:
        power += f"; up to {left_out:.1%} of the directions lie where the density is too sharp to be integrated"
    worst = int(np.argmin(probability))
    t: ChiSquare = tests[worst]
    leaf = int(np.argmax(residuals[worst]))
    evidence = {
        **_where(s, worst),
        "statistic": t.statistic,
        "degrees_of_freedom": t.freedom,
        "probability": t.probability,
        "probabilities": probability,
        "left_out": left_out,
    }
    if probability[worst] >= rate:
        return passed(
            "chi-square",
            f"directions fall as the density says; smallest of {len(tests)} probabilities {probability[worst]:.2g}",
            power,
            **evidence,
        )
    bins = {"boxes": s.trees[worst].boxes, "residual": residuals[worst]}
    return failed(
        "chi-square",
        f"directions do not fall as the density says, in {int((probability < rate).sum())} of {len(tests)} settings "
        f"and views (chi-square {t.statistic:.4g} at {t.freedom} degrees of freedom)",
        power,
        _replay(probe, s, worst, _sample_in_leaf(s, worst, leaf)),
        **evidence,
        bins=bins,
    )


def check_coverage(probe: Probe, s: Sampled) -> Outcome:
    """Where the model reflects, the density is above zero."""
    reflected, lost = s.integrals.total[1], s.integrals.total[2]
    power = f"{len(lost)} settings and views in double precision; a lost share of the reflected light above {LOST:g}"
    if not (reflected > 0).any():
        return not_applicable("coverage", "the model reflects nothing at any setting")
    share = np.where(reflected > 0, lost / np.maximum(reflected, 1e-300), 0.0)
    worst = int(np.argmax(share))
    if share[worst] <= LOST:
        return passed(
            "coverage", "the density is above zero wherever the model reflects", power, lost_share=float(share[worst])
        )
    return failed(
        "coverage",
        f"the density is zero on directions that carry up to {share[worst]:.3g} of the reflected light",
        power,
        replay(probe, s.cells.wo[worst], s.cells.parameters[worst], wi=_uncovered_direction(probe, s, worst)),
        **_where(s, worst),
        lost_share=float(share[worst]),
    )


def _uncovered_direction(probe: Probe, s: Sampled, cell: int) -> Array:
    """The direction of density zero that reflects most, out of a fine grid."""
    z, phi = (a.ravel() for a in np.meshgrid((np.arange(128) + 0.5) / 128, (np.arange(256) + 0.5) / 256 * 2 * np.pi))
    sine = np.sqrt(1 - z * z)
    wi = np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=1)
    values = probe.evaluate(s.cells.wo[cell], wi, s.cells.parameters[cell], "double")
    return np.asarray(wi[int(np.argmax(np.where(values.direction_pdf > 0, -1.0, values.brdf * z)))])


def check_unbiased(probe: Probe, s: Sampled) -> Outcome:
    """The mean weight is the directional albedo: nothing is lost, and weights average to f cos over the density."""
    reflected, lost, mean, square = s.integrals.total[1:5]
    n = len(s.weights[0])
    sampled = np.array([np.minimum(w, limit).mean() for w, limit in zip(s.weights, s.limits, strict=True)])
    half = bernstein_half_width(np.maximum(square - mean * mean, 0.0), s.limits, n, FALSE_ALARM / len(mean))
    rounding = 2e-5 * np.maximum(reflected, 0.0) + 2 * s.integrals.error[3]
    scale = np.maximum(reflected, 1e-12)
    off = np.abs(sampled - mean)
    excess = np.where(reflected > 0, np.maximum((off - half - rounding) / scale, lost / scale - 1e-5), -1.0)
    excess = np.where(s.bad, -1.0, excess)
    relative = (half + rounding)[reflected > 0] / scale[reflected > 0]
    power = (
        f"{len(mean)} settings and views, {n:,} weights each; finds a bias above "
        f"{float(np.median(relative)) if len(relative) else 0:.1%}"
    )
    worst = int(np.argmax(excess))
    evidence = {
        **_where(s, worst),
        "directional_albedo": float(reflected[worst]),
        "mean_weight": float(sampled[worst] + (reflected - lost - mean)[worst]),
        "lost": float(lost[worst]),
        "interval": float(half[worst]),
    }
    if excess[worst] <= 0:
        return passed("unbiased", "the mean weight is the directional albedo", power, **evidence)
    return failed(
        "unbiased",
        f"the mean weight is {evidence['mean_weight']:.5g}, the directional albedo {reflected[worst]:.5g}"
        + (f"; {lost[worst]:.3g} lies where the density is zero" if lost[worst] > 1e-5 * scale[worst] else ""),
        power,
        _replay(probe, s, worst, int(np.argmax(s.weights[worst]))),
        **evidence,
    )
