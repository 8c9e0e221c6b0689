"""A real server on a real port of the loopback interface, started for a test, and questions of known size."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx

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
"""A question of about half a second and 16 launches."""

HUGE = LONG | {"estimator": {"samples": 10**9, "seed": 3}}
"""A question of many minutes."""


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
        self.client = httpx.Client(base_url=self.url, timeout=60)

    def _await_url(self) -> str:
        while self.process.poll() is None:
            if match := re.search(r'"url": "(http://[^"]+)"', self.log.read_text()):
                return match.group(1)
            time.sleep(0.02)
        raise AssertionError(f"the server did not start: {self.log.read_text()}")

    def lines(self) -> list[dict]:
        """The log so far; every line must be JSON."""
        return [json.loads(line) for line in self.log.read_text().splitlines()]

    def ask(self, scene, **more) -> httpx.Response:
        return self.client.post("/v1/statistics", json=scene, **more)

    def start_job(self, scene) -> str:
        reply = self.client.post("/v1/jobs", json={"kind": "statistics", "scene": scene})
        assert reply.status_code == 202, reply.text
        return reply.headers["location"]

    def await_job(self, path, wanted=("done",), seconds=60, until=lambda job: False) -> dict:
        """Wait until a job is in a state, or `until` holds of it."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            job = self.client.get(path).json()
            if job["state"] in wanted or until(job):
                return job
            assert job["state"] in ("queued", "running"), job
            time.sleep(0.02)
        raise AssertionError(f"the job did not get there: {job}")

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
        return self.process.wait(timeout=30)

    def kill(self) -> None:
        self.client.close()
        self.process.kill()
        self.process.wait()


def without_run(result):
    """A result without what may differ between two runs: the block `run` and measured times."""
    series = [{k: v for k, v in one.items() if k != "device_ms"} for one in result["series"]]
    return {k: v for k, v in result.items() if k != "run"} | {"series": series}
