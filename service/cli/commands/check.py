"""samplerscope check"""

from __future__ import annotations

from functools import partial
from typing import Any

import click

from service.cli.delivery import StageLine, deliver, deliver_with_reports
from service.cli.options import integer, names, output_options, report_option, settings_of
from service.cli.own_file import own_texts
from service.errors import BadInput, Problem


@click.command(short_help="Is it right at all: the whole battery on one file or name.")
@click.argument("subject")
@click.option("--model", metavar="NAME|FILE", help="Model for a technique. Default: eon, or the first it is made for.")
@click.option(
    "--technique", "--techniques", metavar="NAME|FILE,...", help="Techniques for a model. Default: cosine,uniform."
)
@click.option("--set", "settings", multiple=True, metavar="NAME=VALUE", help="Fix a parameter, which is swept else.")
@click.option("--quick", is_flag=True, help="A few seconds, at the lower power that each check states.")
@click.option("--seed", metavar="N", help="Seed of the random numbers. Default: 0.")
@report_option
@click.option("--wo", metavar="X,Y,Z", help="Replay: evaluate once for this view, as numbers or float bits.")
@click.option("--u", "u", metavar="U1,U2", help="Replay: the random numbers.")
@click.option("--wi", metavar="X,Y,Z", help="Replay: the direction, in place of random numbers.")
@partial(output_options, formats="table, json, csv")
def check(
    subject: str,
    model: str | None,
    technique: str | None,
    settings: tuple[str, ...],
    quick: bool,
    seed: str | None,
    reports: tuple[str, ...],
    wo: str | None,
    u: str | None,
    wi: str | None,
    format_: str | None,
    outputs: tuple[str, ...],
    device: str | None,
) -> None:
    """The whole battery on SUBJECT: a model or technique, as a .glsl file or by its name in the catalogue.

    Exits with 1 where a check failed. A failure names the command that evaluates its exact inputs again.
    """
    arguments: dict[str, Any] = {
        "subject": subject,
        "model": model,
        "techniques": names(technique),
        "fixed": settings_of(settings, _fixed),
        "device": device,
        "quick": quick,
        "seed": _seed(seed),
    }
    if wo is not None:
        arguments |= _replay_inputs(wo, u, wi)
        deliver("replay", lambda: _run("replay", arguments), format_, outputs)
        return
    if u is not None or wi is not None:
        raise BadInput(Problem("wo", None, "a view, where --u or --wi is given"))
    deliver_with_reports("check", lambda: _run("check", arguments), reports, format_, outputs)


def _run(task: str, arguments: dict[str, Any]) -> dict[str, Any]:
    """A user's file runs in a process of its own; an entry of the catalogue here."""
    from service.isolation import run_isolated

    files = own_texts([arguments["subject"], arguments["model"], *(arguments["techniques"] or [])])
    with StageLine() as progress:
        if files:
            return run_isolated(task, arguments | {"files": files}, progress)
        from service.isolation.tasks import TASKS, stay_open

        return TASKS[task](arguments | {"files": files}, progress, stay_open)


def _replay_inputs(wo: str, u: str | None, wi: str | None) -> dict[str, Any]:
    from service.checks.replaying import parse_floats

    if (u is None) == (wi is None):
        raise BadInput(Problem("u", u, "either --u or --wi together with --wo"))
    return {
        "wo": parse_floats("wo", wo, 3),
        "u": None if u is None else parse_floats("u", u, 2),
        "wi": None if wi is None else parse_floats("wi", wi, 3),
    }


def _fixed(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        raise BadInput(Problem("set", text, "NAME=VALUE")) from None


def _seed(text: str | None) -> int:
    value = integer("seed", text) or 0
    if not 0 <= value < 2**63:
        raise BadInput(Problem("seed", value, "a whole number, 0 to 2^63 - 1"))
    return value
