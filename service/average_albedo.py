"""Average albedo of a model over a swept parameter: in closed form, and from the sampled directional albedos.

The average over views weighted by their cosine is the integral of E(theta) sin(2 theta) over theta from 0 to pi/2.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.reference.entry import exact_average_albedo, load_model

POINTS = 65


def with_average_albedo(result: Mapping[str, Any], parameter: str) -> dict[str, Any]:
    """A statistics result of one model, swept over `parameter`, with the block `average_albedo`.

    The block has the swept values with the integrals of the sampled mean weights, and the closed form at POINTS values
    between the least and the largest of them; that is empty for a model without one.
    """
    series = result["series"]
    values = [one["parameters"][parameter] for one in series]
    integrated = [integrate_over_views(np.radians(one["theta_o_deg"]), np.array(one["mean"])) for one in series]
    model = load_model(series[0]["model"])
    dense = np.linspace(min(values), max(values), POINTS).tolist()
    fixed = {name: value for name, value in series[0]["parameters"].items() if name != parameter}
    exact = [] if model is None else [exact_average_albedo(model, {**fixed, parameter: value}) for value in dense]
    known = None not in exact
    block = {
        "parameter": parameter,
        "integrated": {"value": values, "average": integrated},
        "closed_form": {"value": dense if known else [], "average": exact if known else []},
    }
    return {**result, "average_albedo": block}


def integrate_over_views(theta: NDArray[np.float64], albedo: NDArray[np.float64]) -> float:
    """Integral of albedo sin(2 theta) over theta from 0 to pi/2, the albedo linear between the angles (radians).

    The product is integrated exactly; beyond the last angle, which has next to no weight, the albedo stays as it is.
    """
    ends = np.append(theta, 0.5 * np.pi)
    held = np.append(albedo, albedo[-1])
    slope = np.diff(held) / np.diff(ends)
    flat = -0.5 * np.cos(2 * ends)
    rising = 0.25 * np.sin(2 * ends) - 0.5 * ends * np.cos(2 * ends)
    return float(np.sum((held[:-1] - slope * ends[:-1]) * np.diff(flat) + slope * np.diff(rising)))
