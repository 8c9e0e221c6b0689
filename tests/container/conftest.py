"""Containers of the image, started hardened: read-only root, no capabilities, 512 MB, few processes."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from dataclasses import dataclass

import pytest

IMAGE = os.environ.get("SAMPLERSCOPE_IMAGE", "samplerscope")
HARDENING = [
    *("--read-only", "--tmpfs", "/tmp", "--cap-drop", "all", "--security-opt", "no-new-privileges"),
    *("--memory", "512m", "--pids-limit", "64", "--network", "host"),
]
READY_S = 20


def _engine() -> list[str]:
    if shutil.which("docker") and subprocess.run(["docker", "info"], capture_output=True, check=False).returncode == 0:
        return ["docker"]
    return ["podman", "--runtime", "runc"]


ENGINE = _engine()
LIMITS = [] if ENGINE[0] == "docker" else ["--ulimit", "nofile=1024:1024", "--ulimit", "nproc=4096:4096"]


def engine(*arguments, check=True, timeout=120):
    """Call the container engine; its standard output."""
    done = subprocess.run([*ENGINE, *arguments], capture_output=True, text=True, timeout=timeout, check=False)
    assert done.returncode == 0 or not check, done.stderr
    return done.stdout


def command(*arguments, options=()):
    """Run the image once, as a command; its standard output."""
    return engine("run", "--rm", *HARDENING, *LIMITS, *options, IMAGE, *arguments)


@dataclass
class Service:
    """A running container with the service on a port of the loopback interface."""

    name: str
    port: int
    ready_s: float

    def request(self, path, *, method="GET", body=None, headers=None):
        """(status, headers, body) of a request."""
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.port}{path}",
            method=method,
            data=None if body is None else json.dumps(body).encode(),
            headers={"Content-Type": "application/json", **(headers or {})},
        )
        try:
            with urllib.request.urlopen(request, timeout=60) as reply:
                return reply.status, reply.headers, reply.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def json(self, path, **options):
        """The JSON of a reply that must be a success."""
        status, _, content = self.request(path, **options)
        assert status < 300, content
        return json.loads(content)

    def settled(self, path):
        """(headers, body) of a reply, once a job that it may have become is done."""
        while True:
            status, headers, content = self.request(path)
            if status == 200:
                return headers, content
            assert status == 202, content
            time.sleep(0.2)

    def memory(self):
        """Memory of the container's control group, in words."""
        text = engine("stats", "--no-stream", "--format", "{{.MemUsage}}", self.name)
        return text.split("/")[0].strip()

    def stop(self):
        """End it with SIGTERM, as an orchestrator does; the seconds that took and the exit code."""
        begin = time.monotonic()
        engine("stop", "--time", "20", self.name)
        took = time.monotonic() - begin
        return took, int(engine("inspect", "--format", "{{.State.ExitCode}}", self.name))


@pytest.fixture
def start():
    """Start services; all containers and volumes go at the end."""
    services, volumes = [], set()

    def run(volume, *options, environment=()):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        name = f"samplerscope-test-{port}"
        volumes.add(volume)
        settings = {"HOST": "127.0.0.1", "PORT": port, **dict(environment)}
        variables = [part for key, value in settings.items() for part in ("--env", f"SAMPLERSCOPE_{key}={value}")]
        mount = ["--volume", f"{volume}:/var/lib/samplerscope"]
        begin = time.monotonic()
        engine("run", "--detach", "--name", name, *HARDENING, *LIMITS, *mount, *variables, *options, IMAGE)
        service = Service(name, port, 0.0)
        services.append(service)
        while time.monotonic() - begin < READY_S:
            try:
                if service.request("/readyz")[0] == 200:
                    service.ready_s = time.monotonic() - begin
                    return service
            except OSError:
                pass
            time.sleep(0.02)
        raise AssertionError(engine("logs", name))

    yield run
    for service in services:
        engine("rm", "--force", service.name, check=False)
    for volume in volumes:
        engine("volume", "rm", "--force", volume, check=False)
