"""Options that commands share, and the scene they make up. Values are checked where scenes are parsed, not here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from service.errors import BadInput, Problem
from service.presets import with_preset

Command = Callable[..., Any]


def output_options(command: Command) -> Command:
    """--format and -o, of every command that prints a result."""
    for option in (
        click.option("--format", "format_", metavar="FORMAT", help="table, json, csv, npz, vega, png or svg."),
        click.option(
            "-o", "--output", "outputs", multiple=True, metavar="FILE",
            help="Write to FILE, in --format or in the format of its suffix; may be given more than once.",
        ),
        click.option("--device", metavar="NAME", help="Vulkan device by name; lavapipe unless given."),
    ):  # fmt: skip
        command = option(command)
    return command


def scene_options(command: Command) -> Command:
    """The options that make up a scene, with the names of its fields."""
    for option in reversed(
        (
            click.option(
                "--model", default="eon", show_default=True, metavar="NAME|FILE", help="The BRDF, own file, or all."
            ),
            click.option(
                "--set", "settings", multiple=True, metavar="NAME=V1,V2,...",
                help="Values of a parameter; several values sweep it, several sweeps form a product.",
            ),
            click.option("--preset", metavar="NAME", help="A material of a paper, in the place of --model."),
            click.option("--zip", "zips", multiple=True, metavar="NAME,NAME", help="Sweep these together."),
            click.option("--technique", "--techniques", metavar="NAME,...", help="Default: all made for the model."),
            click.option("--angles", metavar="N", help="N view angles from 0 to 89.91 degrees. Default: 64."),
            click.option("--theta-o-deg", metavar="A,B,...", help="View angles in degrees, 0 to below 90."),
            click.option("--phi-o-deg", metavar="A,B,...", help="View azimuths of an anisotropic model. Default: 0."),
            click.option("--statistics", metavar="NAME,...", help="Out of mean, variance, max_weight. Default: all."),
            click.option("--method", metavar="NAME", help="Estimator: mc, qmc or quadrature. Default: mc."),
            click.option("--tolerance", metavar="X", help="Pick method and count for this error of the variance."),
            click.option("--samples", metavar="N", help="Samples for each angle. Default: 1000000."),
            click.option("--seed", metavar="N", help="Seed of the random numbers. Default: 0."),
            click.option("--no-error-bars", is_flag=True, help="Leave standard errors out."),
            click.option("--no-reference", is_flag=True, help="Leave the float64 reference out."),
        )
    ):  # fmt: skip
        command = option(command)
    return command


def scene_data(
    *,
    model: str,
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
        model=model,
        parameters=dict(_setting(text) for text in settings),
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
    """A whole number; BadInput names the field."""
    try:
        return None if text is None else int(text)
    except ValueError:
        raise BadInput(Problem(field, text, "a whole number")) from None
