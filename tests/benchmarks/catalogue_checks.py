"""The battery over the whole catalogue: `python -m tests.benchmarks.catalogue_checks [--quick] [MODEL ...]`.

Prints what fails of every model and technique beside what must fail; exits with 1 where they differ.
"""

from __future__ import annotations

import argparse
import sys
import time

from service.catalogue import load_catalogue
from service.checks.battery import Battery, run_battery
from service.checks.selection import select
from service.engine import Engine
from tests.service.checks.expected_findings import expected, pairs


def main() -> int:
    """Run every pair; 1 where one fails other checks than it must, or its edge grid fails."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--quick", action="store_true", help="lower power: faults may be missed, none invented")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("models", nargs="*", help="only these")
    given = options.parse_args()
    catalogue = load_catalogue()
    chosen = [pair for pair in pairs(catalogue) if not given.models or pair[0] in given.models]
    wrong, battery = 0, Battery(given.seed, given.quick)
    with Engine.open(catalogue) as engine:
        for model, technique in chosen:
            begin, cpu = time.perf_counter(), time.process_time()
            result = run_battery(engine, select(technique, catalogue, model, [technique]), battery)
            failed = {check["name"] for check in result["checks"] if check["status"] == "fail"}
            if result["stability"]:
                failed |= {check["name"] for check in result["stability"]["checks"] if check["status"] == "fail"}
            must = expected(model, technique)
            invented, missed = failed - must, set() if given.quick else must - failed
            wrong += bool(invented or missed)
            print(
                f"{model:<20} {technique:<22} {time.perf_counter() - begin:5.1f} s {time.process_time() - cpu:5.1f} s"
                f" CPU  {', '.join(sorted(failed)) or 'nothing'}"
                + (f"  FALSE: {', '.join(sorted(invented))}" if invented else "")
                + (f"  MISSED: {', '.join(sorted(missed))}" if missed else ""),
                flush=True,
            )
    print(f"{len(chosen) - wrong} of {len(chosen)} pairs fail what they must and nothing else")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
