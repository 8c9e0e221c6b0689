"""The recorded ratios to the peers, so that a change that slows a technique shows on any machine of the same kind.

Ratios are of CPU time, which other work on the machine hardly moves, and of programs that run in turn. The median over
the peers keeps one that is updated, or has a bad day, from deciding.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from statistics import median

FILE = Path(__file__).with_name("recorded.json")
TOLERATED = 0.9
"""A technique counts as slower below this share of its recorded ratios."""

Ratios = Mapping[str, Mapping[str, float]]
"""Times as fast as a peer, by peer and technique."""


def against_record(measured: Ratios, recorded: Ratios) -> dict[str, float]:
    """How fast each technique is beside its record: the median over the peers that both have, 1 where it is as fast."""
    common = [peer for peer in measured if peer in recorded]
    techniques = [name for name in next(iter(measured.values()), {}) if all(name in recorded[peer] for peer in common)]
    return {
        name: median(measured[peer][name] / recorded[peer][name] for peer in common) for name in techniques if common
    }


def slower(measured: Ratios, recorded: Ratios) -> dict[str, float]:
    """The techniques that have become slower by more than is tolerated, as `against_record` has them."""
    return {name: share for name, share in against_record(measured, recorded).items() if share < TOLERATED}


def compare(measured: Ratios, device: str, file: Path = FILE) -> tuple[list[str], bool]:
    """Lines to print about a run on this device, and whether a technique has become slower."""
    record = json.loads(file.read_text())
    if record["device"] != device:
        return [f"recorded on {record['device']}: not compared"], False
    lines = [f"{'beside the recorded ratios':<28}" + _row(against_record(measured, record["ratios"]))]
    fallen = slower(measured, record["ratios"])
    lines += [f"SLOWER: {name} has {share:.2f} of its recorded speed" for name, share in fallen.items()]
    return lines, bool(fallen)


def save(measured: Ratios, device: str, file: Path = FILE) -> None:
    """Make these ratios the recorded ones."""
    rounded = {peer: {name: round(ratio, 3) for name, ratio in row.items()} for peer, row in measured.items()}
    file.write_text(json.dumps({"device": device, "ratios": rounded}, indent=1) + "\n")


def _row(shares: Mapping[str, float]) -> str:
    return "".join(f"{share:>17.2f}" for share in shares.values())
