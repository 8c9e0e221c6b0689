"""Float64 truth of one cell: a model, a technique, parameter values and a view direction."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from service.reference.entry import exact_albedo, half_vector_lobes, load_model, load_technique
from service.reference.lobe_moments import integrate_lobes
from service.reference.moments import NEGLIGIBLE, Pair, integrate_moments, tail_strength
from service.reference.supremum import supremum


@dataclass(frozen=True)
class CellReference:
    """Exact statistics of the throughput weight w = f cos_i / p of one cell.

    A value that is not known is NaN, which the quadrature from the formulas never leaves. An uncertainty is what the
    value may be off by, absolutely.
    """

    mean: float  # what the average of unboundedly many weights tends to
    albedo: float  # directional albedo of the model, which an unbiased technique's mean equals
    variance: float  # inf where it diverges
    fourth_moment: float  # fourth central moment, inf where it diverges
    max_weight: float  # supremum, inf where there is no bound
    uncovered: float  # integral of f cos_i over directions that are never drawn: mean = albedo - uncovered
    zero_probability: float  # probability that a sample weighs zero, for instance below the horizon
    tail_strength: float  # kappa in P(w > W) ~ kappa / (2 W^2); 0 where the variance is finite
    mean_uncertainty: float
    albedo_uncertainty: float
    variance_uncertainty: float  # inf where the variance is


def cell_reference(
    model: str, technique: str, parameters: Mapping[str, float], theta_o: float, phi_o: float = 0.0
) -> CellReference | None:
    """Reference of one cell; None where the model or the technique has no reference file.

    Angles are radians, 0 <= theta_o < pi/2; `phi_o` matters to anisotropic models only. Raises ValueError for an
    angle out of range.
    """
    if not 0.0 <= theta_o < 0.5 * math.pi:
        raise ValueError(f"theta_o must be in [0, pi/2) radians, not {theta_o}")
    the_model, the_technique = load_model(model), load_technique(technique)
    if the_model is None or the_technique is None:
        return None
    sine = math.sin(theta_o)
    wo = np.array([sine * math.cos(phi_o), sine * math.sin(phi_o), math.cos(theta_o)])
    pair = Pair(the_model, the_technique, parameters, wo)
    kappa, unbounded = tail_strength(pair)
    if any(half_vector_lobes(part, parameters) for part in (the_model, the_technique)):
        moments, largest = integrate_lobes(pair)
    else:
        moments = integrate_moments(pair, finite=not unbounded)
        largest = math.inf if unbounded else supremum(pair)
    albedo = exact_albedo(the_model, float(wo[2]), parameters)
    return CellReference(
        mean=moments.mean,
        albedo=moments.mean + moments.uncovered if albedo is None else albedo,
        variance=moments.variance,
        fourth_moment=moments.fourth,
        max_weight=largest,
        uncovered=moments.uncovered,
        zero_probability=moments.weightless,
        tail_strength=kappa,
        mean_uncertainty=moments.error * abs(moments.mean),
        albedo_uncertainty=moments.error * abs(moments.mean + moments.uncovered) if albedo is None else 0.0,
        variance_uncertainty=moments.error * max(moments.variance, NEGLIGIBLE * moments.mean**2),
    )


def cells_reference(
    model: str, technique: str, parameters: Mapping[str, float], theta_o: Sequence[float], phi_o: float = 0.0
) -> list[CellReference] | None:
    """References of the cells at many view angles (radians), in their order; None as in `cell_reference`."""
    if load_model(model) is None or load_technique(technique) is None:
        return None
    cells = (cell_reference(model, technique, parameters, theta, phi_o) for theta in theta_o)
    return [cell for cell in cells if cell is not None]
