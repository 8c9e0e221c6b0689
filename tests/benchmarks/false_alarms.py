"""Counts false alarms of the quick battery on correct techniques: `python -m tests.benchmarks.false_alarms [SEEDS]`.

The stated rate of chance alarms is 3e-5 a battery run (three statistical checks at 1e-5); the battery must stay below
one alarm in 1,000 seeds. With no alarm in n runs, the rate is below 3/n at 95 % confidence.
"""

from __future__ import annotations

import sys
from collections import Counter

from service.catalogue import load_catalogue
from service.checks.battery import Battery, run_battery
from service.checks.selection import select
from service.engine import Engine

SOUND = ("cosine", "uniform", "ltc-nonnegative", "cltc-mis")


def main(seeds: int) -> int:
    """Run every sound technique on EON with each seed; the number of runs with an alarm."""
    catalogue = load_catalogue()
    alarms: Counter[str] = Counter()
    runs = 0
    with Engine.open(catalogue) as engine:
        for seed in range(1, seeds + 1):
            for technique in SOUND:
                result = run_battery(engine, select(technique, catalogue), Battery(seed=seed, quick=True))
                runs += 1
                failed = [check["name"] for check in result["checks"] if check["status"] == "fail"]
                alarms.update(failed)
                if failed:
                    print(f"seed {seed}, {technique}: {', '.join(failed)}", flush=True)
    total = sum(alarms.values())
    print(f"{total} alarms in {runs} runs" + (f"; rate below {3 / runs:.1e} at 95 % confidence" if not total else ""))
    return 1 if total > runs / 1000 else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 250))
