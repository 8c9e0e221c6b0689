"""Verdicts: what the numbers of a series mean, from the evidence of the run and of the reference.

Every test here has a stated false-alarm rate: `FALSE_ALARM` a series, shared out over its angles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from service.moments import Statistics
from service.reference import CellReference
from service.scene import MAX_SAMPLES, Estimator

FALSE_ALARM = 1e-6
"""Probability that a correct series is called biased by chance."""

TAIL_SAMPLES = 1000
"""A variance's error bar is trusted when (kurtosis - 1)/n is below 1/TAIL_SAMPLES: about as many samples as this then
lie in the tail that carries the fourth moment, and the error bar itself is known to a few percent."""

RELATIVE_BIAS = 1e-6
"""A technique whose reference mean differs from the albedo by more than this share of it is biased."""

ORDER = (
    "nonfinite",
    "negative-weight",
    "infinite-variance",
    "biased",
    "uncovered",
    "unbounded-weight",
    "energy-gain",
    "heavy-tail",
    "imprecise",
)
ENERGY_LIMIT = 1.001
IMPRECISE = 0.1

Angles = Sequence[float]
Bools = NDArray[np.bool_]


class Counts(Protocol):
    """What was counted sample by sample and what the estimator says of itself, each of shape (cells,)."""

    @property
    def nonfinite(self) -> NDArray[np.int64]:
        """Samples that are not finite."""
        ...

    @property
    def negative(self) -> NDArray[np.int64]:
        """Samples with a negative weight."""
        ...

    @property
    def unreached(self) -> Bools:
        """Cells whose tolerance was not reached."""
        ...

    @property
    def divergent(self) -> Bools:
        """Cells whose variance grew without limit."""
        ...


@dataclass(frozen=True)
class Evidence:
    """All that a verdict rests on, one entry an angle. `statistics` is None where no moment was asked for."""

    theta_o_deg: Angles
    estimator: Estimator
    sums: Counts
    statistics: Statistics | None
    reference: Sequence[CellReference] | None
    replay: Sequence[dict[str, Any]]

    @property
    def samples(self) -> int:
        """Samples for each angle."""
        return self.estimator.samples

    @property
    def by_rule(self) -> bool:
        """Whether the numbers come from a quadrature, which draws nothing."""
        return self.estimator.method == "quadrature"


def verdict(evidence: Evidence) -> dict[str, Any]:
    """The verdict of a series: `status`, and `findings` in the order of `ORDER`, worst first."""
    findings = _counted(evidence)
    if evidence.reference is not None:
        findings += _known(evidence, evidence.reference)
    if evidence.statistics is not None:
        findings += _biased(evidence, evidence.statistics) + _unreached(evidence, evidence.statistics)
        findings += _tails(evidence, evidence.statistics) if not evidence.by_rule else []
    held = sorted((finding for finding in findings if finding is not None), key=lambda f: ORDER.index(f["name"]))
    return {"status": held[0]["name"] if held else "ok", "findings": held}


def finite_or_none(values: Any) -> list[float | None]:
    """A list for JSON: what is not finite becomes None."""
    return [float(value) if math.isfinite(value) else None for value in values]


def _finding(name: str, where: Bools, angles: Angles, message: str, **evidence: Any) -> dict[str, Any] | None:
    """A finding for the angles where it holds, or None where it holds nowhere."""
    if not np.any(where):
        return None
    held = [angle for angle, holds in zip(angles, where, strict=True) if holds]
    place = (
        f"at {_degrees(held[0])} degrees"
        if len(held) == 1
        else f"at {len(held)} angles, {_degrees(min(held))} to {_degrees(max(held))} degrees"
    )
    return {"name": name, "message": f"{message} ({place})", "evidence": {"theta_o_deg": held, **evidence}}


def _counted(e: Evidence) -> list[dict[str, Any] | None]:
    """What the device counted sample by sample."""
    bad, negative = e.sums.nonfinite > 0, e.sums.negative > 0
    return [
        _finding(
            "nonfinite",
            bad,
            e.theta_o_deg,
            f"{e.sums.nonfinite.sum():,} samples, left out of the sums, have a weight, density or direction that is "
            "not finite",
            count=e.sums.nonfinite[bad].tolist(),
            replay=[replay for replay, is_bad in zip(e.replay, bad, strict=True) if is_bad],
        ),
        _finding(
            "negative-weight",
            negative,
            e.theta_o_deg,
            f"{e.sums.negative.sum()} samples have a negative weight",
            count=e.sums.negative[negative].tolist(),
        ),
    ]


def _known(e: Evidence, reference: Sequence[CellReference]) -> list[dict[str, Any] | None]:
    """What the reference knows of the technique, whatever was sampled."""
    variance, supremum, albedo, mean, uncovered, tail, unsure, mean_unsure = (
        np.array([getattr(cell, name) for cell in reference])
        for name in (
            *("variance", "max_weight", "albedo", "mean", "uncovered", "tail_strength"),
            *("albedo_uncertainty", "mean_uncertainty"),
        )
    )
    infinite, unbounded = np.isinf(variance), np.isinf(supremum)
    missing = uncovered > RELATIVE_BIAS * albedo + unsure
    gain = albedo - unsure > ENERGY_LIMIT
    bias = mean - albedo
    off = np.abs(bias) > RELATIVE_BIAS * albedo + unsure + mean_unsure
    return [
        _finding(
            "infinite-variance",
            infinite,
            e.theta_o_deg,
            _why_no_variance(float(np.max(tail, initial=0.0)))
            + ("no value is given" if e.by_rule else "the value given is that of this sample and grows with the count"),
            tail_strength=finite_or_none(np.where(infinite, tail, np.nan)),
        ),
        _finding(
            "uncovered",
            missing,
            e.theta_o_deg,
            "the density is zero where the model is not; up to "
            f"{np.max((uncovered / np.maximum(albedo, 1e-300))[missing], initial=0.0):.3g} "
            "of the reflected light is never sampled",
            lost_albedo=finite_or_none(uncovered[missing]),
        ),
        _finding(
            "unbounded-weight",
            unbounded,
            e.theta_o_deg,
            "the weight has no upper bound, or one beyond 1e290; the largest one seen grows with the count",
        ),
        _finding(
            "energy-gain",
            gain,
            e.theta_o_deg,
            f"the model reflects up to {np.max(albedo[gain], initial=0.0):.6g} of the light it receives",
            albedo=finite_or_none(albedo[gain]),
        ),
        _finding(
            "biased",
            off,
            e.theta_o_deg,
            "the mean weight differs from the directional albedo by up to "
            f"{np.max(np.abs(bias[off]), initial=0.0):.3g}",
            bias=finite_or_none(bias),
        ),
    ]


def _why_no_variance(strength: float) -> str:
    """An infinite variance in words: with the strength of an inverse-square tail, where it comes from one."""
    if strength == 0.0:
        return "the variance of the weight is infinite, or beyond 1e290; "
    return f"the weight has no variance: P(w > W) falls like kappa/(2 W^2), with kappa up to {strength:.3g}; "


def _biased(e: Evidence, statistics: Statistics) -> list[dict[str, Any] | None]:
    """The sampled mean against the reference, where the reference itself says that the technique is unbiased.

    The interval is Bernstein's inequality with the reference's variance and supremum: it holds at any count and for any
    tail, at the false-alarm rate stated.
    """
    if e.reference is None:
        return []
    variance, bound, mean, unsure = (
        np.array([getattr(cell, name) for cell in e.reference])
        for name in ("variance", "max_weight", "mean", "mean_uncertainty")
    )
    usable = np.isfinite(variance) & np.isfinite(bound)
    if e.by_rule:
        half_width = statistics.mean_stderr
    else:
        # Replicates of a scrambled net have at most twice the variance of as many independent samples (Owen 1997).
        spread = 2.0 * variance if e.estimator.method == "qmc" else variance
        half_width = bernstein_half_width(spread, bound, e.samples, FALSE_ALARM / len(mean))
    rounding = 1e-6 * np.abs(mean)
    off = np.abs(statistics.mean - mean)
    with np.errstate(invalid="ignore"):
        wrong = usable & (off > half_width + rounding + unsure)
    return [
        _finding(
            "biased",
            wrong,
            e.theta_o_deg,
            "the sampled mean is off the reference by up to "
            f"{np.max(off[wrong], initial=0.0):.3g}, beyond what chance allows (rate {FALSE_ALARM:g})",
            difference=finite_or_none((statistics.mean - mean)[wrong]),
            interval=finite_or_none(half_width[wrong]),
        )
    ]


def _unreached(e: Evidence, statistics: Statistics) -> list[dict[str, Any] | None]:
    """What the estimator itself says of its numbers: a variance that grew for ever, a tolerance it did not reach."""
    known_infinite = np.zeros(len(e.theta_o_deg), bool)
    if e.reference is not None:
        known_infinite = np.isinf([cell.variance for cell in e.reference])
    short = e.sums.unreached & ~e.sums.divergent & ~known_infinite
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = statistics.variance_stderr / statistics.variance
    return [
        _finding(
            "infinite-variance",
            e.sums.divergent & ~known_infinite,
            e.theta_o_deg,
            f"the variance grew by ever equal steps as {e.samples:,} nodes came closer to a singularity",
        ),
        _finding(
            "imprecise",
            short,
            e.theta_o_deg,
            f"{e.estimator.method} with {e.samples:,} samples does not reach the tolerance {e.estimator.tolerance:g}",
            tolerance=e.estimator.tolerance,
            variance_relative_error=finite_or_none(relative[short]),
        )
        if e.estimator.tolerance is not None
        else None,
    ]


def bernstein_half_width(
    variance: NDArray[np.float64], bound: NDArray[np.float64], samples: int, false_alarm: float
) -> NDArray[np.float64]:
    """Half width of a two-sided interval for the mean of `samples` weights in [0, bound] with this variance
    (Bernstein).
    """
    log_term = math.log(2.0 / false_alarm)
    linear = np.where(np.isfinite(bound), bound, 0.0) * log_term / 3.0
    spread = np.where(np.isfinite(variance), variance, 0.0)
    return (linear + np.sqrt(linear**2 + 2.0 * samples * spread * log_term)) / samples


def _tails(e: Evidence, statistics: Statistics) -> list[dict[str, Any] | None]:
    """Error bars that are not to be trusted at this count, and statistics too noisy to be of use."""
    kurtosis = statistics.kurtosis
    if e.reference is not None:
        known = np.array([_kurtosis(cell) for cell in e.reference])
        kurtosis = np.where(np.isnan(known), kurtosis, known)
    finite = np.isfinite(kurtosis)
    if e.reference is not None:
        finite &= ~np.isinf([cell.variance for cell in e.reference])
    needed = TAIL_SAMPLES * np.maximum(kurtosis - 1.0, 0.0)
    heavy = finite & (needed > e.samples)
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = statistics.mean_stderr / np.abs(statistics.mean)
        imprecise = ~heavy & finite & (statistics.mean > 0) & (relative > IMPRECISE)
    return [
        _finding(
            "heavy-tail",
            heavy,
            e.theta_o_deg,
            "rare large weights carry the fourth moment, and error bars from the samples do not hold at this count; "
            f"{_samples(_rounded_up(np.max(needed[heavy], initial=0.0)))} would do",
            samples_needed=[_rounded_up(value) for value in needed[heavy].tolist()],
        ),
        _finding(
            "imprecise",
            imprecise,
            e.theta_o_deg,
            f"the standard error of the mean is above {IMPRECISE:.0%} of the mean",
        ),
    ]


def _kurtosis(cell: CellReference) -> float:
    """m4/m2^2 of the reference; 1 where the weight is constant, NaN where it has no fourth moment."""
    if not math.isfinite(cell.fourth_moment):
        return math.nan
    return cell.fourth_moment / cell.variance**2 if cell.variance > 1e-20 else 1.0


def _samples(count: int) -> str:
    return f"{count:,} samples" if count <= MAX_SAMPLES else f"{count:.2g} samples, more than a scene may ask for,"


def _degrees(angle: float) -> str:
    """An angle in degrees, which is below 90, in few digits that are below 90 too."""
    return f"{angle:g}" if float(f"{angle:g}") < 90 else repr(float(angle))


def _rounded_up(count: float) -> int:
    """A count with two significant digits, rounded up."""
    if count < 1:
        return 1
    step: int = 10 ** max(0, math.floor(math.log10(count)) - 1)
    return math.ceil(count / step) * step
