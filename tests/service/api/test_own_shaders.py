"""Shader text over HTTP: refused unless allowed, then run confined, and whatever it does ends in an answer."""

import json
import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from http_server import PATIENCE_S, SMALL, Server, wait_until, without_run

HEAD = '/*---\nprovides = ["technique"]\nname = "mine"\ntitle = "Mine"\nsource = "own"\n---*/\n'
INCLUDE = '#include "common/hemisphere.glsl"\n'
COSINE = "DirectionSample sample_direction(vec3 wo, vec2 u) {\n    return cosine_hemisphere(u);\n}\n"
PDF = "float direction_pdf(vec3 wo, vec3 wi) { return INV_PI * max(wi.z, 0.0); }\n"
SOUND = HEAD + INCLUDE + COSINE + PDF
WRONG = HEAD + INCLUDE + COSINE + "float direction_pdf(vec3 wo, vec3 wi) {\n    return brightness;\n}\n"
ENDLESS = COSINE.replace("{\n", "{\n    while (true) u.x += 1.0;\n")
LARGE = (
    "float table[268435456];\nDirectionSample sample_direction(vec3 wo, vec2 u) { table[int(u.x * 1e3)] = u.y;"
    " return DirectionSample(vec3(0, 0, 1), table[int(u.y * 1e8)]); }\n"
)
SCENE = {"theta_o_deg": [0.0, 60.0], "estimator": {"samples": 20000, "seed": 1}}


@pytest.fixture(scope="module")
def open_server(tmp_path_factory, _own_cache):
    """A server that takes shader text, and has patience on a busy machine."""
    running = Server(
        tmp_path_factory.mktemp("server"),
        own_glsl=True,
        own_glsl_limit_s=200,
        request_timeout_s=PATIENCE_S,
        api_key="k3y",
    )
    running.client.headers["x-api-key"] = "k3y"
    yield running
    assert running.stop() == 0


def descendants(pid):
    """Processes that a process has started, and those that these have."""
    found = []
    with suppress(FileNotFoundError, ProcessLookupError):  # it, or a thread of it, has just ended
        for thread in Path(f"/proc/{pid}/task").iterdir():
            for child in map(int, (thread / "children").read_text().split()):
                found += [child, *descendants(child)]
    return found


def ask(server, task, **body):
    return server.client.post(f"/v1/own/{task}", json=body)


@pytest.mark.parametrize("task", ["check", "statistics", "stability"])
def test_shader_text_is_refused_unless_a_setting_allows_it(server, task):
    refused = ask(server, task, glsl=SOUND)
    assert refused.status_code == 403
    assert refused.json()["type"] == "urn:samplerscope:problem:own-glsl-off"
    assert "SAMPLERSCOPE_OWN_GLSL" in refused.json()["detail"]


def test_a_sound_file_is_checked_and_its_answer_is_stored(open_server):
    first = ask(open_server, "check", glsl=SOUND)
    assert first.status_code == 200, first.text
    result = first.json()
    assert (result["kind"], result["status"], result["subject"]) == ("check", "pass", "own.glsl")
    computed = open_server.metric("samplerscope_answers_total", how="computed", kind="own-check")
    again = ask(open_server, "check", glsl=SOUND)
    assert again.content == first.content
    assert again.headers["etag"] == first.headers["etag"]
    assert open_server.metric("samplerscope_answers_total", how="computed", kind="own-check") == computed
    assert ask(open_server, "check", glsl=SOUND, seed=1).content != first.content


def test_statistics_are_those_of_the_command_line(open_server, tmp_path):
    (tmp_path / "own.glsl").write_text(SOUND)
    options = "stats --model ./own.glsl --theta-o-deg 0,60 --samples 20000 --seed 1 --format json"
    command = [sys.executable, "-c", "from service.cli import main; main()", *options.split()]
    root = str(Path(__file__).parents[3])
    done = subprocess.run(command, capture_output=True, check=True, cwd=tmp_path, env=os.environ | {"PYTHONPATH": root})
    answered = ask(open_server, "statistics", glsl=SOUND, scene=SCENE)
    assert answered.status_code == 200, answered.text
    assert without_run(answered.json()) == without_run(json.loads(done.stdout))
    body = {"glsl": SOUND, "scene": SCENE}
    table = open_server.client.post("/v1/own/statistics", json=body, params={"format": "csv"})
    assert len(table.text.splitlines()) == 1 + len(SCENE["theta_o_deg"])


def test_compile_errors_are_problems_with_the_lines_of_the_text(open_server):
    reply = ask(open_server, "statistics", glsl=WRONG, scene=SCENE)
    assert reply.status_code == 422
    problem = reply.json()
    assert problem["type"] == "urn:samplerscope:problem:own-file-failed"
    message = {"file": "own.glsl", "line": 12, "message": "'brightness' : undeclared identifier"}
    assert message in problem["diagnostics"]


@pytest.mark.parametrize(
    ("code", "says"),
    [
        (INCLUDE + ENDLESS + PDF, "65,535"),
        (LARGE + PDF, "memory"),
        ('#include "/etc/hostname"\n' + COSINE + PDF, "there is no such file to include"),
        ("shared float x[10];\n" + COSINE + PDF, "own.glsl:7: shared"),
    ],
    ids=["endless loop", "1 GB array", "file of the host", "shared memory"],
)
def test_what_cannot_run_is_a_problem_and_leaves_no_process(open_server, code, says):
    reply = ask(open_server, "check", glsl=HEAD + code)
    assert reply.status_code == 422, reply.text
    assert reply.json()["type"] == "urn:samplerscope:problem:own-file-failed"
    assert says in reply.json()["detail"]
    assert "Traceback" not in reply.text
    assert sorted(descendants(open_server.process.pid)) == open_server.workers()


def test_what_takes_too_long_is_ended_and_others_go_on(start_server):
    server = start_server(own_glsl=True, own_glsl_limit_s=0.2)
    reply = ask(server, "check", glsl=SOUND, quick=False)
    assert reply.status_code == 422
    assert "not done within 0.2 s" in reply.json()["detail"]
    assert server.ask(SMALL).status_code == 200
    wait_until(lambda: sorted(descendants(server.process.pid)) == server.workers(), "only the workers are left")
    assert server.metric("samplerscope_worker_restarts_total") == 0


@pytest.mark.parametrize(
    ("task", "body", "field"),
    [
        ("check", [], "body"),
        ("check", {}, "glsl"),
        ("check", {"glsl": 1}, "glsl"),
        ("check", {"glsl": SOUND, "colour": 1}, "colour"),
        ("check", {"glsl": SOUND, "seed": -1}, "seed"),
        ("check", {"glsl": SOUND, "parameters": {"gloss": 1e999}}, "parameters.gloss"),
        ("check", {"glsl": SOUND, "model": "none"}, "model"),
        ("check", {"glsl": SOUND, "parameters": {"gloss": 1}}, "parameters.gloss"),
        ("statistics", {"glsl": SOUND, "scene": {"model": "eon"}}, "scene.model"),
        ("statistics", {"glsl": SOUND, "scene": {"theta_o_deg": [90]}}, "theta_o_deg.0"),
        ("statistics", {"glsl": SOUND, "scene": {"parameters": {"roughness": 7}}}, "parameters.roughness"),
    ],
)
def test_every_bad_field_is_named(open_server, task, body, field):
    content = json.dumps(body).replace("Infinity", "1e999")
    headers = {"content-type": "application/json"}
    reply = open_server.client.post(f"/v1/own/{task}", content=content, headers=headers)
    assert reply.status_code == 422, reply.text
    assert field in {error["field"] for error in reply.json()["errors"]}
