"""What calls cost, in the formats that a table has."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from service.formats.table_summary import run_lines

Result = Mapping[str, Any]
_COLUMNS = ("model", "technique", "task", "call_ns", "empty_ns", "paper_ns")


def rows(result: Result) -> tuple[list[str], Iterator[list[Any]]]:
    """The columns and one row for each loop that was timed."""
    columns = [*_COLUMNS, "quartile_low_ns", "quartile_high_ns"]
    return columns, ([*(row[name] for name in _COLUMNS), *row["call_ns_quartiles"]] for row in result["rows"])


def text(result: Result) -> str:
    """The table for a terminal: ns a call on one driver thread, with quartiles, beside the paper's."""
    run = result["run"]
    widths = [max(len(row[name] or "-") for row in result["rows"]) + 2 for name in ("model", "technique")]
    lines = [
        f"ns a call on one driver thread, inputs random in every call; median (quartiles) of {run['repeats']} repeats",
        f"paper: {result['source']}, one thread of an AMD 3970X",
        "",
        f"{'model':<{widths[0]}}{'technique':<{widths[1]}}{'task':<8}{'ns':>8}   {'quartiles':<16}{'paper':>8}",
    ]
    for row in result["rows"]:
        low, high = row["call_ns_quartiles"]
        paper = "-" if row["paper_ns"] is None else f"{row['paper_ns']:.1f}"
        name = row["technique"] or "-"
        spread = f"{low:.1f} to {high:.1f}"
        names = f"{row['model']:<{widths[0]}}{name:<{widths[1]}}"
        lines.append(f"{names}{row['task']:<8}{row['call_ns']:>8.1f}   {spread:<16}{paper:>8}")
    empty = [row["empty_ns"] for row in result["rows"]]
    lines += [
        "",
        f"the empty loop, random inputs alone, took {min(empty):.1f} to {max(empty):.1f} ns a call; it is subtracted",
        "sample: sample_direction and the weight; the paper's CLTC sample is cltc-mis",
        "",
        run_lines(result, 120),
    ]
    return "\n".join(lines) + "\n"
