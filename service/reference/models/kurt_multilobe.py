"""Kurt et al. 2010, eq. 14 with two lobes."""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array, Kinks, Parameters
from service.reference.half_vector import half_vector, schlick
from service.reference.kurt_lobe import kurt_lobe


def brdf(wi: Array, wo: Array, parameters: Parameters) -> Array:
    """Value in 1/sr for directions of shape (..., 3); 0 where either is not above the horizon."""
    h = half_vector(wi, wo)
    above = both_above(wi, wo)
    value = np.where(above, parameters["kd"] / np.pi, 0.0)
    for k in "12":
        ks, f0, mx, my, alpha = (parameters[name + k] for name in ("ks", "f0", "mx", "my", "alpha"))
        value = value + ks * kurt_lobe(h, wi, wo, schlick(f0, h.to_view), mx, my, alpha)
    return value


def kinks(wo: Array, parameters: Parameters) -> Kinks:
    """None."""
    return Kinks()


def half_vector_lobes(parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Both lobes."""
    return tuple((parameters[f"mx{k}"], parameters[f"my{k}"]) for k in (1, 2))
