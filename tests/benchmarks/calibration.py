"""Whether intervals hold what they say: 95 % intervals of mean and variance over many seeds, in every cell."""

from __future__ import annotations

import numpy as np

from service.engine import Engine
from service.scene import parse_scene, resolve
from service.statistics import compute_statistics

ROUGHNESS = [0.25, 0.5, 0.75, 1.0]
ANGLES = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0, 89.0]
NORMAL_95 = 1.959964


def coverage(engine: Engine, seeds: int, samples: int) -> dict[str, np.ndarray]:
    """Share of seeds whose interval holds the reference, for every cell: technique x roughness x angle."""
    held: dict[str, list[np.ndarray]] = {"mean": [], "variance": []}
    for seed in range(seeds):
        scene = {
            "model": "eon",
            "techniques": ["cosine", "uniform", "ltc-nonnegative", "cltc-mis"],
            "parameters": {"roughness": ROUGHNESS},
            "theta_o_deg": ANGLES,
            "statistics": ["mean", "variance"],
            "estimator": {"method": "mc", "samples": samples, "seed": 1000 + seed},
        }
        series = compute_statistics(resolve(parse_scene(scene), engine.catalogue), engine)["series"]
        for name in held:
            value, error = (np.array([one[key] for one in series], float) for key in (name, f"{name}_stderr"))
            truth = np.array([one["reference"][name] for one in series], float)
            held[name].append(np.abs(value - truth) <= NORMAL_95 * error)
    return {name: np.mean(rows, axis=0) for name, rows in held.items()}


def calibrate(engine: Engine, seeds: int, samples: int = 1_000_000) -> dict[str, float]:
    """Print and return the share of intervals that hold the reference, over all cells and seeds, up to 89 degrees."""
    found = coverage(engine, seeds, samples)
    shares = {name: float(np.mean(cells)) for name, cells in found.items()}
    cells = found["mean"].size
    print(f"95 % intervals that hold the reference, {cells} cells up to 89 degrees, {seeds} seeds, {samples:,} samples")
    for name, share in shares.items():
        print(f"{name:<10}{share:8.2%}   by cell {np.min(found[name]):.1%} to {np.max(found[name]):.1%}")
    return shares
