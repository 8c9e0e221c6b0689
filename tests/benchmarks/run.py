"""make bench: EON statistics on lavapipe beside NumPy, Numba, Dr.Jit and C++, in one run.

Every peer first has to give the same means and variances as the float64 reference. Then all run in turn, round after
round; a ratio is the median of the rounds' ratios, and is compared with the recorded one: exit code 1 where a technique
has become more than 10 % slower against the peers. Then the time to an error of a thousandth, by sampling and by the
quadrature, how time and memory grow, whether intervals hold what they say, and whether the battery raises false alarms.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import growth
import recorded
from calibration import calibrate
from false_alarms import count, describe
from install import OUT, Peer, peers
from variants import variants

from service.engine import Engine
from service.estimators.quadrature import quadrature
from service.estimators.sampled import open_sampler
from service.left_out import features_left_out, structure_without
from service.moments import from_power_sums
from service.reference_store import plan_reference
from service.scene import Question, SeriesPlan, parse_scene, resolve
from service.statistics import series_cells

TECHNIQUES = ("cosine", "uniform", "ltc-nonnegative", "ltc", "cltc", "cltc-mis")
CONVERGENT = ("cosine", "uniform", "ltc-nonnegative", "cltc-mis")
ANGLES = 64
ERROR = 1e-3
OURS = "samplerscope (lavapipe)"


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--rounds", type=int, default=7)
    options.add_argument("--samples", type=int, default=1 << 20, help="for each of the 64 angles")
    options.add_argument("--seeds", type=int, default=60, help="of the calibration of intervals")
    options.add_argument("--ratios-only", action="store_true", help="nothing after the comparison with the peers")
    options.add_argument("--record", action="store_true", help="make the measured ratios the recorded ones")
    options.add_argument("--batteries", type=int, default=12, help="seeds of the battery on correct samplers")
    given = options.parse_args()
    with Engine.open() as engine:
        scene = {"model": "eon", "parameters": {"roughness": 1}, "techniques": list(TECHNIQUES)}
        question = resolve(parse_scene({**scene, "theta_o_deg": {"count": ANGLES}}), engine.catalogue)
        print(f"{engine.device.info.name}, {engine.device.info.driver_version}, {len(os.sched_getaffinity(0))} cores")
        print(f"EON at roughness 1, {ANGLES} angles, {given.samples:,} samples each, {given.rounds} rounds in turn\n")
        report = {"rates": rates(engine, question, given.samples, given.rounds)}
        fallen = compare_with_record(report["rates"]["cpu_ratios"], engine.device.info.name, given.record)
        if not given.ratios_only:
            report |= the_rest(engine, question, report["rates"], given)
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "bench.json").write_text(json.dumps(report, indent=1) + "\n")
    sys.exit(1 if fallen else 0)


def the_rest(engine: Engine, question: Question, measured: dict, given: argparse.Namespace) -> dict:
    """All that follows the rates: see the head of this file."""
    report = {"to_error": time_to_error(engine, question, measured)}
    growth.write(growth.growth(engine))
    report["calibration"] = calibrate(engine, given.seeds)
    begin = time.perf_counter()
    alarms, runs = count(engine, range(1, given.batteries + 1))
    print("\n" + describe(alarms, runs, time.perf_counter() - begin))
    report["false_alarms"] = {"alarms": dict(alarms), "batteries": runs}
    report["variants"] = variants(engine)
    return report


def compare_with_record(ratios: dict[str, dict[str, list[float]]], device: str, record: bool) -> bool:
    """Whether a technique has become slower; or, to `record`, keep the median ratios."""
    medians = {peer: {name: quartiles[1] for name, quartiles in row.items()} for peer, row in ratios.items()}
    if record:
        recorded.save(medians, device)
        return False
    lines, fallen = recorded.compare(medians, device)
    print("\n".join(lines) + "\n")
    return fallen


class Program:
    """A running peer: one line in, one line out."""

    def __init__(self, peer: Peer) -> None:
        self.process = subprocess.Popen(
            peer.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **dict(peer.environment)},
            cwd=Path(__file__).parent / "peers",
        )

    def ask(self, technique: str, samples: int, seed: int, angles: list[float]) -> tuple[float, float, np.ndarray]:
        """Seconds elapsed and of all cores, and sums of (weight - 1)^k with the largest weight, shape (angles, 5)."""
        busy = cpu_seconds(self.process.pid)
        text = " ".join([technique, "1.0", str(samples), str(seed), *(repr(angle) for angle in angles)])
        sent, received = pipes(self.process)
        sent.write(text + "\n")
        sent.flush()
        line = received.readline()
        if not line:
            raise RuntimeError("the peer ended")
        try:
            answer = json.loads(line)
        except json.JSONDecodeError:
            raise RuntimeError(f"its sums of {technique} are not finite") from None
        return answer["seconds"], cpu_seconds(self.process.pid) - busy, np.array(answer["powers"])


def cpu_seconds(process: int) -> float:
    """What the threads of a process have computed so far, all together."""
    statistics = Path(f"/proc/{process}/task").glob("*/schedstat")
    return sum(int(file.read_text().split()[0]) for file in statistics) / 1e9


def pipes(process: subprocess.Popen[str]) -> tuple[IO[str], IO[str]]:
    assert process.stdin is not None
    assert process.stdout is not None
    return process.stdin, process.stdout


@contextmanager
def started(peer: Peer) -> Iterator[Program]:
    program = Program(peer)
    try:
        yield program
    finally:
        for pipe in pipes(program.process):
            pipe.close()
        program.process.wait(timeout=30)


def rates(engine: Engine, question: Question, samples: int, rounds: int) -> dict:
    """Samples a second of every program and technique, and our rate over each peer's, round by round."""
    angles = [math.radians(angle) for angle in question.scene.angles_deg]
    seconds: dict[str, dict[str, list[float]]] = {OURS: {name: [] for name in TECHNIQUES}}
    busy: dict[str, dict[str, list[float]]] = {OURS: {name: [] for name in TECHNIQUES}}
    with ExitStack() as stack:
        samplers = {}
        for plan in question.series:
            cells = series_cells(plan, question.scene)
            structure = structure_without(features_left_out(plan, question.scene))
            opened = open_sampler(plan, engine, cells, structure, sobol=False)
            samplers[plan.technique.name] = stack.enter_context(opened)[0]
        running: dict[str, Program] = {}
        for peer in peers():
            try:
                if peer.missing:
                    raise RuntimeError(peer.missing)
                program = stack.enter_context(started(peer))
                for plan in question.series:
                    check(engine, question, plan, program.ask(plan.technique.name, samples, 1, angles)[2], samples)
                running[peer.name] = program
                seconds[peer.name], busy[peer.name] = ({name: [] for name in TECHNIQUES} for _ in range(2))
            except RuntimeError as error:
                print(f"{peer.name}: not measured: {error}")
        for number in range(rounds):
            for technique in TECHNIQUES:
                begin, used = time.perf_counter(), time.process_time()
                samplers[technique].run(samples)
                seconds[OURS][technique].append(time.perf_counter() - begin)
                busy[OURS][technique].append(time.process_time() - used)
                for name, program in running.items():
                    spent = program.ask(technique, samples, 2 + number, angles)
                    seconds[name][technique].append(spent[0])
                    busy[name][technique].append(spent[1])
    report = table(seconds, samples)
    report["cpu_ratios"] = ratios(busy)
    print_ratios("the same by CPU time", report["cpu_ratios"])
    return report


