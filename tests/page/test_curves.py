"""What the plots show: the numbers of the service, at the angle under the pointer, for the curves that are shown."""

import math
import re

import pytest
from playwright.sync_api import expect

QUERY = "model=eon&roughness=0.5&albedo=0.8&techniques=cosine,ltc,cltc-mis&angles=16&method=mc&samples=20000&seed=7"


@pytest.fixture
def result(server):
    """What the service answers to the scene of these tests."""
    reply = server.client.get(f"/v1/statistics?{QUERY}")
    if reply.status_code == 202:
        server.await_job(reply.headers["location"])
        reply = server.client.get(f"/v1/statistics?{QUERY}")
    return reply.json()


@pytest.fixture(scope="module")
def tab(long_visit):
    return long_visit().open(f"?{QUERY}")


def over(tab, panel: int, share: float):
    """Move the pointer over a panel, to a share of the width of its axes."""
    box = tab.locator("#panels .panel").nth(panel).locator("svg .background").first.bounding_box()
    tab.mouse.move(box["x"] + share * box["width"], box["y"] + box["height"] / 2)


def test_hover_shows_the_values_of_the_service_at_the_nearest_angle(tab, result):
    angles = result["series"][0]["theta_o_deg"]
    over(tab, 0, angles[10] / 90)
    hover = tab.locator("#hover")
    expect(hover).to_contain_text(f"variance of the weight at {round(angles[10], 2):g}°")
    for one in result["series"]:
        line = hover.locator("div", has=tab.get_by_text(one["technique"], exact=True)).locator("b")
        shown = float(line.inner_text().split(" ")[0])
        assert math.isclose(shown, one["variance"][10], rel_tol=0.05)
    tab.mouse.move(5, 5)
    expect(hover).to_be_hidden()


def test_a_click_shows_values_and_polar_picture_at_that_angle(tab, result):
    polar = tab.locator("#polar")
    angle = result["series"][0]["theta_o_deg"][12]
    over(tab, 1, angle / 90)
    tab.mouse.down()
    tab.mouse.up()
    tab.wait_for_url(f"**view.at={angle:g}*")
    words = f"Polar picture at view angle {angle:.2f} degrees: the BRDF times cosine, and the densities of "
    expect(polar).to_have_attribute("aria-label", f"{words}cosine, ltc, cltc-mis.")
    cell = tab.locator("#values tbody tr").filter(has_text="cltc-mis").locator("td").first
    found = result["series"][2]
    text, exact = re.fullmatch(r"(.*)\s*exact (.*)", cell.inner_text(), re.DOTALL).groups()
    assert float(exact) == pytest.approx(found["reference"]["variance"][12], rel=1e-3)
    value, error = map(float, text.split(" ± "))
    assert value == pytest.approx(found["variance"][12], abs=found["variance_stderr"][12])
    assert error == pytest.approx(found["variance_stderr"][12], rel=0.05)
    infinite = tab.locator("#values tbody tr").filter(has_text="ltc").filter(has_not_text="cltc").locator("td").first
    expect(infinite).to_contain_text("exact ∞")


def test_hover_over_the_polar_picture_shows_the_densities_in_that_direction(tab, server):
    tab.get_by_label("View angle θo").press("Home")
    expect(tab.locator("#polar")).to_have_attribute("aria-label", re.compile("at view angle 0.00 degrees"))
    box = tab.locator("#polar svg").bounding_box()
    tab.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    hover = tab.locator("#hover")
    angle = float(re.search(r"light angle (-?[\d.]+)°", hover.inner_text()).group(1))
    assert abs(angle) <= 1
    cosine = hover.locator("div", has=tab.get_by_text("cosine", exact=True)).locator("b")
    assert float(cosine.inner_text()) == pytest.approx(math.cos(math.radians(angle)) / math.pi, rel=1e-3)
    tab.mouse.move(5, 5)
    expect(hover).to_be_hidden()


def test_the_angle_moves_by_keyboard_alone(tab, result):
    slider = tab.get_by_label("View angle θo")
    slider.focus()
    slider.press("Home")
    for _ in range(3):
        slider.press("ArrowRight")
    angle = result["series"][0]["theta_o_deg"][3]
    expect(tab.locator("#angle-value")).to_have_text(f"{round(angle, 2):g}°")
    expect(slider).to_have_attribute("aria-valuetext", f"{round(angle, 2):g}°")
    expect(tab.locator("#values caption")).to_have_text(f"Values at {round(angle, 2):g}°")


def test_the_button_of_a_curve_hides_it_everywhere(visit):
    one = visit()
    tab = one.open(f"?{QUERY}")
    before = len(one.lines())
    button = tab.get_by_role("button", name="ltc", exact=True)
    expect(button).to_have_attribute("aria-pressed", "true")
    button.focus()
    tab.keyboard.press("Enter")
    expect(button).to_have_attribute("aria-pressed", "false")
    expect(button).to_be_focused()
    expect(tab.locator("#panels .panel").first).not_to_have_attribute("aria-label", "*ltc;*")
    expect(tab.locator("#values tbody tr")).to_have_count(2)
    assert len(one.lines()) < before
    tab.wait_for_url("**view.hide=ltc*")
