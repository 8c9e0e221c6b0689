"""What hostile and slow clients send: bounded in size and time, answered with problems, and nobody else waits."""

import json
import socket
import threading
import time

import httpx
import pytest
from http_server import PATIENCE_S, SMALL, Server

ARRIVAL_S = 1.0
HEAD = b"GET /healthz HTTP/1.1\r\nHost: x\r\n"
POST = b"POST /v1/statistics HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"


@pytest.fixture(scope="module")
def hasty(tmp_path_factory, _own_cache):
    """A server that awaits requests for a second."""
    running = Server(tmp_path_factory.mktemp("server"), request_timeout_s=ARRIVAL_S)
    yield running
    assert running.stop() == 0


def connect(server):
    connection = socket.create_connection(("127.0.0.1", httpx.URL(server.url).port))
    connection.settimeout(PATIENCE_S)
    return connection


def rest_of(connection) -> bytes:
    """All that comes until the server closes."""
    found = b""
    try:
        while piece := connection.recv(1 << 16):
            found += piece
    except ConnectionError:
        pass
    return found


def replies_in(raw: bytes) -> list[tuple[int, dict]]:
    """Status and JSON of every reply."""
    found = []
    while raw:
        head, _, raw = raw.partition(b"\r\n\r\n")
        lines = head.decode().lower().split("\r\n")
        (length,) = (int(line.partition(":")[2]) for line in lines if line.startswith("content-length"))
        found.append((int(lines[0].split()[1]), json.loads(raw[:length])))
        raw = raw[length:]
    return found


@pytest.mark.parametrize(
    "nonsense",
    [
        b"\x16\x03\x01\x02\x00\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"CONNECT a:80 HTTP/1.1\r\nHost: a\r\n\r\n",
        b"GET /v1/jobs/\xe9 HTTP/1.1\r\nHost: x\r\n\r\n",
        HEAD + b"X: a\x00b\r\n\r\n",
        POST + b"Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        POST + b"Content-Length: -1\r\n\r\n",
        POST + b"Transfer-Encoding: chunked\r\n\r\nzz\r\n",
    ],
)
def test_what_is_no_http_is_a_problem_whose_id_is_in_the_log(server, nonsense):
    with connect(server) as connection:
        connection.sendall(nonsense)
        ((status, problem),) = replies_in(rest_of(connection))
    assert status == problem["status"] == 400
    assert problem["type"] == "urn:samplerscope:problem:malformed-request"
    assert problem["request_id"] in {line.get("request_id") for line in server.lines()}


@pytest.mark.parametrize("piece", [b"X-Big: " + b"a" * 70_000, b"X: a\r\n" * 20_000, b"X" * 300_000])
def test_a_head_beyond_64_kib_is_refused_before_it_is_whole(server, piece):
    with connect(server) as connection:
        connection.sendall(HEAD)
        try:
            connection.sendall(piece)
        except ConnectionError:
            return  # refused before all was sent
        replies = replies_in(rest_of(connection))
    assert [(status, problem["type"].rpartition(":")[2]) for status, problem in replies] in (
        [(431, "head-too-large")],
        [],  # what was still on its way broke the connection
    )


def test_an_address_beyond_64_kib_is_431(server):
    with connect(server) as connection:
        connection.sendall(b"GET /v1/statistics?model=" + b"a" * 65_536 + b" HTTP/1.1\r\nHost: x\r\n\r\n")
        ((status, problem),) = replies_in(rest_of(connection))
    assert (status, problem["type"]) == (431, "urn:samplerscope:problem:head-too-large")


@pytest.mark.parametrize(
    ("begun", "drip"),
    [
        (HEAD, b""),
        (HEAD, b"X: a\r\n"),
        (POST + b"Content-Length: 100\r\n\r\n{", b""),
        (POST + b"Transfer-Encoding: chunked\r\n\r\n", b"1\r\n \r\n"),
    ],
    ids=["half a head", "a head without end", "half a body", "a body without end"],
)
def test_a_request_that_does_not_become_whole_is_408(hasty, begun, drip):
    with connect(hasty) as connection:
        connection.sendall(begun)
        ended = threading.Event()

        def go_on():
            while drip and not ended.wait(ARRIVAL_S / 5):
                try:
                    connection.sendall(drip)
                except OSError:
                    return

        dripping = threading.Thread(target=go_on)
        dripping.start()
        ((status, problem),) = replies_in(rest_of(connection))
        ended.set()
        dripping.join()
    assert (status, problem["type"]) == (408, "urn:samplerscope:problem:too-slow")


def test_a_client_that_says_nothing_is_not_waited_for(hasty):
    with connect(hasty) as connection:
        assert rest_of(connection) == b""


def test_an_answer_that_takes_longer_than_a_request_may_is_not_cut_off(hasty):
    """Events go on for as long as the job; the next request on the connection may have begun meanwhile."""
    path = hasty.start_job(SMALL | {"estimator": {"samples": 10**10}})
    with connect(hasty) as connection:
        connection.sendall(f"GET {path}/events HTTP/1.1\r\nHost: x\r\n\r\n".encode() + HEAD)
        time.sleep(2 * ARRIVAL_S)
        hasty.client.delete(path)
        found = rest_of(connection)
    assert b"event: cancelled" in found
    assert b"HTTP/1.1 408" not in found.partition(b"event: cancelled")[0]


def test_requests_that_come_together_are_answered_in_their_order(server):
    names = ["eon", "none", "lambert"] * 5
    with connect(server) as connection:
        for name in names:
            connection.sendall(f"GET /v1/statistics?model=eon&techniques={name} HTTP/1.1\r\nHost: x\r\n\r\n".encode())
        connection.sendall(b"GET /healthz HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
        *refused, (status, health) = replies_in(rest_of(connection))
    assert [problem["errors"][0]["value"] for _, problem in refused] == names
    assert (status, health) == (200, {"status": "ok"})


def test_a_client_that_breaks_off_is_no_error_inside_the_service(server):
    with connect(server) as connection:
        connection.sendall(POST + b"X-Request-Id: broken-off\r\nContent-Length: 100\r\n\r\n{")
        time.sleep(0.1)
    end = time.monotonic() + PATIENCE_S
    while not (found := [line for line in server.lines() if line.get("request_id") == "broken-off"]):
        assert time.monotonic() < end
        time.sleep(0.02)
    assert [(line["message"], line["level"], line["status"]) for line in found] == [("request", "info", 408)]
