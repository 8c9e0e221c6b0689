"""Made-up results of kind "statistics": plausible numbers for EON, with the awkward cells that real runs have."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

# technique -> (variance at normal incidence, rise towards grazing, largest weight at normal incidence, its rise)
_SHAPES = {
    "cosine": (0.11, 140.0, 1.9, 55.0),
    "uniform": (0.45, 3.5, 2.4, 4.0),
    "ltc-nonnegative": (0.09, 18.0, 2.0, 20.0),
    "ltc": (0.12, 2.2, 2.6, 30.0),
    "cltc": (0.06, 1.6, 2.2, 35.0),
    "cltc-mis": (0.08, 0.7, 1.7, 2.6),
}
TECHNIQUES = tuple(_SHAPES)
DEVICE = "llvmpipe (LLVM 15.0.6, 256 bits)"


def paper_angles(count: int) -> list[float]:
    return [90 * 0.999 * index / max(count - 1, 1) for index in range(count)]


def one_series(
    technique: str, theta_o_deg: list[float], roughness: float = 1.0, samples: int = 1_000_000, **parameters: float
) -> dict[str, Any]:
    start, rise, top, top_rise = _SHAPES.get(technique, (0.2, 2.0, 2.0, 3.0))
    grazing = [(theta / 90) ** 6 for theta in theta_o_deg]
    noise = [1 + 0.04 * math.sin(41 * g + 7 * len(technique) + k) for k, g in enumerate(grazing)]
    truth = [roughness**2 * start * (1 + rise * g) for g in grazing]
    variance = [value * factor for value, factor in zip(truth, noise, strict=True)]
    supremum = [1 + roughness * (top - 1) * (1 + top_rise * g) for g in grazing]
    mean_stderr = [math.sqrt(value / samples) for value in variance]
    return {
        "model": "eon",
        "technique": technique,
        "parameters": {"roughness": roughness, "albedo": 1.0, **parameters},
        "theta_o_deg": list(theta_o_deg),
        "mean": [1 + 30 * error * (factor - 1) for error, factor in zip(mean_stderr, noise, strict=True)],
        "mean_stderr": mean_stderr,
        "variance": variance,
        "variance_stderr": [value * 0.04 for value in variance],
        "max_weight": [1 + (value - 1) * 0.8 for value in supremum],
        "zero_fraction": [0.0 if technique != "ltc" else 0.2 * g for g in grazing],
        "nonfinite": [0] * len(theta_o_deg),
        "samples": samples,
        "reference": {
            "mean": [1.0] * len(theta_o_deg),
            "albedo": [1.0] * len(theta_o_deg),
            "variance": truth,
            "variance_stderr": [value * 1e-6 for value in truth],
            "max_weight": supremum,
        },
        "verdict": {"status": "ok", "findings": []},
        "device_ms": 12.3 + len(technique),
    }


def make_infinite(series: dict[str, Any], first: int, tail: bool = True) -> dict[str, Any]:
    """Give the angles from index `first` on an infinite variance and an unbounded weight."""
    count = len(series["theta_o_deg"])
    for index in range(first, count):
        series["variance_stderr"][index] = None
        if series["reference"]:
            series["reference"]["variance"][index] = series["reference"]["max_weight"][index] = None
            series["reference"]["variance_stderr"][index] = None
    evidence: dict[str, Any] = {"theta_o_deg": series["theta_o_deg"][-1]}
    if tail:
        evidence["tail_strength"] = [None if index < first else 0.125 + 0.001 * index for index in range(count)]
    name, angle = "infinite-variance", series["theta_o_deg"][-1]
    message = f"the variance is infinite from theta_o {series['theta_o_deg'][first]:.2f} to {angle:.2f} degrees"
    series["verdict"] = {"status": name, "findings": [{"name": name, "message": message, "evidence": evidence}]}
    return series


def a_result(series: list[dict[str, Any]], **estimator: Any) -> dict[str, Any]:
    return {
        "kind": "statistics",
        "scene": {
            "model": "eon",
            "techniques": list(dict.fromkeys(one["technique"] for one in series)),
            "estimator": {"method": "mc", "samples": 1_000_000, "seed": 3, **estimator},
        },
        "series": series,
        "left_out": [{"feature": "multiple-scattering lobe", "reason": "roughness is 0"}],
        "run": {
            "device": DEVICE,
            "driver": "Mesa 22.3.6",
            "compile_ms": 81.25,
            "device_ms": 96.5,
            "elapsed_ms": 240.75,
        },
    }


def six_techniques(count: int = 64) -> dict[str, Any]:
    """Return the scene of the paper's figure of all techniques, two of them with an infinite variance near grazing."""
    angles = paper_angles(count)
    series = [one_series(name, angles) for name in TECHNIQUES]
    if count > 1:
        make_infinite(series[3], count * 2 // 3)
        make_infinite(series[4], 0)
    return a_result(series)


def roughness_sweep(values: tuple[float, ...] = (0.0, 0.25, 0.5, 0.75, 1.0), count: int = 64) -> dict[str, Any]:
    angles = paper_angles(count)
    return a_result([one_series(name, angles, r) for r, name in product(values, ("cosine", "cltc-mis"))])


def awkward() -> dict[str, Any]:
    """Return nulls, zeros, no reference, no error bars, non-finite samples, one angle fewer of everything sure."""
    angles = [0.0, 45.0, 89.99]
    plain = one_series("cosine", angles)
    plain["reference"] = None
    del plain["mean_stderr"], plain["variance_stderr"]
    nulls = one_series("uniform", angles)
    nulls["mean"][1] = nulls["variance"][1] = nulls["max_weight"][1] = nulls["mean_stderr"][1] = None
    nulls["variance_stderr"][1] = None
    nulls["nonfinite"] = [0, 17, 2]
    finding = {"name": "nonfinite", "message": "19 samples are NaN or infinite", "evidence": {"theta_o_deg": 45.0}}
    nulls["verdict"] = {"status": "nonfinite", "findings": [finding]}
    zero = one_series("made-by-hand", angles, roughness=0.0)
    endless = make_infinite(one_series("cltc", angles), 2, tail=False)
    endless["variance"][2] = None
    return a_result([plain, nulls, zero, endless])
