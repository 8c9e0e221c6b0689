"""Counts false alarms of the quick battery on correct samplers: `python -m tests.benchmarks.false_alarms [SEEDS]`.

The stated rate of chance alarms is 3e-5 a run (three statistical checks at 1e-5, a run is one technique at one seed);
the battery must stay below one alarm in 1,000. With no alarm in n runs, the rate is below 3/n at 95 % confidence.
"""

from __future__ import annotations

import sys
import time
from collections import Counter

from service.catalogue import load_catalogue
from service.checks.battery import Battery, check_model, check_technique
from service.engine import Engine
from service.probe import Probe

SOUND = {
    "eon": ("cosine", "uniform", "ltc-nonnegative", "cltc-mis"),
    "cook-torrance": ("beckmann-half-vector",),
    "ashikhmin-shirley": ("ashikhmin-shirley",),
    "blinn-phong": ("blinn-phong",),
    "ggx": ("ggx-vndf", "ggx-vndf-caps", "ggx-vndf-bounded"),
}
"""Models and techniques without a fault: of wide lobes, and of lobes down to a thousandth in width."""


def count(engine: Engine, seeds: range) -> tuple[Counter[str], int]:
    """Alarms by check, and the number of runs: every sound technique with each seed, its model's own checks once."""
    alarms: Counter[str] = Counter()
    runs = 0
    for seed in seeds:
        battery = Battery(seed=seed, quick=True)
        for model, techniques in SOUND.items():
            probes = [Probe(engine, engine.catalogue.model(model), engine.catalogue.technique(t)) for t in techniques]
            outcomes = [(model, outcome) for outcome in check_model(probes[0], battery)]
            for probe in probes:
                outcomes += [(f"{model}, {probe.technique.name}", one) for one in check_technique(probe, battery)]
                runs += 1
            for subject, outcome in outcomes:
                if outcome.status == "fail":
                    alarms[outcome.name] += 1
                    print(f"seed {seed}, {subject}: {outcome.name}: {outcome.message}", flush=True)
    return alarms, runs


def describe(alarms: Counter[str], runs: int, seconds: float) -> str:
    """One line: the count, the rate it bounds, and the time."""
    total = sum(alarms.values())
    bound = f"; rate below {3 / runs:.1e} at 95 % confidence" if not total else ""
    return f"{total} false alarms in {runs:,} quick batteries on correct samplers{bound} ({seconds:.0f} s)"


def main(seeds: int) -> int:
    """Count over so many seeds; 1 where more than one run in 1,000 has an alarm."""
    begin = time.perf_counter()
    with Engine.open(load_catalogue()) as engine:
        alarms, runs = count(engine, range(1, seeds + 1))
    print(describe(alarms, runs, time.perf_counter() - begin))
    return 1 if sum(alarms.values()) > runs / 1000 else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 100))
