"""Pictures: PNG of the right size with ink on it, SVG with the words of the axes."""

import struct
import xml.etree.ElementTree as ET
import zlib

import pytest

from service.figures import roughness_chart
from service.formats import encode
from tests.service.formats.statistics_results import (
    a_result,
    awkward,
    one_series,
    paper_angles,
    roughness_sweep,
    six_techniques,
)


def png_size_and_shades(png):
    """Width, height and how many different bytes the picture's rows hold: a blank one holds a few."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", png[16:24])
    at, packed = 8, b""
    while at < len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        if png[at + 4 : at + 8] == b"IDAT":
            packed += png[at + 8 : at + 8 + length]
        at += 12 + length
    return width, height, len(set(zlib.decompress(packed)))


@pytest.mark.parametrize("result", [six_techniques(), six_techniques(1), awkward()])
def test_png_is_two_pixels_a_point_and_not_blank(result):
    width, height, shades = png_size_and_shades(encode(result, "png"))
    assert 2 * 3 * 270 < width < 2400
    assert height > 2 * 230
    assert shades > 100


def test_the_roughness_chart_is_a_picture_too():
    width, height, shades = png_size_and_shades(encode(roughness_sweep(count=16), "png", roughness_chart))
    assert 2 * 2 * 270 < width < 1600
    assert height > 2 * 2 * 230
    assert shades > 100


def test_svg_is_xml_with_the_titles_of_the_axes_and_the_techniques():
    root = ET.fromstring(encode(six_techniques(16), "svg"))
    words = {"".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {"variance of the weight", "largest weight", "mean weight", "view angle θo (degrees)"} <= words
    assert {"cosine", "cltc (infinite variance: sampled value)"} <= words
    assert {"0.1", "1", "10"} <= words
    # A letter that the font lacks (a subscript o) makes the drawing library take another font for the whole line.
    assert all(character < "\u0400" for word in words for character in word)


def test_four_thousand_angles_are_drawn():
    result = a_result([one_series("cosine", paper_angles(4096))])
    root = ET.fromstring(encode(result, "svg"))
    assert root.tag.endswith("svg")
