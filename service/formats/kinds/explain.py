"""What shaders leave out, as terminal text and CSV."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

_WIDTH = 120
_NAME = 40


def rows(result: Mapping[str, Any]) -> tuple[list[str], Iterator[list[Any]]]:
    """A row for each feature of each shader."""
    columns = [
        *("model", "technique", "feature", "reason"),
        *("saves_ns_per_sample", "interval_low_ns", "interval_high_ns", "saves_instructions"),
    ]

    def each() -> Iterator[list[Any]]:
        for shader in result["shaders"]:
            for one in shader["left_out"]:
                saves = one["saves"]
                head = [shader["model"], shader["technique"], one["feature"], one["reason"]]
                yield [*head, saves["ns_per_sample"], *saves["interval"], saves["instructions"]]

    return columns, each()


def text(result: Mapping[str, Any]) -> str:
    """Each shader beside the one that keeps everything, and what each feature alone saves of that."""
    run = result["run"]
    lines = [
        "ns a sample takes of one driver thread: median (quartiles)",
        "what leaving one feature out saves of the full shader: median, with its 95 % interval",
        "",
    ]
    for shader in result["shaders"]:
        lines += _shader(shader, len(result["series"]))
    if len(result["shaders"]) > 1:
        lines += ["on average over all series", *_figures(result), ""]
    lines += [
        f"device    {run['device']}",
        f"time      {run['elapsed_ms'] / 1e3:.1f} s, {run['rounds']} interleaved rounds of"
        f" {run['samples_per_round']:,} samples a shader, by the clock of the {run['clock']}",
    ]
    return "\n".join(lines) + "\n"


def _shader(shader: Mapping[str, Any], series: int) -> list[str]:
    count = len(shader["series"])
    which = "" if count == series else f", {count} of {series} series"
    lines = [f"{shader['model']} with {shader['technique']}{which}", *_figures(shader)]
    speedup = shader["speedup"]
    if speedup is not None:
        low, high = speedup["quartiles"]
        lines.append(f"  {speedup['median']:.2f} times as fast (quartiles {low:.2f} to {high:.2f})")
    lines += ["", f"  {'left out':<{_NAME}}{'saves ns':>9}{'interval':>18}{'instructions':>14}  because"]
    for one in shader["left_out"]:
        saves = one["saves"]
        low, high = saves["interval"]
        line = (
            f"  {one['feature']:<{_NAME}}{saves['ns_per_sample']:>9.3f}{f'{low:.3f} to {high:.3f}':>18}"
            f"{saves['instructions']:>14,}  "
        )
        first, *rest = textwrap.wrap(one["reason"], _WIDTH - len(line))
        lines += [line + first, *(" " * len(line) + more for more in rest)]
    return [*lines, ""]


def _figures(figures: Mapping[str, Any]) -> list[str]:
    names = ("module_bytes", "spirv_bytes", "instructions", "compile_ms", "ns_per_sample")
    lines = [f"  {'':<12}" + "".join(f"{name.replace('_', ' '):>16}" for name in names)]
    for which in ("variant", "full"):
        one = figures[which]
        quartiles = ""
        if "quartiles" in one:
            quartiles = " ({:.3f} to {:.3f})".format(*one["quartiles"])
        sizes = "".join(f"{one[name]:>16,}" for name in names[:3])
        lines.append(f"  {which:<12}{sizes}{one['compile_ms']:>16.1f}{one['ns_per_sample']:>16.3f}{quartiles}")
    return lines
