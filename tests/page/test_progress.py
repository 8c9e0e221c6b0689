"""Long questions: curves sharpen while samples accumulate, can be cancelled, and survive a restart of the server."""

import re

from playwright.sync_api import expect

from tests.service.api.http_server import Server

HUGE = "?model=eon&roughness=0.5&techniques=cosine,uniform&angles=16&samples=1000000000&seed=5&reference=false"


def await_drawn(one, times: int) -> None:
    """Wait until the panels were drawn so often."""
    for _ in range(1200):
        if one.drawn() >= times:
            return
        one.tab.wait_for_timeout(50)
    raise AssertionError(f"drawn {one.drawn()} times")


def samples_of_rows(one) -> str:
    return one.tab.locator("#values tbody tr").first.inner_text()


def test_curves_sharpen_while_samples_accumulate_and_cancel_ends_the_job(visit, server):
    one = visit()
    one.tab.goto(f"{one.url}/{HUGE}")
    await_drawn(one, 2)
    early = samples_of_rows(one)
    expect(one.tab.locator("#statistics-status progress")).to_have_attribute("value", re.compile(r"0\.0*[1-9]"))
    expect(one.tab.locator("#statistics-status .elapsed")).to_have_text(re.compile(r"[1-9]"))
    await_drawn(one, one.drawn() + 5)
    assert samples_of_rows(one) != early
    expect(one.tab.locator("#curves")).to_contain_text("measuring")
    one.tab.get_by_role("button", name="Cancel").click()
    expect(one.status).to_contain_text("Cancelled")
    expect(one.said).to_contain_text("Cancelled")
    job = next(job for job in server.client.get("/v1/jobs").json()["jobs"] if job["scene"]["estimator"]["seed"] == 5)
    assert server.await_job(job["links"]["self"], ("cancelled",))["state"] == "cancelled"
    one.tab.get_by_role("button", name="Ask again").click()
    expect(one.tab.get_by_role("button", name="Cancel")).to_be_visible()
    one.tab.get_by_role("button", name="Cancel").click()


def test_a_new_question_takes_the_place_of_the_one_under_way(visit, server):
    one = visit()
    one.tab.goto(f"{one.url}/{HUGE.replace('seed=5', 'seed=6')}")
    await_drawn(one, 2)
    samples = one.tab.get_by_label("Samples per angle")
    samples.fill("1000")
    samples.press("Enter")
    one.done()
    job = next(job for job in server.client.get("/v1/jobs").json()["jobs"] if job["scene"]["estimator"]["seed"] == 6)
    server.await_job(job["links"]["self"], ("cancelled",))


def test_a_server_with_a_key_that_goes_away_twice_is_survived_with_messages(visit, tmp_path):
    """It asks for its key, stops in order, is killed, and each time the job goes on when it is back."""
    running = Server(tmp_path, api_key="correct horse")
    port = int(running.url.rsplit(":", 1)[1])
    one = visit(running.url)
    one.tab.goto(f"{one.url}/{HUGE}")
    one.tab.get_by_label("Key of this server").fill("correct horse")
    one.tab.get_by_label("Key of this server").press("Enter")
    try:
        for end in ("stop", "kill"):
            await_drawn(one, one.drawn() + 2)
            getattr(running, end)()
            expect(one.status).to_contain_text("Trying again")
            expect(one.said).to_contain_text("Trying again")
            running = Server(tmp_path, port=port, api_key="correct horse")
            expect(one.status).to_contain_text("%")
        one.tab.get_by_label("Samples per angle").fill("1000")
        one.tab.get_by_label("Samples per angle").press("Enter")
        one.done()
    finally:
        one.tab.close()
        running.stop()
    one.expect_complaints("status of 401")
    one.expect_complaints("net::ERR_")
