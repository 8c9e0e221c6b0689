"""What a model and a technique bring to the float64 reference, and how their files are found.

A reference file is optional. It is a module `models/NAME.py` or `techniques/NAME.py` (`-` becomes `_`) with the
functions of `Model` or `Technique`. A model may add `directional_albedo(mu, parameters)` and
`average_albedo(parameters)`, both may add `half_vector_lobes(parameters)`: see `exact_albedo`, `exact_average_albedo`
and `half_vector_lobes` here. Directions are unit arrays of shape (..., 3) that point away from the surface, with the
normal along +z.
"""

import importlib
import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Parameters = Mapping[str, float]


@dataclass(frozen=True)
class Edge:
    """A great circle inside the hemisphere on which the density has fallen linearly to its floor.

    The circle is the plane `normal_x * x + normal_z * z = 0` in the frame whose x axis is the azimuth of wo; the
    lobe lies where that sum is positive.
    """

    normal_x: float
    normal_z: float
    floor: float  # density beyond the edge, 1/sr; 0 leaves those directions uncovered
    slope: Callable[[Array], Array]  # density per radian inward from the edge, at directions (..., 3) in that frame


@dataclass(frozen=True)
class Kinks:
    """Where an integrand is not smooth, or changes over a short distance.

    Elevations are radians above the horizon, so that small ones are exact. A quarter turn from wo, where s changes
    sign, is always split and need not be named.
    """

    elevations: tuple[float, ...] = ()
    edge: Edge | None = None
    surfaces: tuple[Callable[[Array], Array], ...] = ()  # of wi; the integrand is not smooth where one changes its sign


class Model(Protocol):
    """A BRDF: its value, its kinks and, where it has a closed form, its directional albedo."""

    def brdf(self, wi: Array, wo: Array, parameters: Parameters) -> Array:
        """Value in 1/sr, without the cosine."""
        ...

    def kinks(self, wo: Array, parameters: Parameters) -> Kinks:
        """Kinks of the BRDF for this view."""
        ...


class Technique(Protocol):
    """A way to draw wi: its density, a float64 sampler and its kinks."""

    def density(self, wo: Array, wi: Array, parameters: Parameters) -> Array:
        """Density of `wi` in 1/sr, zero where no sample falls."""
        ...

    def sample(self, wo: Array, u1: Array, u2: Array, parameters: Parameters) -> tuple[Array, Array]:
        """Directions and their density for numbers in [0, 1)."""
        ...

    def kinks(self, wo: Array, parameters: Parameters) -> Kinks:
        """Kinks of the density for this view."""
        ...

    def below_horizon(self, wo: Array, parameters: Parameters) -> float:
        """Exact probability that a direction falls below the horizon."""
        ...


@cache
def _module(kind: str, name: str) -> object | None:
    stem = name.replace("-", "_")
    path = f"{__package__}.{kind}.{stem}"
    # isidentifier also keeps names with dots or slashes, as a user's own file may have, from reaching the importer.
    if not stem.isidentifier() or importlib.util.find_spec(path) is None:
        return None
    return importlib.import_module(path)


def exact_albedo(model: Model, mu: float, parameters: Parameters) -> float | None:
    """The model's own `directional_albedo`, the integral of BRDF times cosine for a view of cosine `mu`.

    None where it has none.
    """
    function = getattr(model, "directional_albedo", None)
    return None if function is None else float(function(mu, parameters))


def exact_average_albedo(model: Model, parameters: Parameters) -> float | None:
    """The model's own `average_albedo`, its directional albedo averaged over views by their cosine.

    None where it has none.
    """
    function = getattr(model, "average_albedo", None)
    return None if function is None else float(function(parameters))


def half_vector_lobes(entry: Model | Technique, parameters: Parameters) -> tuple[tuple[float, float], ...]:
    """Slopes of the half vector, along x and y, within which the entry has its lobes; empty where it has none.

    They are what the optional function `half_vector_lobes` of its file says.
    """
    function = getattr(entry, "half_vector_lobes", None)
    return () if function is None else tuple(function(parameters))


def load_model(name: str) -> Model | None:
    """Reference of the model called `name`; None where there is no such file."""
    return cast("Model | None", _module("models", name))


def load_technique(name: str) -> Technique | None:
    """Reference of the technique called `name`; None where there is no such file."""
    return cast("Technique | None", _module("techniques", name))
