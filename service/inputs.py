"""Inputs of a probe: parameter settings and views to look at, and how a failure names its own for a replay."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.catalogue import Catalogue, Parameter
from service.probe import Probe

Array = NDArray[Any]
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True)
class Views:
    """Settings and views, one a row: wo (n, 3) float32 and parameters (n, p) float32; angles in radians, shape (n,)."""

    wo: Array
    parameters: Array
    theta_o: Array
    phi_o: Array

    def __len__(self) -> int:
        return len(self.wo)


def view_directions(theta_o: Array, phi_o: Array) -> Array:
    """wo of shape (n, 3), formed in double precision and rounded once."""
    sine = np.sin(theta_o)
    return np.stack([sine * np.cos(phi_o), sine * np.sin(phi_o), np.cos(theta_o)], axis=-1).astype(np.float32)


def settings(declared: Mapping[str, Parameter], count: int) -> Array:
    """Up to `count` rows of parameter values in float32: defaults, inner points, each range's ends alone, all ends."""
    columns = list(declared.values())
    default = [p.default for p in columns]
    rows = [default]
    if columns:
        inner = [
            [inner_value(p, (0.5 + _GOLDEN * (k + 1) * (2 * i + 1)) % 1.0) for i, p in enumerate(columns)]
            for k in range(count)
        ]
        ends = []
        for end in ("min", "max"):
            for i, p in enumerate(columns):
                ends.append([*default[:i], getattr(p, end), *default[i + 1 :]])
        ends += [[p.min for p in columns], [p.max for p in columns]]
        half = max(1, (count - 1) // 2)
        rows += inner[: count - 1 - half] + ends[:half] + inner[count - 1 - half :] + ends[half:]
    unique = list(dict.fromkeys(tuple(row) for row in rows))[:count]
    return np.array(unique, np.float32).reshape(len(unique), len(columns))


def random_settings(
    declared: Mapping[str, Parameter], count: int, rng: np.random.Generator, at_ends: float = 0.25
) -> Array:
    """Random rows: each value is at an end of its range with probability `at_ends`, else inside."""
    out = np.empty((count, len(declared)), np.float32)
    for i, p in enumerate(declared.values()):
        inside = np.array([inner_value(p, x) for x in rng.random(count)])
        pick = rng.random(count)
        out[:, i] = np.where(pick < 0.5 * at_ends, p.min, np.where(pick < at_ends, p.max, inside))
    return out


def inner_value(p: Parameter, x: float) -> float:
    """The value at the share x of a range, in logarithms where the range spans more than two decades."""
    if p.min > 0 and p.max / p.min > 100:
        return p.min * math.exp(x * math.log(p.max / p.min))
    if p.min == 0 and p.max > 100:
        return math.expm1(x * math.log1p(p.max))
    return p.min + x * (p.max - p.min)


def views_of(probe: Probe, theta_o_deg: Sequence[float], rows: int) -> Views:
    """All views at each of some settings; the azimuths differ, so that no check only sees a view in the x-z plane."""
    values = settings(probe.declared, rows)
    theta = np.radians(np.tile(np.asarray(theta_o_deg, float), len(values)))
    phi = 2 * np.pi * ((0.137 + _GOLDEN * np.arange(len(theta))) % 1.0)
    return Views(view_directions(theta, phi), np.repeat(values, len(theta_o_deg), axis=0), theta, phi)


def bits(values: Array) -> list[str]:
    """Float32 bit patterns as hexadecimal text."""
    return [f"0x{word:08x}" for word in np.atleast_1d(np.asarray(values, np.float32)).view(np.uint32)]


def replay(
    probe: Probe, wo: Array, parameters: Array, *, u: Array | None = None, wi: Array | None = None
) -> dict[str, Any]:
    """The exact inputs of one evaluation, as they go into a report."""
    wo = np.asarray(wo, np.float32).ravel()
    theta = math.degrees(math.atan2(math.hypot(float(wo[0]), float(wo[1])), float(wo[2])))
    out: dict[str, Any] = {
        "model": probe.model.name,
        "technique": probe.technique.name,
        "parameters": dict(zip(probe.names, np.asarray(parameters, np.float32).ravel().tolist(), strict=True)),
        "theta_o_deg": theta,
        "phi_o_deg": math.degrees(math.atan2(float(wo[1]), float(wo[0]))),
        "wo_bits": bits(wo),
    }
    if u is not None:
        out["u_bits"] = bits(np.clip(np.asarray(u, np.float64), 0, 1 - 2.0**-24))
    if wi is not None:
        out["wi_bits"] = bits(wi)
    return out


def replay_command(given: str, inputs: Mapping[str, Any], catalogue: Catalogue) -> str:
    """The command that evaluates a model and technique at exact inputs.

    `given` is a file or a catalogue name; other files of the user's are called by their paths.
    """
    model, technique = catalogue.model(inputs["model"]), catalogue.technique(inputs["technique"])
    names = [entry.origin if entry.own and entry.origin != given else entry.name for entry in (model, technique)]
    words = ["samplerscope", "check", given, "--model", names[0], "--technique", names[1]]
    for name, value in inputs["parameters"].items():
        words += ["--set", f"{name}={value!r}"]
    for name in ("wo", "u", "wi"):
        if f"{name}_bits" in inputs:
            words += [f"--{name}", ",".join(inputs[f"{name}_bits"])]
    return shlex.join(words)
