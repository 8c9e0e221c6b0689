"""Load on the HTTP service, on loopback: cached answers, 304s, small fresh scenes, and all of it beside a huge job.

python -m tests.benchmarks.http_load [SECONDS_PER_ROUND]

Rounds are interleaved, so that what else the machine does falls on all of them alike. What a fresh scene costs above
its device time comes from the same requests: client's time less the device's own, from Server-Timing.
"""

from __future__ import annotations

import asyncio
import itertools
import os
import re
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import uvloop

from tests.benchmarks.http_client import Connection, timed
from tests.service.api.http_server import Server

ROUNDS = 5
CONNECTIONS = 8
SCENE = "/v1/statistics?model=eon&roughness=0.5&techniques=cltc-mis&angles=8&samples=16384"
HUGE = "/v1/statistics?model=eon&roughness=1&angles=64&samples=1000000000"


def fresh(start: int) -> Iterator[str]:
    """Links that were never asked: the same small scene with new seeds, the reference left out."""
    return (f"{SCENE}&reference=false&seed={seed}" for seed in itertools.count(start))


async def overhead(connection: Connection, paths: Iterator[str], count: int) -> list[tuple[float, float]]:
    """(milliseconds of the client, milliseconds of the device) of fresh scenes, one after the other."""
    found = []
    for _ in range(count):
        begin = time.perf_counter()
        status, headers, _ = await connection.get(next(paths))
        taken = 1e3 * (time.perf_counter() - begin)
        assert status == 200, status
        device = re.search(r"device;dur=([\d.]+)", headers["server-timing"])
        assert device is not None
        found.append((taken, float(device.group(1))))
    return found


def line(name: str, taken: list[float], seconds: float) -> str:
    """Requests a second, median and 99th percentile."""
    cuts = statistics.quantiles(taken, n=100)
    return f"{name:<34}{len(taken) / seconds:>10.0f}/s{cuts[49]:>9.2f}{cuts[98]:>9.2f}"


async def run(port: int, seconds: float) -> None:
    """All rounds, and a table of them."""
    connections = [await Connection.open(port) for _ in range(CONNECTIONS)]
    first = connections[0]
    _, headers, _ = await first.get(f"{SCENE}&seed=0")
    etag = headers["etag"]
    await overhead(first, fresh(10**6), 5)
    cases: dict[str, list[float]] = {name: [] for name in ("healthz", "cached", "304", "fresh")}
    seeds = fresh(1)
    for _ in range(ROUNDS):
        cases["healthz"] += await timed(connections, itertools.repeat("/healthz"), seconds)
        cases["cached"] += await timed(connections, itertools.repeat(f"{SCENE}&seed=0"), seconds)
        cases["304"] += await timed(connections, itertools.repeat(f"{SCENE}&seed=0"), seconds, If_None_Match=etag)
        cases["fresh"] += await timed(connections, seeds, seconds)
    print(f"{CONNECTIONS} connections, {ROUNDS} interleaved rounds of {seconds:g} s each")
    print(f"{'':<34}{'':>12}{'p50 ms':>9}{'p99 ms':>9}")
    for name, taken in cases.items():
        print(line(name, taken, ROUNDS * seconds))
    medians = {name: statistics.median(taken) for name, taken in cases.items()}
    print(
        f"ratio of medians: cached/healthz {medians['cached'] / medians['healthz']:.2f}, "
        f"304/cached {medians['304'] / medians['cached']:.2f}, fresh/cached {medians['fresh'] / medians['cached']:.1f}"
    )
    alone = await overhead(first, seeds, 200)
    print(
        f"a fresh scene on one connection: {statistics.median(t for t, _ in alone):.2f} ms, device "
        f"{statistics.median(d for _, d in alone):.2f} ms, above the device "
        f"{statistics.median(t - d for t, d in alone):.2f} ms (medians)"
    )
    status, headers, _ = await first.get(HUGE)
    assert status == 202, status
    await asyncio.sleep(2.0)
    beside = await overhead(first, seeds, 100)
    health = await timed([first], itertools.repeat("/healthz"), seconds)
    print(
        f"beside a huge job: fresh scene {statistics.median(t for t, _ in beside):.2f} ms "
        f"({statistics.median(t for t, _ in beside) / statistics.median(t for t, _ in alone):.1f} times as long), "
        f"healthz median {statistics.median(health):.2f} ms, longest {max(health):.1f} ms"
    )
    for connection in connections:
        await connection.close()


def main() -> None:
    """Start a server of its own with nothing stored, and load it."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["SAMPLERSCOPE_CACHE_DIR"] = f"{folder}/cache"
        server = Server(Path(folder))
        try:
            # The loop of the server: a client that takes little of the processors it shares with it.
            with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
                runner.run(run(int(server.url.rpartition(":")[2]), float(sys.argv[1]) if len(sys.argv) > 1 else 1.0))
        finally:
            server.stop()


if __name__ == "__main__":
    main()
