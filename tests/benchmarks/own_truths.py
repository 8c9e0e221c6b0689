"""How far the truth that a file gives of itself is off, over the catalogue: `python -m tests.benchmarks.own_truths`.

Every model with every technique that applies, at its defaults, beside the reference that is written from the formulas.
"""

from __future__ import annotations

import math
import warnings
from collections import Counter

from service.device_reference import device_reference
from service.engine import Engine
from service.reference import CellReference, cells_reference
from service.scene import SeriesPlan, parse_scene, resolve

ANGLES = [0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0, 88.0, 89.5, 89.91]
PHI_DEG = 25.0
FORMULAS = 1e-9
"""Room for the formulas' own error."""


def main() -> None:
    """Print what is off by more than it says, and how many values are open."""
    tally: Counter[str] = Counter()
    with Engine.open() as engine:
        for model in engine.catalogue.models.values():
            azimuth = {"phi_o_deg": PHI_DEG} if model.head.anisotropic else {}
            scene = parse_scene({"model": model.name, "theta_o_deg": ANGLES, **azimuth})
            for plan in resolve(scene, engine.catalogue).series:
                compare(plan, engine, tally)
    print(f"{tally['values']} values: {tally['off']} off by more than they say, {tally['open']} not given")


def compare(plan: SeriesPlan, engine: Engine, tally: Counter[str]) -> None:
    """Add the values of one model and technique to the tally."""
    theta_o, phi_o = [math.radians(angle) for angle in ANGLES], math.radians(plan.azimuth_deg)
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):
        found = device_reference(plan, engine, ANGLES)
    exact = cells_reference(plan.model.name, plan.technique.name, plan.parameters, theta_o, phi_o)
    for angle, own, formulas in zip(ANGLES, found, exact, strict=True):
        for name in ("mean", "albedo", "variance"):
            value, truth = getattr(own, name), getattr(formulas, name)
            tally["values"] += 1
            tally["open"] += not math.isfinite(value) and math.isfinite(truth)
            if is_off(own, name, truth):
                tally["off"] += 1
                print(f"{plan.model.name} {plan.technique.name} {angle:g} degrees: {name} {value:.6g}, not {truth:.6g}")


def is_off(own: CellReference, name: str, truth: float) -> bool:
    """Whether a value is further from the truth than it says."""
    value = getattr(own, name)
    return math.isfinite(value) and abs(value - truth) > getattr(own, f"{name}_uncertainty") + FORMULAS * (1 + truth)


if __name__ == "__main__":
    main()