def check(engine: Engine, question: Question, plan: SeriesPlan, powers: np.ndarray, samples: int) -> None:
    """Refuse a peer whose mean or variance is more than 6 of the reference's standard errors off at any angle.

    Variances are compared where the kurtosis is below 1000: beyond, so few samples know nothing of them.
    """
    if not np.all(np.isfinite(powers)):
        raise RuntimeError(f"its sums of {plan.technique.name} are not finite")
    known = plan_reference(plan, question.scene.angles_deg, engine)
    count = np.full(len(powers), samples)
    found = from_power_sums(count, np.ones(len(powers)), powers[:, :4].T)
    mean, variance, fourth = (np.array([getattr(k, n) for k in known]) for n in ("mean", "variance", "fourth_moment"))
    spread = np.where(np.isfinite(variance), variance, found.variance)
    if np.any(np.abs(found.mean - mean) > 6 * np.sqrt(spread / samples) + 1e-6):
        raise RuntimeError(f"its mean weight of {plan.technique.name} is not the reference's")
    usable = np.isfinite(fourth)
    usable[usable] = fourth[usable] < 1e3 * variance[usable] ** 2
    off = np.abs(found.variance[usable] - variance[usable])
    if np.any(off > 6 * np.sqrt((fourth[usable] - variance[usable] ** 2) / samples)):
        raise RuntimeError(f"its variance of {plan.technique.name} is not the reference's")


