"""How charts look: colours and dashes of the techniques, fonts, sizes.

Line styles follow Figure 11 of Portsmouth, Kutz and Hill, "EON: A Practical Energy-Preserving Rough Diffuse BRDF"
(2024); its red, blue and green are those of Okabe and Ito, which readers with any colour vision tell apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

Dash = tuple[float, ...]
Style = tuple[str, Dash]

SOLID: Dash = (1, 0)
DOTTED: Dash = (2, 2.5)
DASHED: Dash = (7, 3)

_STYLES: dict[str, Style] = {
    "cosine": ("#D55E00", SOLID),
    "uniform": ("#000000", DOTTED),
    "ltc-nonnegative": ("#0072B2", DOTTED),
    "ltc": ("#0072B2", SOLID),
    "cltc": ("#009E73", DASHED),
    "cltc-mis": ("#009E73", SOLID),
}
_OTHER_COLOURS = ("#CC79A7", "#E69F00", "#56B4E9", "#6A3D9A", "#8C6D31", "#7F7F7F")
_OTHER_DASHES = (SOLID, DASHED, DOTTED)

GREY = "#444444"
PANEL_WIDTH, PANEL_HEIGHT = 270, 230


def technique_styles(techniques: Sequence[str]) -> list[Style]:
    """Colour and dash of each technique; one without a style of its own gets the next free colour."""
    unknown = [name for name in techniques if name not in _STYLES]
    others = {
        name: (_OTHER_COLOURS[index % len(_OTHER_COLOURS)], _OTHER_DASHES[index // len(_OTHER_COLOURS) % 3])
        for index, name in enumerate(dict.fromkeys(unknown))
    }
    return [_STYLES.get(name) or others[name] for name in techniques]


def config() -> dict[str, Any]:
    """The Vega-Lite config of every chart."""
    ink, faint = "#222222", "#E4E4E4"
    return {
        # The first family is the one that vl-convert carries, the others are its like in browsers.
        "font": "Liberation Sans, Arial, Helvetica, sans-serif",
        "background": "white",
        "padding": 12,
        "view": {"stroke": "#999999", "strokeWidth": 0.8},
        "axis": {
            "labelFontSize": 11,
            "titleFontSize": 12,
            "titleFontWeight": "normal",
            "labelColor": ink,
            "titleColor": ink,
            "titlePadding": 8,
            "domain": False,
            "tickColor": "#999999",
            "tickSize": 4,
            "gridColor": faint,
            "gridWidth": 0.7,
            "labelFlush": False,
        },
        "axisY": {"minExtent": 34},
        "legend": {
            "orient": "bottom",
            "labelFontSize": 11.5,
            "titleFontSize": 11.5,
            "titleFontWeight": "normal",
            "labelColor": ink,
            "titleColor": ink,
            "labelLimit": 0,
            "symbolSize": 900,
            "symbolStrokeWidth": 2,
            "symbolType": "stroke",
            "symbolOpacity": 1,
            "columnPadding": 22,
            "rowPadding": 3,
            "offset": 14,
        },
        "title": {
            "anchor": "start",
            "fontSize": 15,
            "fontWeight": 600,
            "color": ink,
            "subtitleFontSize": 11.5,
            "subtitleColor": "#555555",
            "subtitlePadding": 5,
            "subtitleLineHeight": 15,
            "offset": 14,
        },
        "concat": {"spacing": 26},
        "line": {"strokeCap": "butt", "strokeJoin": "round"},
    }


def part_title(text: str) -> dict[str, Any]:
    """The title of a row or a column of panels."""
    return {"text": text, "anchor": "start", "fontSize": 12.5, "fontWeight": 600, "offset": 8}


# Viridis without its yellow end, which is faint on white: (position, red, green, blue).
_VIRIDIS = (
    (0.0, 68, 1, 84),
    (0.25, 61, 77, 138),
    (0.5, 36, 132, 142),
    (0.75, 53, 183, 121),
    (1.0, 160, 208, 40),
)


def sequence(count: int) -> list[str]:
    """`count` colours from dark to light, evenly spaced, for values that have an order."""
    return [_viridis(index / max(count - 1, 1)) for index in range(count)]


def _viridis(position: float) -> str:
    for (start, *low), (end, *high) in pairwise(_VIRIDIS):
        if position <= end:
            part = (position - start) / (end - start)
            mixed = [round(a + part * (b - a)) for a, b in zip(low, high, strict=True)]
            return "#" + "".join(f"{channel:02X}" for channel in mixed)
    raise ValueError(f"a position in the sequence is within 0 and 1, not {position}")
