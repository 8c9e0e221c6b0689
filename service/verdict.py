"""Verdicts: what the numbers of a series mean, from the evidence of the run and of the reference.

Every test here has a stated false-alarm rate: `FALSE_ALARM` a series, shared out over its angles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.estimators import Estimate
from service.moments import Statistics, bernstein_half_width
from service.plain_data import finite_or_none
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


@dataclass(frozen=True)
class Evidence:
    """All that a verdict rests on, one entry an angle."""

    theta_o_deg: Angles
    estimate: Estimate
    reference: Sequence[CellReference] | None
    replay: Sequence[dict[str, Any]]

    @property
    def estimator(self) -> Estimator:
        """The estimator as used."""
        return self.estimate.estimator

    @property
    def by_rule(self) -> bool:
        """Whether the numbers come from a quadrature, which draws nothing."""
        return self.estimator.method == "quadrature"


def verdict(evidence: Evidence) -> dict[str, Any]:
    """The verdict of a series: `status`, and `findings` in the order of `ORDER`, worst first."""
    findings = _counted(evidence)
    if evidence.reference is not None:
        findings += _known(evidence, evidence.reference)
    statistics = evidence.estimate.statistics
    if statistics is not None:
        findings += _biased(evidence, statistics) + _unreached(evidence, statistics)
        findings += _tails(evidence, statistics) if not evidence.by_rule else []
    held = sorted((finding for finding in findings if finding is not None), key=lambda f: ORDER.index(f["name"]))
    return {"status": held[0]["name"] if held else "ok", "findings": held}


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
    bad, negative = e.estimate.nonfinite > 0, e.estimate.negative > 0
    return [
        _finding(
            "nonfinite",
            bad,
            e.theta_o_deg,
            f"{e.estimate.nonfinite.sum():,} samples, left out of the sums, have a weight, density or direction that "
            "is not finite",
            count=e.estimate.nonfinite[bad].tolist(),
            replay=[replay for replay, is_bad in zip(e.replay, bad, strict=True) if is_bad],
        ),
        _finding(
            "negative-weight",
            negative,
            e.theta_o_deg,
            f"{e.estimate.negative.sum()} samples have a negative weight",
            count=e.estimate.negative[negative].tolist(),
        ),
    ]


def _known(e: Evidence, reference: Sequence[CellReference]) -> list[dict[str, Any] | None]:
    """What the reference knows of the technique, whatever was sampled."""
    albedo, unsure = _column(reference, "albedo"), _column(reference, "albedo_uncertainty")
    uncovered, tail = _column(reference, "uncovered"), _column(reference, "tail_strength")
    infinite, unbounded = (np.isinf(_column(reference, name)) for name in ("variance", "max_weight"))
    missing = uncovered > RELATIVE_BIAS * albedo + unsure
    gain = albedo - unsure > ENERGY_LIMIT
    bias = _column(reference, "mean") - albedo
    off = np.abs(bias) > RELATIVE_BIAS * albedo + unsure + _column(reference, "mean_uncertainty")
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


def _column(reference: Sequence[CellReference], name: str) -> NDArray[np.float64]:
    """One value of the reference for every angle."""
    return np.array([getattr(cell, name) for cell in reference], np.float64)


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
    variance, bound = _column(e.reference, "variance"), _column(e.reference, "max_weight")
    mean, unsure = _column(e.reference, "mean"), _column(e.reference, "mean_uncertainty")
    usable = np.isfinite(variance) & np.isfinite(bound)
    if e.by_rule:
        half_width = statistics.mean_stderr
    else:
        # Replicates of a scrambled net have at most twice the variance of as many independent samples (Owen 1997).
        spread = 2.0 * variance if e.estimator.method == "qmc" else variance
        half_width = bernstein_half_width(spread, bound, e.estimator.samples, FALSE_ALARM / len(mean))
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
        known_infinite = np.isinf(_column(e.reference, "variance"))
    short = e.estimate.unreached & ~e.estimate.divergent & ~known_infinite
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = statistics.variance_stderr / statistics.variance
    return [
        _finding(
            "infinite-variance",
            e.estimate.divergent & ~known_infinite,
            e.theta_o_deg,
            f"the variance grew by ever equal steps as {e.estimator.samples:,} nodes came closer to a singularity",
        ),
        _finding(
            "imprecise",
            short,
            e.theta_o_deg,
            f"{e.estimator.method} with {e.estimator.samples:,} samples does not reach the tolerance "
            f"{e.estimator.tolerance:g}",
            tolerance=e.estimator.tolerance,
            variance_relative_error=finite_or_none(relative[short]),
        )
        if e.estimator.tolerance is not None
        else None,
    ]


def _tails(e: Evidence, statistics: Statistics) -> list[dict[str, Any] | None]:
    """Error bars that are not to be trusted at this count, and statistics too noisy to be of use."""
    kurtosis = statistics.kurtosis
    if e.reference is not None:
        known = np.array([_kurtosis(cell) for cell in e.reference])
        kurtosis = np.where(np.isnan(known), kurtosis, known)
    finite = np.isfinite(kurtosis)
    if e.reference is not None:
        finite &= ~np.isinf(_column(e.reference, "variance"))
    needed = TAIL_SAMPLES * np.maximum(kurtosis - 1.0, 0.0)
    heavy = finite & (needed > e.estimator.samples)
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
