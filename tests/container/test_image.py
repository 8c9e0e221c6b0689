"""The image, driven from outside: what it answers, how it starts and stops, what it keeps, and how large it is."""

import json
import subprocess
import sys
import time
import uuid

from tests.container.conftest import IMAGE, command, engine

SCENE = {
    "model": "eon",
    "techniques": ["cosine", "cltc-mis"],
    "theta_o_deg": [0, 45, 80],
    "estimator": {"samples": 100_000, "seed": 3},
}
STATS = [
    *("stats", "--technique", "cosine,cltc-mis", "--theta-o-deg", "0,45,80"),
    *("--samples", "100000", "--seed", "3", "--format", "json"),
]
LONG = {"model": "eon", "techniques": ["cltc-mis"], "theta_o_deg": {"count": 8}, "estimator": {"samples": 400_000_000}}


def numbers(result):
    """The series without measured times."""
    return [{k: v for k, v in series.items() if k != "device_ms"} for series in result["series"]]


def on_host():
    code = "from service.cli import main; main()"
    done = subprocess.run([sys.executable, "-c", code, *STATS], capture_output=True, text=True, check=True)
    return numbers(json.loads(done.stdout))


def test_the_image_is_small():
    size = int(engine("image", "inspect", "--format", "{{.Size}}", IMAGE))
    print(f"\nimage size: {size / 1e6:.0f} MB")
    assert size < 450e6


def test_the_command_line_in_the_image_gives_the_numbers_of_the_host():
    assert numbers(json.loads(command(*STATS))) == on_host()


def test_the_service_answers_hardened_with_the_numbers_of_the_host(start):
    service = start(f"samplerscope-{uuid.uuid4().hex}")
    print(f"\ntime to ready: {service.ready_s:.2f} s; memory at rest: {service.memory()}")
    assert numbers(service.json("/v1/statistics", method="POST", body=SCENE)) == on_host()
    headers, png = service.settled("/v1/figures/eon-11?samples=1000&format=png")
    assert headers["Content-Type"] == "image/png"
    assert png.startswith(b"\x89PNG")
    print(f"memory under load: {service.memory()}")
    _, library = service.settled("/page/vega-embed.js")
    assert b"vegaEmbed" in library
    assert b"/page/main.js" in service.settled("/")[1]
    inside = ["exec", service.name, "/opt/samplerscope/bin/python"]
    assert engine(*inside, "-c", "import os; print(os.getuid())").strip() == "10001"
    engine(*inside, "-m", "service.container", "healthy")


def test_the_second_start_is_ready_within_three_seconds(start):
    """The first start of an image may read it from a cold disk; the second one is what a restart costs."""
    volume = f"samplerscope-{uuid.uuid4().hex}"
    start(volume).stop()
    assert start(volume).ready_s < 3


def test_a_job_survives_the_end_of_its_container(start):
    volume = f"samplerscope-{uuid.uuid4().hex}"
    first = start(volume)
    answer = first.json("/v1/statistics", method="POST", body=SCENE)
    status, headers, _ = first.request("/v1/statistics", method="POST", body=LONG)
    assert status == 202
    job = headers["Location"]
    while first.json(job)["progress"]["done"] == 0:
        time.sleep(0.1)
    took, code = first.stop()
    print(f"\nSIGTERM with a job running: ended after {took:.1f} s with code {code}")
    assert code == 0
    assert took < 15
    second = start(volume)
    assert second.json("/v1/statistics", method="POST", body=SCENE) == answer
    while (found := second.json(job))["state"] in ("queued", "running"):
        time.sleep(0.5)
    assert found["state"] == "done"


def test_a_cpu_quota_is_the_number_of_driver_threads():
    for cpus, threads in (("0.5", 1), ("1", 1)):
        found = json.loads(command("info", "--format", "json", options=("--cpus", cpus)))
        assert found["device"]["threads"] == threads
