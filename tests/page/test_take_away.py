"""What is taken away is the same result: the command and the link give it again, the files hold it."""

import json
import re
import shlex
import subprocess
import sys

import pytest
from playwright.sync_api import expect

from tests.service.api.http_server import without_run

QUERY = "?model=eon&roughness=0.5&albedo=1&techniques=cosine,cltc-mis&theta_o_deg=0,45,80&method=mc&samples=3000&seed=9"


@pytest.fixture(scope="module")
def tab(long_visit):
    one = long_visit(permissions=["clipboard-read", "clipboard-write"])
    return one.open(QUERY)


def copied(tab, name: str) -> str:
    tab.locator("#copy summary").click()
    tab.get_by_role("button", name=name).click()
    expect(tab.locator("#announcer")).to_have_text(f"Copied: {name}")
    text = tab.evaluate("navigator.clipboard.readText()")
    tab.keyboard.press("Escape")
    expect(tab.get_by_role("button", name=name)).to_be_hidden()
    return text


def test_link_curl_and_command_line_give_the_result_again(tab, server):
    assert copied(tab, "Link") == f"{server.url}/{QUERY}"
    curl = shlex.split(copied(tab, "curl command"))
    assert curl[0] == "curl"
    assert len(curl) == 2
    by_curl = server.client.get(curl[1]).json()
    command = shlex.split(copied(tab, "Command line"))
    assert command[:2] == ["samplerscope", "stats"]
    program = [sys.executable, "-c", "from service.cli import main; main()"]
    found = subprocess.run([*program, *command[1:], "--format", "json"], capture_output=True, check=True)
    assert without_run(json.loads(found.stdout)) == without_run(by_curl)


def test_the_vega_lite_spec_is_that_of_the_service(tab, server):
    spec = copied(tab, "Vega-Lite spec")
    assert re.fullmatch(r"https://vega.github.io/schema/vega-lite/v\d.*", json.loads(spec)["$schema"])
    assert spec == server.client.get(f"/v1/statistics{QUERY}&format=vega").text


@pytest.mark.parametrize(("name", "begin"), [("CSV", b"model,"), ("JSON", b"{"), ("PNG", b"\x89PNG"), ("SVG", b"<svg")])
def test_downloads_are_the_files_of_the_service(tab, server, name, begin):
    tab.locator("#download summary").click()
    with tab.expect_download() as download:
        tab.get_by_role("button", name=name).click()
    assert download.value.suggested_filename == f"eon.{name.lower()}"
    content = download.value.path().read_bytes()
    assert content.startswith(begin)
    assert content == server.client.get(f"/v1/statistics{QUERY}&format={name.lower()}").content
