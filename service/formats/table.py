"""Statistics as text for a terminal: mean weight, variance and max weight over the view angle, then a summary."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from typing import Any

from service.formats.metrology import plain, uncertain
from service.formats.series import Series, read, swept, swept_value
from service.formats.table_summary import legend, run_lines, summary

WIDTH = 120
MOST_COLUMNS = 7
_GAP = "  "
_BETWEEN = "   |   "
_LONGEST_NAME = 40
_PANELS = (("mean", "mean weight"), ("variance", "variance"), ("max_weight", "max weight"))


def statistics_table(result: Mapping[str, Any], width: int = WIDTH) -> str:
    """The text of a result of kind "statistics", at most `width` columns wide, without colour.

    Rows are view angles in degrees, columns are series. Values carry their standard error in units of the last digit.
    """
    series = read(result)
    names = swept(series)
    panels = [
        (title, [_column(one, statistic, names) for one in series])
        for statistic, title in _PANELS
        if any(one.values(statistic) is not None for one in series)
    ]
    parts = [f"throughput weight of {_question(series, names)}"] if series else ["no series"]
    parts += _tables(panels, _head_column(series, names), width)
    parts += [text for text in (legend(series, names, width), summary(series, names, width)) if text]
    parts.append(run_lines(result, width))
    return "\n\n".join(parts) + "\n"


def _question(series: Sequence[Series], names: Sequence[str]) -> str:
    fixed = [f"{name} {value:.6g}" for name, value in series[0].parameters.items() if name not in names]
    return ", ".join([series[0].model, *fixed])


def _head_column(series: Sequence[Series], names: Sequence[str]) -> list[str]:
    return ["theta_o_deg", *names, *(angle_texts(series[0].theta_o_deg) if series else [])]


def angle_texts(angles: Sequence[float]) -> list[str]:
    """Angles in degrees with as few decimals as keep them apart, near their value and below 90."""
    for decimals in range(7):
        texts = [f"{angle:.{decimals}f}" for angle in angles]
        near = all(abs(float(text) - angle) < 0.005 for text, angle in zip(texts, angles, strict=True))
        if near and len(set(texts)) == len(set(angles)) and all(float(text) < 90 for text in texts):
            return texts
    texts = [f"{angle:.10g}" for angle in angles]
    return [text if float(text) < 90 else repr(float(angle)) for text, angle in zip(texts, angles, strict=True)]


def _column(one: Series, statistic: str, names: Sequence[str]) -> list[str]:
    technique = one.technique
    if len(technique) > _LONGEST_NAME:
        technique = technique[: _LONGEST_NAME - 3] + "..."
    return [technique, *(swept_value(one, name) for name in names), *cells(one, statistic)]


def cells(one: Series, statistic: str) -> list[str]:
    """The cell of each angle: `-` for a null, `inf [x]` for a sampled variance x that has no limit.

    A max weight stands before its supremum, `12.3 / 57.3`, where the reference has one.
    """
    nothing = [None] * len(one.theta_o_deg)
    values = one.values(statistic) or nothing
    if statistic == "max_weight":
        sampled = _aligned(["-" if value is None else plain(value) for value in values])
        suprema = [
            "inf" if endless else "" if value is None else plain(value)
            for value, endless in zip(one.reference(statistic) or nothing, one.unbounded_weight, strict=True)
        ]
        if not any(suprema):
            return sampled
        tops = _aligned([text or "-" for text in suprema])
        return [f"{value} / {top}" for value, top in zip(sampled, tops, strict=True)]
    errors = one.values(f"{statistic}_stderr") or nothing
    texts = [
        # A mean without error bar is that of a technique without variance; its bias shows in the later digits.
        plain(value, 6) if statistic == "mean" and value is not None and error is None else _cell(value, error, endless)
        for value, error, endless in zip(values, errors, one.no_limit(statistic), strict=True)
    ]
    return _aligned(texts)


def _aligned(texts: Sequence[str]) -> list[str]:
    """The texts, all of one width, with their decimal points below one another."""
    whole = [len(re.split(r"[.(e ]", text)[0]) for text in texts]
    widest = max(whole, default=0)
    shifted = [" " * (widest - size) + text for text, size in zip(texts, whole, strict=True)]
    size = max(map(len, shifted), default=0)
    return [text.ljust(size) for text in shifted]


def _cell(value: float | None, error: float | None, endless: bool) -> str:
    if endless:
        return "inf" if value is None else f"inf [{plain(value, 3)}]"
    return "-" if value is None else uncertain(value, error)


def _tables(panels: Sequence[tuple[str, list[list[str]]]], head: list[str], width: int) -> list[str]:
    """The panels as blocks of text: beside one another where they fit, else below, split where too wide."""
    blocks = [_block(title, columns, head) for title, columns in panels]
    if blocks and all(len(columns) <= MOST_COLUMNS for _, columns in panels):
        rows = [_BETWEEN.join(cells) for cells in zip(*blocks, strict=True)]
        if len(blocks[0]) and len(rows[0]) <= width:
            return ["\n".join(row.rstrip() for row in rows)]
    return [
        "\n".join(row.rstrip() for row in _block(title, group, head))
        for title, columns in panels
        for group in _groups(columns, head, width)
    ]


def _groups(columns: list[list[str]], head: list[str], width: int) -> list[list[list[str]]]:
    # The techniques of one set of parameter values stay together where the limit allows it.
    techniques = len({column[0] for column in columns})
    most = MOST_COLUMNS // techniques * techniques or MOST_COLUMNS
    groups: list[list[list[str]]] = [[]]
    used = start = max(map(len, head))
    for column in columns:
        size = len(_GAP) + max(map(len, column))
        if groups[-1] and (used + size > width or len(groups[-1]) == most):
            groups.append([])
            used = start
        groups[-1].append(column)
        used += size
    return groups


def _block(title: str, columns: list[list[str]], head: list[str]) -> list[str]:
    """The lines of one panel, all of one width."""
    whole = [head, *columns]
    sizes = [max(map(len, column)) for column in whole]
    lines = [
        _GAP.join(cell.rjust(size) for cell, size in zip(row, sizes, strict=True))
        for row in zip_longest(*whole, fillvalue="")
    ]
    wide = max(len(title), len(lines[0]))
    heads = sum(not _is_number(cell) for cell in head)
    lines.insert(heads, "-" * len(lines[0]))
    return [title.ljust(wide), *(line.rjust(wide) for line in lines)]


def _is_number(text: str) -> bool:
    return text[:1].isdigit()
