"""Debian's Chromium on the real page of a real server, with real workers on lavapipe."""

from __future__ import annotations

import gc
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, expect, sync_playwright

from tests.service.api.http_server import Server

PATIENCE_MS = 60_000
"""How long something may take on a busy machine before a test fails. Nothing waits so long where it works."""

_SWITCHES = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@pytest.fixture(scope="session")
def server(tmp_path_factory, _own_cache) -> Iterator[Server]:
    """One server for all tests that leave it as it is."""
    running = Server(tmp_path_factory.mktemp("page"))
    # Bundles the plotting library once: the tests are about what comes after.
    assert running.client.get("/page/vega-embed.js").status_code == 200
    yield running
    assert running.stop() == 0


@pytest.fixture(scope="session")
def out() -> Path:
    """The folder of screenshots."""
    folder = Path(__file__).resolve().parents[2] / "out"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Debian's Chromium; `make browser` brings it.

    It ends with the tests of a file: while it is there, its event loop counts as running in this thread, and tests of
    another file could not have one.
    """
    program = shutil.which("chromium")
    assert program, "chromium is not here: `make browser` brings it"
    expect.set_options(timeout=PATIENCE_MS)
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=list(_SWITCHES))
        yield running
        running.close()
    # Its greenlets go now: one that is collected while CPython 3.11 compiles upsets its count of recursions.
    gc.collect()


class Visit:
    """A tab on the page of a server. Whatever the browser complains of, and every address it asks for, is noted."""

    def __init__(self, context: BrowserContext, url: str) -> None:
        self.url = url
        self.tab: Page = context.new_page()
        self.tab.set_default_timeout(PATIENCE_MS)
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.tab.on("console", self._note)
        self.tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.tab.on("request", lambda request: self.requests.append(request.url))

    def _note(self, message: ConsoleMessage) -> None:
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def open(self, query: str = "") -> Page:
        """Open the page with a query, and wait until its answer is whole."""
        self.tab.goto(f"{self.url}/{query}")
        self.done()
        return self.tab

    def done(self) -> None:
        """Wait until the statistics are whole and drawn."""
        expect(self.status).to_contain_text("Done in")
        expect(self.tab.locator("#curves .waiting")).to_have_count(0)

    @property
    def status(self):
        return self.tab.locator("#statistics-status")

    def drawn(self) -> int:
        """How often the panels were drawn."""
        return int(self.tab.locator("body").get_attribute("data-plotted") or 0)

    def lines(self, panel: int = 0) -> list[str]:
        """The outlines of what a panel draws: equal only where the same curves are drawn."""
        return (
            self.tab.locator(".panel")
            .nth(panel)
            .locator("svg path")
            .evaluate_all("all => all.map(p => p.getAttribute('d'))")
        )

    @property
    def said(self):
        """What screen readers were told last."""
        return self.tab.locator("#announcer")

    def expect_complaints(self, pattern: str) -> None:
        """Complaints that belong to the test, as of a refused request, are no fault; there must be some."""
        assert any(re.search(pattern, one) for one in self.complaints), self.complaints
        self.complaints = [one for one in self.complaints if not re.search(pattern, one)]


@contextmanager
def _visiting(browser: Browser, server: Server) -> Iterator[Callable[..., Visit]]:
    """Open tabs. At the end none may have complained, or asked any host but its own."""
    visits: list[tuple[BrowserContext, Visit]] = []

    def start(url: str = server.url, **options) -> Visit:
        context = browser.new_context(**({"viewport": {"width": 1440, "height": 900}} | options))
        visits.append((context, Visit(context, url)))
        return visits[-1][1]

    yield start
    for context, one in visits:
        context.close()
        assert one.complaints == []
        assert all(address.startswith((f"{one.url}/", f"blob:{one.url}/")) for address in one.requests)


@pytest.fixture
def visit(browser: Browser, server: Server) -> Iterator[Callable[..., Visit]]:
    """Open tabs for one test."""
    with _visiting(browser, server) as start:
        yield start


@pytest.fixture(scope="module")
def long_visit(browser: Browser, server: Server) -> Iterator[Callable[..., Visit]]:
    """Open tabs that the tests of a module share."""
    with _visiting(browser, server) as start:
        yield start
