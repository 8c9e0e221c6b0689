"""A real server on a real port of the loopback interface, started for a test, and questions of known size."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx

PATIENCE_S = 240.0
"""How long a test waits for what must come. No claim about speed: a busy machine may be twenty times slower."""

SMALL = {
    "model": "eon",
    "parameters": {"roughness": 0.5},
    "techniques": ["cosine"],
    "theta_o_deg": [0.0, 60.0],
    "estimator": {"samples": 20000, "seed": 1},
    "reference": False,
}
"""A question of some milliseconds."""

LONG = {
    "model": "eon",
    "parameters": {"roughness": [0.5, 1.0]},
    "techniques": ["cosine", "cltc-mis"],
    "theta_o_deg": {"count": 16},
    "estimator": {"samples": 1_000_000, "seed": 2},
    "reference": False,
}
"""A question of some tenths of a second and 4 launches, one a series."""

LONGER = LONG | {"theta_o_deg": {"count": 64}}
"""A question of a second or two and 16 launches, four a series."""

HUGE = LONG | {"estimator": {"samples": 10**10, "seed": 3}}
"""A question of an hour."""


def wait_until(holds: Callable[[], Any], what: str) -> None:
    """Wait until something holds; a test that waits in vain fails and says for what."""
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end, f"waited in vain until {what}"
        time.sleep(0.02)


def seeded(scene: dict, seed: int) -> dict:
    """The same scene with another seed: a question that was not asked before."""
    return scene | {"estimator": scene["estimator"] | {"seed": seed}}


class Server:
    """A server of its own. `settings` are SAMPLERSCOPE_* without the prefix, in lower case."""

    def __init__(self, folder: Path, port: int = 0, **settings: object) -> None:
        self.folder = folder
        self.settings = {"data_dir": folder / "data", **settings}
        self.log = folder / f"log-{time.monotonic_ns()}"
        environment = os.environ | {f"SAMPLERSCOPE_{k.upper()}": str(v) for k, v in self.settings.items()}
        with self.log.open("wb") as errors:
            self.process = subprocess.Popen(
                [sys.executable, "-c", "from service.cli import main; main()", "serve", "--port", str(port)],
                env=environment,
                stderr=errors,
                stdout=subprocess.DEVNULL,
            )
        self.url = self._await_url()
        self.client = httpx.Client(base_url=self.url, timeout=PATIENCE_S)

    def _await_url(self) -> str:
        while self.process.poll() is None:
            if match := re.search(r'"url": "(http://[^"]+)"', self.log.read_text()):
                return match.group(1)
            time.sleep(0.02)
        raise AssertionError(f"the server did not start: {self.log.read_text()}")

    def lines(self) -> list[dict]:
        """The log so far; every line must be JSON."""
        return [json.loads(line) for line in self.log.read_text().splitlines(keepends=True) if line.endswith("\n")]

    def ask(self, scene, **more) -> httpx.Response:
        return self.client.post("/v1/statistics", json=scene, **more)

    def start_job(self, scene) -> str:
        reply = self.client.post("/v1/jobs", json={"kind": "statistics", "scene": scene})
        assert reply.status_code == 202, reply.text
        return reply.headers["location"]

    def await_job(self, path, wanted=("done",), until=lambda job: False) -> dict:
        """Wait until a job is in a state, or `until` holds of it."""
        job: dict = {}

        def there() -> bool:
            job.update(self.client.get(path).json())
            found = job["state"] in wanted or until(job)
            assert found or job["state"] in ("queued", "running"), job
            return found

        wait_until(there, f"{path} is {' or '.join(wanted) or 'far enough'}")
        return job

    def await_lane(self, lane: str, running: int, waiting: int) -> None:
        """Wait until a worker is at so many tasks (0 or 1) and so many wait before it."""

        def there() -> bool:
            found = {name: self.metric(f"samplerscope_{name}", lane=lane) for name in ("running", "queue_length")}
            return found == {"running": running, "queue_length": waiting}

        wait_until(there, f"lane {lane} has {running} running and {waiting} waiting")

    def worker(self, lane: str) -> int:
        """The process id of a lane's latest worker, from the log."""
        started = [line for line in self.lines() if line["message"] == "worker started" and line["lane"] == lane]
        return started[-1]["worker"]

    def metric(self, name, **labels) -> float:
        """The sum of a metric over the labels that are not given."""
        found = 0.0
        for line in self.client.get("/metrics").text.splitlines():
            if line.startswith((f"{name}{{", f"{name} ")) and all(f'{k}="{v}"' in line for k, v in labels.items()):
                found += float(line.rsplit(" ", 1)[1])
        return found

    def workers(self) -> list[int]:
        """Process ids of the workers, as the kernel knows them."""
        threads = Path(f"/proc/{self.process.pid}/task").iterdir()
        return sorted(int(pid) for thread in threads for pid in (thread / "children").read_text().split())

    def stop(self) -> int:
        self.client.close()
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(timeout=PATIENCE_S)

    def kill(self) -> None:
        self.client.close()
        self.process.kill()
        self.process.wait()


def without_run(result):
    """A result without what may differ between two runs: the block `run` and measured times."""
    series = [{k: v for k, v in one.items() if k != "device_ms"} for one in result["series"]]
    return {k: v for k, v in result.items() if k != "run"} | {"series": series}