def table(seconds: dict[str, dict[str, list[float]]], samples: int) -> dict:
    total = samples * ANGLES / 1e6
    print(f"{'million samples a second':<28}" + "".join(f"{name:>17}" for name in TECHNIQUES))
    for name, times in seconds.items():
        print(f"{name:<28}" + "".join(f"{total / np.median(times[t]):>17.0f}" for t in TECHNIQUES))
    report = {"samples": samples, "seconds": seconds, "ratios": ratios(seconds)}
    print_ratios("times as fast as the peer", report["ratios"])
    return report


def ratios(times: dict[str, dict[str, list[float]]]) -> dict[str, dict[str, list[float]]]:
    """Quartiles over the rounds of each peer's time over ours."""
    found: dict[str, dict[str, list[float]]] = {}
    for name in (peer for peer in times if peer != OURS):
        each = {t: np.array(times[name][t]) / np.array(times[OURS][t]) for t in TECHNIQUES}
        found[name] = {t: np.quantile(ratio, [0.25, 0.5, 0.75]).tolist() for t, ratio in each.items()}
    return found


def print_ratios(title: str, found: dict[str, dict[str, list[float]]]) -> None:
    print(f"\n{title:<28}" + "".join(f"{name:>17}" for name in TECHNIQUES))
    for name, row in found.items():
        cells = [f"{middle:.2f} ({low:.2f}-{high:.2f})" for low, middle, high in row.values()]
        print(f"{name:<28}" + "".join(f"{cell:>17}" for cell in cells))


def time_to_error(engine: Engine, question: Question, measured: dict) -> dict:
    """Seconds until the variance of all angles is known to ERROR: by sampling, each angle as long as it needs, at the
    rates above, and by the quadrature, which is run."""
    report: dict[str, dict] = {}
    print(f"seconds until the variance of each of {ANGLES} angles has a relative error of {ERROR:g}")
    names = list(measured["seconds"])
    print(f"{'':<18}{'quadrature':>12}{'device':>10}{'worst error':>14}" + "".join(f"{name:>26}" for name in names))
    device = 0.0
    for plan in question.series:
        technique = plan.technique.name
        known = plan_reference(plan, question.scene.angles_deg, engine)
        variance = np.array([cell.variance for cell in known])
        finite = np.isfinite(variance)
        estimator = parse_scene({"model": "eon", "estimator": {"method": "quadrature", "tolerance": ERROR}}).estimator
        runs = []
        for _ in range(5):
            begin = time.perf_counter()
            found = quadrature(plan, engine, series_cells(plan, question.scene), estimator, finite, with_variance=True)
            runs.append((found.device_ns / 1e9, time.perf_counter() - begin))
        spent, elapsed = np.median([run[0] for run in runs]), np.median([run[1] for run in runs])
        device += spent
        if technique not in CONVERGENT:
            continue
        worst = float(np.max(np.abs(found.statistics.variance / variance - 1)))
        needed = sum(cell.fourth_moment / cell.variance**2 - 1 for cell in known) / ERROR**2
        total = measured["samples"] * ANGLES
        sampled = {name: float(needed * np.median(measured["seconds"][name][technique]) / total) for name in names}
        report[technique] = {"quadrature_s": elapsed, "device_s": spent, "worst_error": worst, "sampled_s": sampled}
        print(
            f"{technique:<18}{elapsed:>12.3f}{spent:>10.4f}{worst:>14.1e}"
            + "".join(f"{sampled[name]:>26.1f}" for name in names)
        )
    sums = {name: math.fsum(row["sampled_s"][name] for row in report.values()) for name in names}
    rule = math.fsum(row["device_s"] for row in report.values())
    print(
        f"\nvariance of the four convergent techniques: quadrature {1e3 * rule:.0f} ms of device time, mc on the same"
    )
    print(f"device {sums[OURS]:.0f} s: {sums[OURS] / rule:,.0f} times as long")
    print(f"the whole six-technique figure by quadrature: {1e3 * device:.0f} ms of device time\n")
    return {"techniques": report, "device_s_of_six": device, "ratio_to_mc": sums[OURS] / rule}


if __name__ == "__main__":
    main()
