"""The specular lobe that the models of Kurt et al. 2010 share (eq. 10)."""

import numpy as np

from service.reference.directions import both_above
from service.reference.entry import Array
from service.reference.half_vector import Half, beckmann


def kurt_lobe(h: Half, wi: Array, wo: Array, fresnel: Array, mx: float, my: float, alpha: float) -> Array:
    """F D / (4 wo.h (cos_i cos_o)^alpha), shape (...); 0 where either direction is not above the horizon."""
    above = both_above(wi, wo)
    cosines = np.where(above, wi[..., 2] * wo[..., 2], 1.0)
    divisor = np.where(above, 4.0 * h.to_view * cosines**alpha, 1.0)
    return np.where(above, fresnel * beckmann(h, mx, my) / divisor, 0.0)
