"""For everyone: names and contrast by axe-core, light and dark, narrow screens, the keyboard alone."""

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

QUERY = "?model=eon&roughness=0.5,1&techniques=cosine,ltc,cltc-mis&angles=16&samples=5000&view.at=60&view.speed=1"
LOOKS = {
    "desktop": {},
    "dark": {"color_scheme": "dark"},
    "phone": {"viewport": {"width": 360, "height": 740}, "has_touch": True, "is_mobile": True},
}


@pytest.mark.parametrize("look", LOOKS)
def test_axe_finds_nothing_serious_and_no_part_is_wider_than_the_screen(visit, look, out):
    """For the eye as well: out/page-dark.png and the others show all of the page."""
    one = visit(bypass_csp=True, **LOOKS[look])  # axe is a script of its own
    tab = one.open(QUERY)
    expect(tab.locator("#speed-status")).to_contain_text("Measured in")
    expect(tab.locator("#polar svg")).to_be_visible()
    expect(tab.locator("#errors svg")).to_have_count(4)
    tab.screenshot(path=out / f"page-{look}.png", full_page=True)
    dark = tab.evaluate("getComputedStyle(document.documentElement).backgroundColor") == "rgb(16, 22, 26)"
    assert dark == (look == "dark")
    for details in tab.locator("details:not(.menu):not([open]) > summary").all():
        if details.is_visible():
            details.click()
    found = Axe().run(tab).response["violations"]
    serious = [(one["id"], one["nodes"][0]["html"]) for one in found if one["impact"] in ("serious", "critical")]
    assert serious == []
    assert tab.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_colours_follow_the_system_while_the_page_stands(visit):
    one = visit()
    tab = one.open("?model=lambert&techniques=uniform&angles=8&samples=1000")
    stroke = "all => all.map(p => p.getAttribute('stroke'))"
    assert "#000000" in tab.locator(".panel svg path").evaluate_all(stroke)
    tab.emulate_media(color_scheme="dark")
    expect(tab.locator(".panel svg path[stroke='#F2F2F2']").first).to_be_attached()
    assert "#000000" not in tab.locator(".panel svg path").evaluate_all(stroke)


def test_the_tab_key_reaches_every_control_in_order_from_a_skip_link(visit):
    tab = visit().open("?model=lambert&techniques=uniform&angles=8&samples=1000")
    reached = []
    for _ in range(60):
        tab.keyboard.press("Tab")
        reached.append(
            tab.evaluate("document.activeElement.id || document.activeElement.textContent.trim().slice(0, 20)")
        )
        if reached[-1] == "Figures of papers":
            break
    assert reached[0] == "Skip to the results"
    wanted = [
        "Copy as",
        "model",
        "parameter-albedo",
        "technique-uniform",
        "angles",
        "seed",
        "uniform",
        "angle",
        "measure",
    ]
    assert [name for name in reached if name in wanted] == wanted
