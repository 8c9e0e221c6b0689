"""The GGX distribution in float64: Walter et al. 2007 (eq. 33 to 36), Heitz 2014 (eq. 72) for Smith's masking, Heitz
2018 for visible normals, Dupuy and Benyoub 2023 and Eto and Tokuyoshi 2023 for spherical caps.

Slopes stand for half vectors, as in :mod:`service.reference.half_vector`. ``alpha`` is the pair (mx, my).
"""

import numpy as np

from service.reference.entry import Array, Parameters
from service.reference.half_vector import Half, half_vector, reflect
from service.reference.half_vector_plane import plane_of

Alpha = tuple[float, float]


def alpha_of(parameters: Parameters) -> Alpha:
    """Its two parameters."""
    return parameters["mx"], parameters["my"]


def distribution(h: Half, alpha: Alpha) -> Array:
    """D in 1/sr (Walter's eq. 33, with a slope in units of alpha for tan/alpha)."""
    mx, my = alpha
    return np.asarray((1.0 + h.tan2) ** 2 / (np.pi * mx * my * (1.0 + (h.x / mx) ** 2 + (h.y / my) ** 2) ** 2))


def auxiliary(w: Array, alpha: Alpha) -> Array:
    """Lambda of Smith's masking for directions above the horizon, shape (...) (Heitz 2014, eq. 72)."""
    x, y, z = (w[..., k] for k in range(3))
    return np.asarray(0.5 * (np.sqrt(1.0 + (alpha[0] * x / z) ** 2 + (alpha[1] * y / z) ** 2) - 1.0))


def slope(u1: Array, u2: Array, alpha: Alpha) -> tuple[Array, Array]:
    """Slopes with density D cos_h (Walter's eq. 35, 36)."""
    tan = np.sqrt(u1 / (1.0 - u1))
    return alpha[0] * tan * np.cos(2.0 * np.pi * u2), alpha[1] * tan * np.sin(2.0 * np.pi * u2)


def below_of_half_vectors(wo: Array, alpha: Alpha) -> float:
    """Probability that reflection at a half vector of density D cos_h goes below the horizon."""
    plane, _ = plane_of(wo, [alpha])
    psi, weights = plane.turn_rule()
    return float(np.sum(weights / (1.0 + plane.rim(psi) ** 2)) / (2.0 * np.pi))


def spared(wo: Array, alpha: Alpha) -> Array:
    """1 - k of Eto and Tokuyoshi's eq. 5 and 6, shape (...): how much less deep than Dupuy's their cap is."""
    least = min(*alpha, 1.0)
    s = 1.0 + np.hypot(wo[..., 0], wo[..., 1])
    k = (1.0 - least**2) * s**2 / (s**2 + (least * wo[..., 2]) ** 2)
    return np.asarray(1.0 - k)


def visible_density(wo: Array, wi: Array, alpha: Alpha, cut: Array | float = 0.0) -> Array:
    """Density in 1/sr of ``wi``, shape (..., 3), reflected at normals that ``wo`` sees: G1 D/(4 cos_o).

    ``cut`` is that part of the depth cos_o of the cap in which stretched directions lie, that is left out.
    """
    h = half_vector(wi, wo)
    plain = distribution(h, alpha) / (4.0 * wo[..., 2] * (1.0 + auxiliary(wo, alpha)))
    # The point of the cap that h joins to wo, in the stretched space: v of length 1, n the stretched normal.
    v, n = stretched(wo, alpha), np.stack([h.x / alpha[0], h.y / alpha[1], np.ones_like(h.x)], axis=-1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    height = 2.0 * np.sum(v * n, axis=-1) * n[..., 2]  # over the rim of the whole cap
    drawn = (wi[..., 2] > 0.0) | ((wi[..., 2] + wo[..., 2] > 0.0) & (height > cut * v[..., 2]))
    return np.where(drawn, plain * (1.0 + v[..., 2]) / (1.0 + (1.0 - cut) * v[..., 2]), 0.0)


def stretched(wo: Array, alpha: Alpha) -> Array:
    """Unit vectors, shape (..., 3), of the space in which the facets are those of a sphere."""
    v = wo * np.array([*alpha, 1.0])
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def reflect_at_stretched(wo: Array, n: Array, alpha: Alpha) -> Array:
    """Mirror images of ``wo`` about normals ``n`` of the stretched space, of any length."""
    return reflect(wo, alpha[0] * n[..., 0] / n[..., 2], alpha[1] * n[..., 1] / n[..., 2])


def cap_sample(wo: Array, u1: Array, u2: Array, alpha: Alpha, cut: Array | float = 0.0) -> Array:
    """Directions, shape (..., 3): points drawn evenly on a cap, whose half vectors with wo are the normals."""
    v = stretched(wo, alpha)
    depth = (1.0 - cut) * v[..., 2]
    z = (1.0 - u1) * (1.0 + depth) - depth
    sine = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    point = np.stack([sine * np.cos(2.0 * np.pi * u2), sine * np.sin(2.0 * np.pi * u2), z], axis=-1)
    return reflect_at_stretched(wo, point + v, alpha)


def below_of_visible(wo: Array, alpha: Alpha, cut: float = 0.0) -> float:
    """Probability that reflection at a visible normal goes below the horizon.

    Along a ray of the stretched plane of slopes the density is G1 (1 + lean rho) rho/(pi (1 + rho^2)^2), up to where
    wo sees normals from the side. All above the horizon lies in the cap that is left.
    """
    plane, _ = plane_of(wo, [alpha])
    psi, weights = plane.turn_rule()
    lean, rim = plane.lean(psi), plane.rim(psi)

    def beyond(rho: Array) -> Array:
        return np.asarray(1.0 / (1.0 + rho**2) + lean * (np.arctan2(1.0, rho) + rho / (1.0 + rho**2)))

    last = 1.0 / np.maximum(-lean, 1e-100)
    masking = 1.0 / (1.0 + float(auxiliary(wo, alpha)))
    share = masking * (beyond(rim) - np.where(lean < 0.0, beyond(last), 0.0))
    below = float(np.sum(weights * share) / (2.0 * np.pi))
    z = float(stretched(wo, alpha)[2])
    return 1.0 - (1.0 - below) * (1.0 + z) / (1.0 + (1.0 - cut) * z)
