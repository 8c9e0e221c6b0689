"""What those who run the service rely on: checks, metrics, logs, settings, the key, the end."""

import re
import subprocess
import sys
import threading

import httpx
import pytest
from http_server import HUGE, LONG, PATIENCE_S, SMALL, wait_until


def test_readiness_is_a_dispatch_compared_with_a_known_result(server):
    reply = server.client.get("/readyz")
    assert reply.status_code == 200
    answer = reply.json()
    assert answer["found"] == answer["known"] == {"mean": 1.0, "variance": 0.0, "max_weight": 1.0, "nonfinite": 0}
    assert answer["device"]["name"].startswith("llvmpipe")


def test_metrics_are_in_the_format_of_prometheus(server):
    from prometheus_client.parser import text_string_to_metric_families

    server.ask(SMALL)
    families = {family.name for family in text_string_to_metric_families(server.client.get("/metrics").text)}
    assert {
        "samplerscope_requests",
        "samplerscope_request_duration_seconds",
        "samplerscope_answers",
        "samplerscope_jobs",
        "samplerscope_worker_restarts",
        "samplerscope_queue_length",
    } <= families


def test_every_line_of_the_log_is_json_and_requests_carry_their_id(server):
    reply = server.client.get("/v1/catalogue")
    (line,) = [line for line in server.lines() if line.get("request_id") == reply.headers["x-request-id"]]
    assert line["path"] == "/v1/catalogue"
    assert line["status"] == 200
    assert line["elapsed_ms"] > 0
    assert line.keys() >= {"time", "level", "logger", "message"}


def test_the_server_listens_on_loopback_unless_told_otherwise(server):
    assert server.url.startswith("http://127.0.0.1:")
    from service.api.settings import Settings

    assert Settings().host == "127.0.0.1"


def test_with_a_key_only_health_and_readiness_are_open(start_server):
    server = start_server(api_key="s3cret")
    assert server.client.get("/healthz").status_code == 200
    assert server.client.get("/readyz").status_code == 200
    for path in ("/v1/catalogue", "/v1/jobs", "/metrics", "/v1/statistics?model=eon", "/v1/figures"):
        refused = server.client.get(path)
        assert refused.status_code == 401
        assert refused.headers["www-authenticate"] == "Bearer"
        assert refused.headers["content-type"] == "application/problem+json"
    assert server.client.get("/v1/jobs", headers={"x-api-key": "wrong"}).status_code == 401
    assert server.client.get("/v1/jobs", headers={"x-api-key": "s3cret"}).status_code == 200
    assert server.client.get("/v1/jobs", headers={"authorization": "Bearer s3cret"}).status_code == 200
    assert "s3cret" not in server.log.read_text()


def run_serve(**environment):
    import os

    variables = os.environ | {f"SAMPLERSCOPE_{k.upper()}": str(v) for k, v in environment.items()}
    command = [sys.executable, "-c", "from service.cli import main; main()", "serve", "--port", "0"]
    return subprocess.run(command, env=variables, capture_output=True, text=True, timeout=PATIENCE_S, check=False)


def test_bad_settings_are_one_line_and_exit_2(tmp_path):
    done = run_serve(data_dir=tmp_path, queue_limit="many", max_cells=0)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert "SAMPLERSCOPE_QUEUE_LIMIT = many" in done.stderr
    assert "SAMPLERSCOPE_MAX_CELLS = 0" in done.stderr


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("api_key", ""),
        ("host", ""),
        ("graceful_s", "inf"),
        ("request_timeout_s", "nan"),
        ("stall_timeout_s", "1e300"),
        ("store_max_jobs", 10**30),
    ],
)
def test_a_setting_that_would_open_the_server_or_stop_its_clocks_is_refused(tmp_path, name, value):
    done = run_serve(data_dir=tmp_path, **{name: value})
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert f"SAMPLERSCOPE_{name.upper()} =" in done.stderr


def test_a_data_folder_in_use_is_bad_input(server):
    done = run_serve(data_dir=server.settings["data_dir"])
    assert done.returncode == 2
    assert "no other server" in done.stderr


def test_without_a_device_the_server_does_not_start_and_exits_3(tmp_path):
    import os

    variables = {"SAMPLERSCOPE_DATA_DIR": str(tmp_path), "VK_DRIVER_FILES": str(tmp_path / "none.json")}
    command = [sys.executable, "-c", "from service.cli import main; main()", "serve", "--port", "0"]
    done = subprocess.run(
        command, env=os.environ | variables, capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    assert done.returncode == 3
    assert "Traceback" not in done.stderr
    assert "VK_DRIVER_FILES" in done.stderr.splitlines()[-1]


def test_the_end_lets_direct_answers_finish_and_leaves_no_process(start_server):
    server = start_server(graceful_s=PATIENCE_S)
    replies = []
    scene = LONG | {"theta_o_deg": {"count": 4}}
    asking = threading.Thread(
        target=lambda: replies.append(httpx.post(f"{server.url}/v1/statistics", json=scene, timeout=PATIENCE_S))
    )
    asking.start()
    workers = server.workers()
    wait_until(lambda: server.metric("samplerscope_answers_total", how="computed"), "the question is there")
    assert server.stop() == 0
    asking.join()
    assert replies[0].status_code == 200
    assert len(workers) == 3
    from pathlib import Path

    assert not [pid for pid in workers if Path(f"/proc/{pid}").exists()]


def test_a_direct_answer_that_cannot_finish_in_time_is_a_problem_at_the_end(start_server):
    server = start_server(graceful_s=0.5, direct_limit_s=1e6, request_timeout_s=600)
    replies = []
    asking = threading.Thread(
        target=lambda: replies.append(httpx.post(f"{server.url}/v1/statistics", json=HUGE, timeout=PATIENCE_S))
    )
    asking.start()
    server.await_lane("direct", running=1, waiting=0)
    assert server.stop() == 0
    asking.join()
    assert replies[0].status_code == 503
    assert replies[0].json()["type"] == "urn:samplerscope:problem:stopping"
    assert "retry-after" in replies[0].headers


def test_the_documentation_names_every_setting_and_route(server):
    from pathlib import Path

    from service.api.settings import Settings

    text = (Path(__file__).parents[3] / "docs" / "http.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`SAMPLERSCOPE_([A-Z_]+)`", text))
    assert {name.upper() for name in Settings.model_fields} <= named
    for path in server.client.get("/openapi.json").json()["paths"]:
        assert f"`{path}`" in text
    for name, default in re.findall(r"^\| `SAMPLERSCOPE_([A-Z_]+)` \| ([\d.]+|true|false) \|", text, re.MULTILINE):
        value = Settings.model_fields[name.lower()].default
        assert default in (str(value).lower(), f"{value:g}" if isinstance(value, float) else None), name


@pytest.mark.parametrize("host", ["0.0.0.1", "999.1.1.1"])
def test_an_address_that_cannot_be_had_is_bad_input(tmp_path, host):
    done = run_serve(data_dir=tmp_path, host=host)
    assert done.returncode == 2
    assert host in done.stderr
    assert "Traceback" not in done.stderr
