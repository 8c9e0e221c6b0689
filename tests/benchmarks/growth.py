"""How time and memory grow: with samples from 2^16 to 2^32 an angle, and with angles from 1 to 4096.

Run alone (`python tests/benchmarks/growth.py`) or by `make bench`; writes out/bench/growth.json and growth.png.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import altair as alt
from install import OUT

from service.engine import Engine
from service.estimators.sampled import open_sampler
from service.figures import AnyChart, style
from service.formats.pictures import encode
from service.left_out import features_left_out, structure_without
from service.scene import parse_scene, resolve
from service.statistics import series_cells

TECHNIQUES = ("cosine", "cltc-mis")
SAMPLES = [1 << power for power in range(16, 33, 2)]
MOST_AT_ONCE = 1 << 30
"""Samples of 64 angles together; beyond, there are fewer angles, down to one."""
ANGLES = [1, 4, 16, 64, 256, 1024, 4096]
SAMPLES_AN_ANGLE = 1 << 16
SHORT_S = 0.5
"""A run shorter than this is repeated, five times in all, and the fastest counts."""


def growth(engine: Engine) -> dict:
    """Nanoseconds a sample, elapsed and of all cores together, and megabytes of the process, for each size."""
    found: dict[str, dict] = {}
    print("growth of mc, EON at default parameters: nanoseconds a sample, elapsed and CPU; megabytes of the process")
    for technique in TECHNIQUES:
        found[technique] = {
            "samples": [_measured(engine, technique, _angles_for(samples), samples) for samples in SAMPLES],
            "angles": [_measured(engine, technique, angles, SAMPLES_AN_ANGLE) for angles in ANGLES],
        }
    return found


def _angles_for(samples: int) -> int:
    return max(1, min(64, MOST_AT_ONCE // samples))


def _measured(engine: Engine, technique: str, angles: int, samples: int) -> dict:
    scene = parse_scene({"model": "eon", "techniques": [technique], "theta_o_deg": {"count": angles}})
    plan = resolve(scene, engine.catalogue).series[0]
    structure = structure_without(features_left_out(plan, scene))
    total, runs = angles * samples, []
    with open_sampler(plan, engine, series_cells(plan, scene), structure, sobol=False) as (sampler, _):
        while not runs or (runs[0][0] < SHORT_S and len(runs) < 5):
            elapsed, busy = time.perf_counter(), time.process_time()
            sampler.run(samples)
            runs.append((time.perf_counter() - elapsed, time.process_time() - busy))
        resident = _resident_mb()
    elapsed, busy = (min(run[i] for run in runs) for i in range(2))
    row = {"angles": angles, "samples": samples, "elapsed_ns": 1e9 * elapsed / total, "cpu_ns": 1e9 * busy / total}
    row["elapsed_s"], row["resident_mb"] = elapsed, resident
    print(
        f"{technique:<10}{angles:>6} angles x {samples:>13,} samples{elapsed:>9.3f} s"
        f"{row['elapsed_ns']:>9.2f}{row['cpu_ns']:>9.2f}{resident:>9.0f} MB",
        flush=True,
    )
    return row


def _resident_mb() -> float:
    status = Path("/proc/self/status").read_text()
    return next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS")) / 1024


def chart(found: dict) -> AnyChart:
    """CPU time a sample over samples and over angles, and memory over samples."""
    panels = (
        ("samples", "samples of each angle", "cpu_ns", "CPU time a sample (ns)"),
        ("angles", f"angles of {SAMPLES_AN_ANGLE:,} samples", "cpu_ns", "CPU time a sample (ns)"),
        ("samples", "samples of each angle", "resident_mb", "memory of the process (MB)"),
    )
    colours = [colour for colour, _ in style.technique_styles(list(found))]
    legend = alt.Color("technique:N", scale=alt.Scale(domain=list(found), range=colours), title=None)
    parts = []
    for sweep, size_title, value, title in panels:
        rows = [
            {"technique": name, sweep: row[sweep], value: row[value]} for name in found for row in found[name][sweep]
        ]
        ticks = alt.Axis(values=[row[sweep] for row in rows], labelExpr="'2^' + round(log(datum.value) / LN2)")
        x = alt.X(f"{sweep}:Q", title=size_title, scale=alt.Scale(type="log", base=2, nice=False), axis=ticks)
        top = 1.1 * max(row[value] for row in rows)
        y = alt.Y(f"{value}:Q", title=title, scale=alt.Scale(domain=[0, top], nice=False))
        line = alt.Chart(alt.InlineData(values=rows)).mark_line(point=True).encode(x=x, y=y, color=legend)
        parts.append(line.properties(width=1.3 * style.PANEL_WIDTH, height=style.PANEL_HEIGHT))
    whole: AnyChart = alt.hconcat(*parts).properties(
        title="Growth of mc: EON at default parameters", config=style.config()
    )
    return whole


def write(found: dict) -> None:
    """Numbers and picture into out/bench."""
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "growth.json").write_text(json.dumps(found, indent=1) + "\n")
    (OUT / "growth.png").write_bytes(encode(chart(found), "png"))
    print(f"written: {OUT / 'growth.png'}\n")


def main() -> None:
    with Engine.open() as engine:
        write(growth(engine))


if __name__ == "__main__":
    main()
