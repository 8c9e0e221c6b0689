"""The battery over one model and technique, and over what a file or a catalogue entry brings."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from service.checks import continuity, jacobian, model, points, sampled, tails
from service.checks.effort import FULL, QUICK
from service.checks.outcome import NAMES, Outcome
from service.checks.selection import Subject
from service.engine import Engine
from service.inputs import replay_command
from service.probe import Probe
from service.stability import survey_pair
from service.statistics import Progress


@dataclass(frozen=True)
class Battery:
    """How to run: the seed of everything random, and whether to be quick at lower power."""

    seed: int = 0
    quick: bool = False


def check_technique(probe: Probe, battery: Battery, progress: Progress = lambda *_: None) -> list[Outcome]:
    """Every check of a technique on a model, in the order of NAMES without those of the model alone."""
    effort = QUICK if battery.quick else FULL
    rng = np.random.default_rng(battery.seed)
    name = probe.technique.name
    progress(f"{name}: single values", 0, 4)
    drawn = points.draw_points(probe, effort.points, rng)
    out = [
        points.check_finite(probe, drawn),
        points.check_nonnegative(probe, drawn),
        points.check_unit_length(probe, drawn),
        points.check_hemisphere(probe, drawn),
        points.check_pdf_agreement(probe, drawn),
        jacobian.check_jacobian(probe, effort.points, rng),
        continuity.check_continuity(probe, effort.points, rng),
    ]
    progress(f"{name}: many directions", 1, 4)
    many = sampled.draw_and_integrate(probe, effort, battery.seed)
    out += [
        sampled.check_normalisation(probe, many),
        sampled.check_chi_square(probe, many),
        sampled.check_coverage(probe, many),
        sampled.check_unbiased(probe, many),
    ]
    progress(f"{name}: large weights", 2, 4)
    found = tails.search(probe, effort, rng)
    out += [tails.check_tail(probe, found), tails.check_supremum(probe, found)]
    progress(f"{name}: done", 4, 4)
    return sorted(out, key=lambda outcome: NAMES.index(outcome.name))


def check_model(probe: Probe, battery: Battery) -> list[Outcome]:
    """The checks of the model alone; the probe's technique takes no part."""
    effort = QUICK if battery.quick else FULL
    rng = np.random.default_rng(battery.seed + 1)
    return [
        model.check_reciprocity(probe, effort.points, rng),
        model.check_energy(probe, effort, rng),
    ]


def run_battery(
    engine: Engine, subject: Subject, battery: Battery, progress: Progress = lambda *_: None
) -> dict[str, Any]:
    """A result of kind `check`: the model's own checks once, those of techniques for each.

    Raises CompileError with the file's lines, ShaderFileError for code that cannot be widened to double,
    LoopLimitReached.
    """
    begin = time.perf_counter()
    probes = [Probe(engine, subject.model, technique, subject.fixed) for technique in subject.techniques]
    for probe in probes:
        progress(f"{probe.technique.name}: compiling", 0, 4)
        probe.compile()
    progress(f"{subject.model.name}: reciprocity and energy", 0, 4)
    checks = [outcome.as_data(None) for outcome in check_model(probes[0], battery)]
    for probe in probes:
        checks += [outcome.as_data(probe.technique.name) for outcome in check_technique(probe, battery, progress)]
    stability: dict[str, list[dict[str, Any]]] | None = None
    if not battery.quick:
        stability = {"regions": [], "exceptions": [], "stiffness": [], "checks": []}
        for done, technique in enumerate(subject.techniques):
            progress(f"{technique.name}: edge grid", 3, 4)
            given = {name: [value] for name, value in subject.fixed.items()}
            one = survey_pair(engine, subject.model, technique, given, first=done == 0)
            for name, items in one.items():
                stability[name] += items
    edges = stability["checks"] if stability else []
    for check in [*checks, *edges]:
        if check["replay"] is not None:
            check["replay"]["command"] = replay_command(subject.given, check["replay"], subject.catalogue)
    return {
        "kind": "check",
        "subject": subject.given,
        "model": subject.model.name,
        "techniques": [technique.name for technique in subject.techniques],
        "status": "fail" if any(check["status"] == "fail" for check in [*checks, *edges]) else "pass",
        "checks": checks,
        "stability": stability,
        "left_out": [],
        "run": engine.run_block(begin, seed=battery.seed, quick=battery.quick),
    }
