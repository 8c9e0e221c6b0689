"""The scene: what the controls change is drawn and stands in the address, and the address brings it back."""

from urllib.parse import parse_qs, urlsplit

from playwright.sync_api import expect

SCENE = "?model=eon&roughness=0.5&albedo=1&techniques=cosine,cltc-mis&angles=16&method=mc&samples=5000&seed=3"


def test_a_slider_redraws_while_it_moves_and_is_in_the_address_when_it_rests(visit):
    one = visit()
    tab = one.open(SCENE)
    address, lines = tab.url, one.lines()
    box = tab.get_by_label("roughness, slider").bounding_box()
    middle = box["y"] + box["height"] / 2
    tab.mouse.move(box["x"] + box["width"] / 2, middle)
    tab.mouse.down()
    tab.mouse.move(box["x"] + box["width"] - 2, middle, steps=4)
    expect(tab.get_by_label("roughness", exact=True)).to_have_value("1")
    assert changed(one, lines)
    assert tab.url == address
    tab.mouse.up()
    tab.wait_for_url("**roughness=1&**")
    one.done()


def test_a_slider_moves_by_keyboard(visit):
    one = visit()
    tab = one.open(SCENE)
    lines = one.lines()
    slider = tab.get_by_label("roughness, slider")
    slider.focus()
    slider.press("Home")
    expect(tab.get_by_label("roughness", exact=True)).to_have_value("0")
    tab.wait_for_url("**roughness=0&**")
    assert changed(one, lines)


def test_controls_say_what_the_catalogue_says(visit, server):
    tab = visit().open("?model=blinn-phong&angles=8&samples=1000")
    models = {one["name"]: one for one in server.client.get("/v1/catalogue").json()["models"]}
    assert tab.locator("#model option").count() == len(models)
    for name, declared in models["blinn-phong"]["parameters"].items():
        field = tab.locator(f"[data-field='parameters.{name}']")
        expect(field).to_contain_text(declared["help"])
        expect(field.get_by_role("textbox")).to_have_value(f"{declared['default']:g}")
    # The default lies in the middle of the slider's way, although its range goes to a million.
    assert 450 < int(tab.get_by_label("n, slider").input_value()) < 550


def test_a_link_brings_the_same_page_also_back_forward_and_reloaded(visit):
    one, other = visit(), visit()
    tab = one.open(SCENE + "&view.hide=cosine&view.at=60")
    first = one.lines(1)
    tab.get_by_label("Seed").fill("4")
    tab.get_by_label("Seed").press("Enter")
    tab.wait_for_url("**seed=4&**")
    # A draft is drawn: the whole is on its way, and the words of the one before are gone.
    assert comes(one, lambda: one.lines(1) != first)
    one.done()
    second = one.lines(1)
    assert second != first
    tab.go_back()
    expect(tab.get_by_label("Seed")).to_have_value("3")
    one.done()
    expect(tab.locator("body")).not_to_have_attribute("data-plotted", "0")
    assert settled(one, first)
    tab.go_forward()
    expect(tab.get_by_label("Seed")).to_have_value("4")
    assert settled(one, second)
    address = tab.url
    tab.reload()
    one.done()
    assert settled(one, second)
    copy = other.open(address.removeprefix(f"{other.url}/"))
    assert copy.url == address
    assert settled(other, second)
    expect(copy.get_by_role("button", name="cosine", exact=True)).to_have_attribute("aria-pressed", "false")
    expect(copy.locator("#angle-value")).to_have_text("59.94°")


def settled(one, lines) -> bool:
    """Whether the second panel comes to show these lines."""
    return comes(one, lambda: one.lines(1) == lines)


def changed(one, lines) -> bool:
    """Whether the first panel comes to show other lines than these."""
    return comes(one, lambda: one.lines() != lines)


def comes(one, holds) -> bool:
    for _ in range(600):
        if holds():
            return True
        one.tab.wait_for_timeout(50)
    return False


def test_a_wrong_value_is_explained_at_its_field(visit):
    one = visit()
    tab = one.open(SCENE)
    roughness = tab.get_by_label("roughness", exact=True)
    roughness.fill("7")
    roughness.press("Enter")
    error = tab.locator("[data-field='parameters.roughness'] .error")
    expect(error).to_have_text("7: allowed is 0 to 1")
    expect(roughness).to_have_attribute("aria-invalid", "true")
    expect(one.status).to_contain_text("see its fields")
    roughness.fill("0.25")
    roughness.press("Enter")
    expect(error).to_have_count(0)
    one.done()
    one.expect_complaints("status of 422")


def test_an_unknown_field_and_hostile_text_are_shown_as_text(visit):
    one = visit()
    one.tab.goto(f"{one.url}/{SCENE}&nonsense=<img src=x>&view.hide=<b>")
    expect(one.tab.locator("#scene-error")).to_contain_text("nonsense = <img src=x>: no field of this name")
    assert one.tab.locator("main img, form img").count() == 0
    one.expect_complaints("status of 422")


def test_several_values_sweep_a_parameter(visit):
    tab = visit().open(SCENE.replace("roughness=0.5", "roughness=0.25,1"))
    expect(tab.get_by_role("button", name="cltc-mis, roughness 0.25")).to_be_visible()
    assert tab.locator("#curves > li").count() == 4
    expect(tab.get_by_label("roughness, slider")).to_be_disabled()
    assert parse_qs(urlsplit(tab.url).query)["roughness"] == ["0.25,1"]


def test_another_model_brings_its_own_controls(visit):
    one = visit()
    tab = one.open(SCENE)
    tab.get_by_label("Model").select_option("ward")
    tab.wait_for_url("**model=ward&**")
    expect(tab.get_by_label("mx", exact=True)).to_be_visible()
    expect(tab.get_by_label("roughness", exact=True)).to_have_count(0)
    expect(tab.get_by_label("View azimuth (degrees)")).to_be_visible()
    expect(tab.locator("#curves")).to_contain_text("beckmann-half-vector")
    one.done()
