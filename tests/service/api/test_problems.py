"""What is wrong is told as a problem: every field, the value given, what is allowed; and never a traceback."""

import json
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager

import httpx
import pytest
from http_server import HUGE, LONG, PATIENCE_S, SMALL, seeded


def problem(reply, status):
    """The problem of a reply, checked for what every problem has."""
    assert reply.status_code == status, reply.text
    assert reply.headers["content-type"] == "application/problem+json"
    body = reply.json()
    assert body["status"] == status
    assert body["type"].startswith("urn:samplerscope:problem:")
    assert body["request_id"] == reply.headers["x-request-id"]
    assert body["title"]
    assert body["detail"]
    assert "Traceback" not in reply.text
    return body


def test_every_bad_field_of_a_scene_is_named_with_its_value_and_what_is_allowed(server):
    scene = {
        "model": "eon",
        "parameters": {"roughness": [0.5, 7.0], "shininess": 3},
        "techniques": ["cosine"],
        "theta_o_deg": [10, 90],
        "estimator": {"samples": 0, "seed": "x"},
        "colour": "red",
    }
    errors = {error["field"]: error for error in problem(server.ask(scene), 422)["errors"]}
    assert errors.keys() == {
        "parameters.roughness",
        "parameters.shininess",
        "theta_o_deg.1",
        "estimator.samples",
        "estimator.seed",
        "colour",
    }
    assert errors["parameters.roughness"]["value"] == 7.0
    assert errors["parameters.roughness"]["allowed"] == "0 to 1"
    assert errors["theta_o_deg.1"]["value"] == 90
    assert "< 90" in errors["theta_o_deg.1"]["allowed"]


def test_every_bad_field_of_a_link_is_named_too(server):
    reply = server.client.get("/v1/statistics?model=eon&roughness=7&angles=0&bogus=1&format=jpg&seed=1&seed=2")
    fields = {error["field"] for error in problem(reply, 422)["errors"]}
    assert fields == {"parameters.roughness", "theta_o_deg.count", "bogus", "format", "seed"}


@pytest.mark.parametrize(
    ("method", "path", "more", "status"),
    [
        ("GET", "/v1/nothing", {}, 404),
        ("GET", "/v1/figures/none", {}, 404),
        ("GET", "/v1/jobs/none", {}, 404),
        ("DELETE", "/v1/jobs/none", {}, 404),
        ("GET", "/v1/jobs/none/events", {}, 404),
        ("GET", "/v1/jobs/none/result", {}, 404),
        ("GET", "/v1/jobs/", {}, 404),
        ("PUT", "/v1/statistics", {}, 405),
        ("GET", "/v1/statistics?model=eon", {"headers": {"accept": "image/webp"}}, 406),
        ("GET", "/v1/statistics?model=none", {}, 422),
        ("GET", "/v1/statistics", {}, 422),
        ("POST", "/v1/statistics", {"content": "model=eon"}, 415),
        ("POST", "/v1/statistics", {"content": "{", "headers": {"content-type": "application/json"}}, 400),
        ("POST", "/v1/statistics", {"content": "[" * 100_000, "headers": {"content-type": "application/json"}}, 400),
        ("POST", "/v1/statistics", {"content": '{"model": NaN}', "headers": {"content-type": "application/json"}}, 400),
        ("POST", "/v1/statistics", {"content": b"\xff\xfe{", "headers": {"content-type": "application/json"}}, 400),
        ("POST", "/v1/statistics", {"content": "{1: 2}", "headers": {"content-type": "application/json"}}, 400),
        ("POST", "/v1/statistics", {"json": {f"a{k}": 0 for k in range(1001)}}, 400),
        ("POST", "/v1/statistics", {"json": []}, 422),
        ("POST", "/v1/statistics", {"json": {"model": "\ud800"}}, 422),
        ("POST", "/v1/statistics", {"json": {"model": "eon", "parameters": {"roughness": 1e400}}}, 422),
        ("POST", "/v1/statistics", {"json": {"model": "eon", "estimator": {"samples": 10**30}}}, 422),
        ("POST", "/v1/jobs", {"json": {"kind": "nothing", "scene": {}, "more": 1}}, 422),
        ("POST", "/v1/jobs", {"json": {"kind": ["statistics"], "scene": None}}, 422),
    ],
)
def test_bad_requests_are_problems_of_the_right_status(server, method, path, more, status):
    if "json" in more:
        body = json.dumps(more["json"]).replace("Infinity", "1e400")
        more = {"content": body, "headers": {"content-type": "application/json"}}
    problem(server.client.request(method, path, **more), status)


def test_a_name_given_twice_is_told_in_a_body_as_in_a_link(server):
    body = '{"model": "eon", "estimator": {"seed": 1, "seed": 2}}'
    reply = server.client.post("/v1/statistics", content=body, headers={"content-type": "application/json"})
    assert "'seed' is given more than once" in problem(reply, 400)["detail"]


def test_many_wrong_fields_of_a_link_are_told_without_holding_up_others(server):
    link = "/v1/statistics?model=eon&" + "&".join(f"a{k}=" for k in range(8000))
    reply = server.client.get(link)
    assert len(problem(reply, 422)["errors"]) == 8000
    (taken,) = (line["elapsed_ms"] for line in server.lines() if line.get("request_id") == reply.json()["request_id"])
    assert taken < 1000  # a search of all names for each of them takes longer


