"""Options that commands share, and the scene they make up. Values are checked where scenes are parsed, not here."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from types import MappingProxyType
from typing import Any, TypeVar

import click

from service.catalogue import DEFAULT_MODEL
from service.errors import BadInput, Problem
from service.presets import with_preset

Command = Callable[..., Any]
Value = TypeVar("Value")
MOST_DIGITS = 30  # of a whole number: far beyond any that is allowed


def output_options(command: Command, formats: str = "table, json, csv, npz, vega, png, svg") -> Command:
    """--format and -o, of every command that prints a result; `formats` says in words which it has."""
    for option in (
        click.option("--format", "format_", metavar="FORMAT", help=f"Out of {formats}. Default: table."),
        click.option(
            "-o", "--output", "outputs", multiple=True, metavar="FILE",
            help="Write to FILE, in --format or in the format of its suffix; may be given more than once.",
        ),
        click.option("--device", metavar="NAME", help="Vulkan device by name; lavapipe unless given."),
    ):  # fmt: skip
        command = option(command)
    return command


report_option = click.option(
    "--report", "reports", multiple=True, metavar="FILE", help="Report card as .html, .json or .md; repeatable."
)

_SCENE: tuple[tuple[tuple[str, ...], dict[str, Any]], ...] = (
    (("--model",), {"metavar": "NAME|FILE", "help": f"A name, a .glsl file, or all. Default: {DEFAULT_MODEL}."}),
    (
        ("--set", "settings"),
        {
            "metavar": "NAME=V1,V2,...",
            "multiple": True,
            "help": "Values of a parameter; several values sweep it, several sweeps form a product.",
        },
    ),
    (("--preset",), {"metavar": "NAME", "help": "A material of a paper, in the place of --model."}),
    (("--zip", "zips"), {"metavar": "NAME,NAME", "multiple": True, "help": "Sweep these together."}),
    (
        ("--technique", "--techniques"),
        {"metavar": "NAME|FILE,...", "help": "Names, or .glsl files. Default: all made for the model."},
    ),
    (("--angles",), {"metavar": "N", "help": "N view angles from 0 to 89.91 degrees. Default: 64."}),
    (("--theta-o-deg",), {"metavar": "A,B,...", "help": "View angles in degrees, 0 to below 90."}),
    (("--phi-o-deg",), {"metavar": "A,B,...", "help": "View azimuths of an anisotropic model. Default: 0."}),
    (("--statistics",), {"metavar": "NAME,...", "help": "Out of mean, variance, max_weight. Default: all."}),
    (("--method",), {"metavar": "NAME", "help": "Estimator: mc, qmc or quadrature. Default: mc."}),
    (
        ("--tolerance",),
        {"metavar": "X", "help": "Pick method and count, in place of --samples, for this error of the variance."},
    ),
    (("--samples",), {"metavar": "N", "help": "Samples for each angle. Default: 1000000."}),
    (("--seed",), {"metavar": "N", "help": "Seed of the random numbers. Default: 0."}),
    (("--no-error-bars",), {"is_flag": True, "help": "Leave standard errors out."}),
    (("--no-reference",), {"is_flag": True, "help": "Leave the float64 reference out."}),
)


def scene_options(command: Command, helps: Mapping[str, str | None] = MappingProxyType({})) -> Command:
    """The options that make up a scene, with the names of its fields.

    `helps` has what a command says differently of an option; None hides one that plays no part in its answer, and is
    accepted so that one scene serves all commands.
    """
    for names, settings in reversed(_SCENE):
        text = helps.get(names[0], settings["help"])
        command = click.option(*names, **{**settings, "help": text, "hidden": text is None})(command)
    return command


def scene_data(
    *,
    model: str | None,
    settings: tuple[str, ...],
    zips: tuple[str, ...],
    preset: str | None,
    technique: str | None,
    angles: str | None,
    theta_o_deg: str | None,
    phi_o_deg: str | None,
    statistics: str | None,
    method: str | None,
    tolerance: str | None,
    samples: str | None,
    seed: str | None,
    no_error_bars: bool,
    no_reference: bool,
) -> dict[str, Any]:
    """A scene as plain data from the text of the options. What a field allows is checked where scenes are parsed."""
    if angles is not None and theta_o_deg is not None:
        raise BadInput(Problem("angles", angles, "either --angles or --theta-o-deg, not both"))
    if preset is not None and model is not None:
        raise BadInput(Problem("model", model, f"no value beside --preset {preset}, which names its model"))
    view: Any = None
    if angles is not None:
        view = {"count": integer("angles", angles)}
    elif theta_o_deg is not None:
        view = numbers("theta_o_deg", theta_o_deg)
    estimator = given(
        method=method,
        tolerance=number("tolerance", tolerance),
        samples=integer("samples", samples),
        seed=integer("seed", seed),
    )
    scene = given(
        model=model or DEFAULT_MODEL,
        parameters=settings_of(settings, _setting),
        zip=[names(text) for text in zips],
        techniques=names(technique),
        theta_o_deg=view,
        phi_o_deg=None if phi_o_deg is None else numbers("phi_o_deg", phi_o_deg),
        statistics=names(statistics),
        estimator=estimator,
        error_bars=not no_error_bars,
        reference=not no_reference,
    )
    return scene if preset is None else with_preset(preset, scene)


def given(**fields: Any) -> dict[str, Any]:
    """Only the fields that have a value."""
    return {name: value for name, value in fields.items() if value is not None}


def names(text: str | None) -> list[str] | None:
    """The names in a list separated by commas."""
    return None if text is None else [name.strip() for name in text.split(",")]


def settings_of(texts: Sequence[str], read: Callable[[str], tuple[str, Value]]) -> dict[str, Value]:
    """The values that --set gives, by name; BadInput for a name that comes twice."""
    found: dict[str, Value] = {}
    for text in texts:
        name, value = read(text)
        if name in found:
            raise BadInput(Problem("set", text, f"{name} once, with all its values: NAME=V1,V2,..."))
        found[name] = value
    return found


def _setting(text: str) -> tuple[str, list[float]]:
    name, equals, values = text.partition("=")
    if not equals or not name:
        raise BadInput(Problem("set", text, "NAME=VALUE or NAME=V1,V2,..."))
    return name.strip(), numbers(f"parameters.{name.strip()}", values)


def numbers(field: str, text: str) -> list[float]:
    """The numbers in a list separated by commas; BadInput names the field."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise BadInput(Problem(field, text, "a number or numbers separated by commas")) from None


def number(field: str, text: str | None) -> float | None:
    """A number; BadInput names the field."""
    try:
        return None if text is None else float(text)
    except ValueError:
        raise BadInput(Problem(field, text, "a number")) from None


def integer(field: str, text: str | None) -> int | None:
    """A whole number, which may be written as 1e6; BadInput names the field."""
    try:
        return None if text is None else _whole(text)
    except (ValueError, ArithmeticError):
        raise BadInput(Problem(field, text, "a whole number")) from None


def _whole(text: str) -> int:
    value = Decimal(text)
    if not value.is_finite() or value.adjusted() > MOST_DIGITS or value != value.to_integral_value():
        raise ValueError(text)
    return int(value)
