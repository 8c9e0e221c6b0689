"""The page as it comes: soon, from this server alone, under a strict policy."""

import re
from html.parser import HTMLParser
from pathlib import Path

from playwright.sync_api import expect

import service
from service.figures.style import technique_styles

FILES = Path(service.__file__).parent / "page"


def test_the_first_plot_comes_within_two_seconds_of_the_load(visit):
    """The best of some loads on a warm server: on a busy machine any one may be late."""
    one = visit()
    found = []
    while len(found) < 8 and min(found, default=9e9) > 2000:
        one.open()
        found.append(one.tab.evaluate("performance.getEntriesByName('plotted')[0].startTime"))
    assert min(found) < 2000
    assert all(panel.locator("svg path").count() > 10 for panel in one.tab.locator(".panel").all())


def test_three_panels_show_every_technique_with_a_verdict_in_words(visit):
    one = visit()
    tab = one.open("?model=eon&roughness=1&samples=50000")
    panels = [panel.get_attribute("aria-label") for panel in tab.locator("#panels .panel").all()]
    assert [text.split(" over")[0] for text in panels] == ["variance of the weight", "largest weight", "mean weight"]
    assert all("cltc-mis" in text for text in panels)
    curves = tab.locator("#curves > li")
    assert curves.count() == 6
    verdict = curves.filter(has=tab.locator("button", has_text="cltc")).filter(has_text="infinite-variance").first
    expect(verdict).to_contain_text("the weight has no variance")
    verdict.locator("summary").first.click()
    expect(verdict.locator("dd").first).to_contain_text("values, 0° to 89.91°")


def test_a_file_of_the_page_is_compressed_tagged_and_under_a_policy_without_eval(server):
    for path in ("/", "/page/main.js", "/page/vega-embed.js"):
        reply = server.client.get(path)
        policy = dict(part.strip().split(" ", 1) for part in reply.headers["content-security-policy"].split(";"))
        assert policy["default-src"] == "'none'"
        assert policy["script-src"] == policy["style-src"] == "'self'"
        assert reply.headers["content-encoding"] == "gzip"
        again = server.client.get(path, headers={"if-none-match": reply.headers["etag"]})
        assert (again.status_code, again.content) == (304, b"")
        plain = server.client.get(path, headers={"accept-encoding": "identity"})
        assert plain.content == reply.content
        assert plain.headers["etag"] != reply.headers["etag"]
    assert server.client.get("/page/..%2Fcatalogue.py").status_code == 404
    assert server.client.get("/page/nothing.js").json()["detail"].startswith("the page has no file of this name")


def test_every_module_is_loaded_ahead_and_nothing_comes_from_elsewhere():
    """One list in the HTML spares a chain of requests; this keeps it whole."""
    found: list[dict] = []

    class Links(HTMLParser):
        def handle_starttag(self, tag, attributes):
            found.append({"tag": tag, **dict(attributes)})
            assert "style" not in found[-1]
            assert not any(name.startswith("on") for name in found[-1])

    Links().feed((FILES / "index.html").read_text())
    preloaded = {one["href"] for one in found if one.get("rel") == "modulepreload"}
    assert preloaded == {f"/page/{path.name}" for path in FILES.glob("*.js")} - {"/page/main.js"} | {
        "/page/vega-embed.js"
    }
    addresses = [one[name] for one in found for name in ("href", "src") if name in one]
    assert all(address.startswith(("/", "#")) and not address.startswith("//") for address in addresses)


def test_colours_are_those_of_the_figures_with_enough_contrast_in_light_and_dark():
    """WCAG 2.2, 1.4.11: what is needed to understand a graphic has a contrast of 3:1."""
    theme = (FILES / "theme.js").read_text()
    for name in ("cosine", "uniform", "ltc-nonnegative", "ltc", "cltc", "cltc-mis"):
        ((colour, _),) = technique_styles([name])
        key = f'"{name}"' if "-" in name else name
        assert f'{key}: ["{colour}"' in theme
    others = [colour for colour, _ in technique_styles([f"unknown-{k}" for k in range(6)])]
    assert re.findall(r"#\w{6}", theme.split("OTHERS =")[1].split(";")[0]) == others
    sheet = re.search(r"--sheet: light-dark\((#\w{6}), (#\w{6})\)", (FILES / "page.css").read_text()).groups()
    pairs = re.findall(r'"#\w{6}": \["(#\w{6})", "(#\w{6})"\]', theme)
    assert len(pairs) == 10
    assert all(contrast(on, ground) >= 3 for pair in pairs for on, ground in zip(pair, sheet, strict=True))


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours (WCAG 2.2, relative luminance of sRGB)."""

    def luminance(colour: str) -> float:
        channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)