def test_a_method_that_a_path_lacks_is_answered_with_all_that_it_has(server):
    for path, allowed in (
        ("/v1/statistics", {"GET", "HEAD", "POST"}),
        ("/v1/jobs/none", {"GET", "HEAD", "DELETE"}),
        ("/v1/own/check", {"POST"}),
        ("/healthz", {"GET", "HEAD"}),
    ):
        reply = server.client.request("OPTIONS", path)
        problem(reply, 405)
        assert set(reply.headers["allow"].split(", ")) == allowed


@pytest.mark.parametrize("declared", [True, False])
def test_a_body_above_the_limit_is_refused_whether_its_length_is_declared_or_not(start_server, declared):
    server = start_server(max_body_bytes=1000)
    content = b" " * 2000
    more = {"headers": {"content-type": "application/json"}}
    reply = server.client.post("/v1/statistics", content=content if declared else iter([content]), **more)
    assert problem(reply, 413)["limit"] == 1000
    assert server.ask(SMALL).status_code == 200


def test_budgets_beyond_the_limits_tell_estimate_and_limit(start_server):
    server = start_server(max_samples=10**6, max_cells=100)
    samples = problem(server.ask(LONG), 422)
    assert samples["type"].endswith(":over-budget")
    assert samples["estimate"] == 4 * 16 * 1_000_000
    assert samples["limit"] == 10**6
    cells = problem(server.ask(SMALL | {"parameters": {"roughness": [k / 100 for k in range(51)]}}), 422)
    assert (cells["estimate"], cells["limit"]) == (102, 100)
    # A product of sweeps that would not fit into memory is refused before it is formed.
    sweep = [k / 1000 for k in range(1000)]
    huge = {"roughness": sweep, "albedo": sweep}
    assert problem(server.ask(SMALL | {"parameters": huge}), 422)["estimate"] == 2e6


def test_a_full_queue_is_503_and_too_many_of_one_client_429_with_retry_after(start_server):
    full = start_server(queue_limit=2, direct_limit_s=1e6, request_timeout_s=1e6)
    with asking(full, 3, first=100):
        full.await_lane("direct", running=1, waiting=2)
        refused = full.ask(seeded(HUGE, 110))
        assert problem(refused, 503)["type"].endswith(":queue-full")
        assert int(refused.headers["retry-after"]) >= 1
    limited = start_server(client_limit=3, direct_limit_s=1e6, request_timeout_s=1e6, data_dir=full.folder / "other")
    with asking(limited, 3, first=200):
        limited.await_lane("direct", running=1, waiting=2)
        refused = limited.ask(seeded(HUGE, 210))
        assert problem(refused, 429)["type"].endswith(":too-many-requests")
        assert int(refused.headers["retry-after"]) >= 1


def test_a_direct_answer_that_takes_too_long_is_503_with_retry_after(start_server):
    server = start_server(direct_limit_s=1e6, request_timeout_s=0.5)
    reply = server.ask(HUGE)
    assert problem(reply, 503)["type"].endswith(":timed-out")
    assert int(reply.headers["retry-after"]) >= 1


@contextmanager
def asking(server, count, first):
    """Huge questions under way, until the server is stopped at the end."""
    with ThreadPoolExecutor(count) as pool:
        asked = [
            pool.submit(httpx.post, f"{server.url}/v1/statistics", json=seeded(HUGE, first + k), timeout=PATIENCE_S)
            for k in range(count)
        ]
        try:
            yield
        finally:
            server.kill()
    assert all(isinstance(one.exception(), httpx.TransportError) for one in asked)


def test_an_error_inside_the_service_tells_the_client_nothing_but_an_id_that_is_in_the_log(start_server):
    server = start_server()
    with closing(sqlite3.connect(server.folder / "data" / "results-1.sqlite3")) as database:
        database.executescript("DROP TABLE checkpoint; DROP TABLE job;")
    reply = server.client.get("/v1/jobs")
    body = problem(reply, 500)
    assert body["type"] == "urn:samplerscope:problem:internal-error"
    assert "table" not in reply.text
    traces = [line for line in server.lines() if line.get("request_id") == body["request_id"] and "trace" in line]
    assert "no such table" in traces[0]["trace"]
    assert server.client.get("/healthz").status_code == 200


def test_the_request_id_of_a_client_is_kept_and_stands_in_the_log(server):
    reply = server.client.get("/v1/jobs/none", headers={"x-request-id": "my-id_1.2"})
    assert problem(reply, 404)["request_id"] == "my-id_1.2"
    made_up = server.client.get("/v1/jobs/none", headers={"x-request-id": "bad id!"})
    assert made_up.headers["x-request-id"] != "bad id!"
    wanted = {"my-id_1.2", made_up.headers["x-request-id"]}
    logged = [line for line in server.lines() if line.get("request_id") in wanted]
    assert {line["request_id"] for line in logged} == wanted
    assert all(line["status"] == 404 and line["path"] == "/v1/jobs/none" for line in logged)
