"""Which is fastest: the efficiency map and the error curves are those of /v1/convergence, for the curves shown."""

import re

from playwright.sync_api import expect

QUERY = "?model=eon&roughness=0.5&techniques=cosine,cltc-mis&angles=8&samples=1000&seed=1"


def test_winners_and_error_curves_are_measured_shown_and_follow_the_legend(visit, server):
    one = visit()
    tab = one.open(QUERY)
    expect(tab.locator("#speed")).to_be_hidden()
    tab.get_by_role("button", name="Measure").click()
    expect(tab.locator("#speed-status")).to_contain_text("Measured in")
    tab.wait_for_url("**view.speed=1*")
    job = next(job for job in server.client.get("/v1/jobs").json()["jobs"] if job["kind"] == "convergence")
    table = server.client.get(job["links"]["result"]).json()["efficiency"]
    rows = tab.locator("#winners tbody tr")
    assert rows.count() == len(table["parameters"])
    for row, winners in zip(rows.all(), table["winner"], strict=True):
        assert [cell.locator("b").inner_text() for cell in row.locator("td").all()] == winners
    assert tab.locator("#errors .panel").count() == 4
    words = "Relative error against run time at 0°, logarithmic axes, curves: cosine, cltc-mis."
    expect(tab.locator("#errors .panel").first).to_have_attribute("aria-label", words)
    expect(tab.locator("#errors figure").nth(2)).to_contain_text(
        re.compile("reaches the target first|are not distinguishable")
    )
    cell = rows.first.locator("td").first
    cell.scroll_into_view_if_needed()
    cell.dispatch_event("pointermove")
    expect(tab.locator("#hover")).to_contain_text("roughness 0, 0°")
    tab.get_by_role("button", name="cosine", exact=True).click()
    expect(tab.locator("#winners b").filter(has_text="cosine")).to_have_count(0)
    tab.get_by_role("button", name="Measure").click()
    expect(tab.locator("#speed")).to_be_hidden()
