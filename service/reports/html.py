"""A report card as one HTML file without anything to load: tables, failures with their replay, and plots as SVG."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

from service.reports import plots
from service.reports.markdown import group_title, title

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; margin: .6rem 0 1.4rem; }
td, th { border-bottom: 1px solid #ddd; padding: .3rem .7rem; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
.pass { color: #1a7f37; } .fail { color: #b3261e; font-weight: 600; } .not-applicable { color: #777; }
pre { background: #f5f5f5; padding: .6rem .8rem; overflow-x: auto; font-size: 13px; }
figure { display: inline-block; margin: 0 1.5rem 1rem 0; } figcaption { color: #555; font-size: 13px; max-width:
26rem; }
.power { color: #666; font-size: 13px; }
"""


def render(result: Mapping[str, Any]) -> str:
    """The card of a result of kind `check` or `stability`."""
    heading = f"{escape(title(result))}: <span class='{result['status']}'>{result['status']}</span>"
    body = [f"<h1>{heading}</h1>", *_body(result), f"<p class='power'>{escape(_run(result['run']))}</p>"]
    return (
        "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'>"
        f"<title>{escape(title(result))}</title><style>{_STYLE}</style></head>\n<body>\n"
        + "\n".join(body)
        + "\n</body></html>\n"
    )


def _body(result: Mapping[str, Any]) -> Iterator[str]:
    if result["kind"] == "check":
        for group in dict.fromkeys(check["technique"] for check in result["checks"]):
            checks = [check for check in result["checks"] if check["technique"] == group]
            yield f"<h2>{escape(group_title(result, group).replace('`', ''))}</h2>"
            yield _table(["check", "verdict", "what was found"], [_row(check) for check in checks])
            for check in checks:
                yield from _evidence(check)
    stability = result if result["kind"] == "stability" else result.get("stability")
    if stability:
        yield from _stability(stability)


def _row(check: Mapping[str, Any]) -> list[str]:
    words = f"{escape(check['message'])}<div class='power'>{escape(check['power'])}</div>"
    return [escape(check["name"]), f"<span class='{check['status']}'>{check['status']}</span>", words]


def _evidence(check: Mapping[str, Any]) -> Iterator[str]:
    """Plots of a check, and the replay of a failure."""
    failed = check["status"] == "fail"
    for caption, svg in plots.of_check(check):
        yield f"<figure>{svg}<figcaption>{escape(check['name'])}: {escape(caption)}</figcaption></figure>"
    if failed and check["replay"]:
        yield f"<h3>{escape(check['name'])}</h3><p>{escape(check['message'])}</p>"
        yield f"<pre>{escape(check['replay'].get('command', ''))}</pre>"


def _stability(stability: Mapping[str, Any]) -> Iterator[str]:
    yield "<h2>Edge grid: float32 against float64</h2>"
    yield _table(
        ["technique", "verdict", "what was found"],
        [
            [escape(c["technique"]), f"<span class='{c['status']}'>{c['status']}</span>", escape(c["message"])]
            for c in stability["checks"]
        ],
    )
    yield _table(
        [
            "technique",
            "quantity",
            "points beyond 8 ulp",
            "worst, ulp",
            "by rounded inputs, ulp",
            "by a rounded direction, ulp",
            "reason",
        ],
        [
            [
                escape(e["technique"]),
                escape(e["quantity"]),
                f"{e['points']:,}",
                f"{e['worst_ulp']:.3g}",
                f"{e['by_rounded_inputs_ulp']:.3g}",
                "" if e["by_rounded_direction_ulp"] is None else f"{e['by_rounded_direction_ulp']:.3g}",
                escape(e["reason"]),
            ]
            for e in stability["exceptions"]
        ],
        numbers=range(2, 6),
    )


def _table(columns: list[str], rows: list[list[str]], numbers: range = range(0)) -> str:
    head = "".join(f"<th>{escape(column)}</th>" for column in columns)
    body = "".join(
        "<tr>"
        + "".join(f"<td{' class=number' if i in numbers else ''}>{cell}</td>" for i, cell in enumerate(row))
        + "</tr>"
        for row in rows
    )
    return f"<table><tr>{head}</tr>{body}</table>"


def _run(run: Mapping[str, Any]) -> str:
    seed = f", seed {run['seed']}" + (", quick, at lower power" if run["quick"] else "") if "seed" in run else ""
    return f"{run['device']}, {run['driver']}, {run['elapsed_ms'] / 1e3:.1f} s{seed}"
