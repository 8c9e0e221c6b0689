"""The command line. It parses options into a scene and prints results; all logic is elsewhere.

Exit codes: 0 fine, 2 bad input, 3 no device. Results go to stdout, progress and errors to stderr. Imports inside the
commands keep the start short: a small scene should be answered before a plotting library would have loaded.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from service.errors import BadInput, Problem, SamplerscopeError

if TYPE_CHECKING:
    from service.statistics import Progress

EXIT_BAD_INPUT = 2
EXIT_NO_DEVICE = 3
EXIT_INTERRUPTED = 130

Command = Callable[..., Any]


def main() -> None:
    """Entry point of the command `samplerscope`: every error becomes one line on stderr and an exit code."""
    from lavapipe import CompileError, LavapipeError

    try:
        cli.main(standalone_mode=False)
    except click.ClickException as error:
        _fail(error.format_message(), EXIT_BAD_INPUT)
    except (click.Abort, KeyboardInterrupt):
        _fail("interrupted", EXIT_INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()
    except (CompileError, SamplerscopeError, OSError) as error:
        _fail(str(error), EXIT_BAD_INPUT)
    except LavapipeError as error:
        _fail(str(error), EXIT_NO_DEVICE)


def _fail(message: str, code: int) -> None:
    click.echo(f"samplerscope: {message}", err=True)
    sys.exit(code)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="samplerscope", prog_name="samplerscope")
def cli() -> None:
    """How noisy, how right and how fast a BRDF sampler is: its own GLSL, run on Vulkan compute."""


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
            click.option("--model", default="eon", show_default=True, metavar="NAME", help="The BRDF."),
            click.option(
                "--set", "settings", multiple=True, metavar="NAME=V1,V2,...",
                help="Values of a parameter; several values sweep it, several sweeps form a product.",
            ),
            click.option("--zip", "zips", multiple=True, metavar="NAME,NAME", help="Sweep these together."),
            click.option("--technique", "--techniques", metavar="NAME,...", help="Default: all made for the model."),
            click.option("--angles", metavar="N", help="N view angles from 0 to 89.91 degrees. Default: 64."),
            click.option("--theta-o-deg", metavar="A,B,...", help="View angles in degrees, 0 to below 90."),
            click.option("--statistics", metavar="NAME,...", help="Out of mean, variance, max_weight. Default: all."),
            click.option("--method", metavar="NAME", help="Estimator: mc."),
            click.option("--samples", metavar="N", help="Samples for each angle. Default: 1000000."),
            click.option("--seed", metavar="N", help="Seed of the random numbers. Default: 0."),
            click.option("--no-error-bars", is_flag=True, help="Leave standard errors out."),
            click.option("--no-reference", is_flag=True, help="Leave the float64 reference out."),
        )
    ):  # fmt: skip
        command = option(command)
    return command


@cli.command()
@output_options
def info(format_: str | None, outputs: tuple[str, ...], device: str | None) -> None:
    """Device, driver, versions and the catalogue."""
    from service.information import describe

    _deliver(lambda: describe(device), format_, outputs)


@cli.command()
@scene_options
@output_options
def stats(format_: str | None, outputs: tuple[str, ...], device: str | None, **options: Any) -> None:
    """Mean, variance and largest weight of techniques across view angles."""
    from service.scene import parse_scene

    scene = parse_scene(scene_data(**options))
    _deliver(lambda: _statistics(scene, device), format_, outputs)


@cli.command()
@click.argument("name")
@click.option("--samples", metavar="N", help="Samples for each angle, in place of the figure's own number.")
@click.option("--seed", metavar="N", help="Seed of the random numbers.")
@output_options
def figure(
    name: str,
    samples: str | None,
    seed: str | None,
    format_: str | None,
    outputs: tuple[str, ...],
    device: str | None,
) -> None:
    """A figure of a paper, by name: eon-11, eon-13."""
    from service.papers import figure_scene, paper_figure

    paper = paper_figure(name)
    scene = figure_scene(paper, **_given(samples=_integer("samples", samples), seed=_integer("seed", seed)))
    _deliver(lambda: _statistics(scene, device), format_, outputs, chart=paper.chart)


def scene_data(
    *,
    model: str,
    settings: tuple[str, ...],
    zips: tuple[str, ...],
    technique: str | None,
    angles: str | None,
    theta_o_deg: str | None,
    statistics: str | None,
    method: str | None,
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
        view = {"count": _integer("angles", angles)}
    elif theta_o_deg is not None:
        view = _numbers("theta_o_deg", theta_o_deg)
    estimator = _given(method=method, samples=_integer("samples", samples), seed=_integer("seed", seed))
    return _given(
        model=model,
        parameters=dict(_setting(text) for text in settings),
        zip=[_names(text) for text in zips],
        techniques=_names(technique),
        theta_o_deg=view,
        statistics=_names(statistics),
        estimator=estimator,
        error_bars=not no_error_bars,
        reference=not no_reference,
    )


def _given(**fields: Any) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if value is not None}


def _names(text: str | None) -> list[str] | None:
    return None if text is None else [name.strip() for name in text.split(",")]


def _setting(text: str) -> tuple[str, list[float]]:
    name, equals, values = text.partition("=")
    if not equals or not name:
        raise BadInput(Problem("set", text, "NAME=VALUE or NAME=V1,V2,..."))
    return name.strip(), _numbers(f"parameters.{name.strip()}", values)


def _numbers(field: str, text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise BadInput(Problem(field, text, "a number or numbers separated by commas")) from None


def _integer(field: str, text: str | None) -> int | None:
    try:
        return None if text is None else int(text)
    except ValueError:
        raise BadInput(Problem(field, text, "a whole number")) from None


def _statistics(scene: Any, device: str | None) -> dict[str, Any]:
    from service.catalogue import load_catalogue
    from service.engine import Engine
    from service.scene import resolve
    from service.statistics import compute_statistics

    question = resolve(scene, load_catalogue())
    with Engine.open(device=device) as engine, ProgressLine() as progress:
        return compute_statistics(question, engine, progress)


class ProgressLine:
    """Progress on stderr: a line that is rewritten on a terminal, else one line for each technique."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._last = ""

    def __enter__(self) -> Progress:
        return self._advance

    def _advance(self, name: str, done: int, total: int) -> None:
        if self._terminal:
            line = f"{done / total:4.0%}  {done / 1e6:.0f} of {total / 1e6:.0f} million samples  {name}"
            click.echo(f"\r{line:<{len(self._last)}}", nl=False, err=True)
            self._last = line
        elif name != self._last:
            click.echo(f"{done / total:4.0%}  {name}", err=True)
            self._last = name

    def __exit__(self, *_: object) -> None:
        if self._terminal and self._last:
            click.echo(f"\r{'':<{len(self._last)}}\r", nl=False, err=True)


def _deliver(
    compute: Callable[[], dict[str, Any]], format_: str | None, outputs: tuple[str, ...], chart: str = "statistics"
) -> None:
    """Write a result to the files asked for, else to stdout. Formats and paths are checked before anything is computed.

    With files in the formats of their suffixes, the table still goes to stdout.
    """
    from service import formats
    from service.formats.targets import require_format, target

    require_format(format_ or "table")
    targets = [target(path, format_) for path in outputs]
    result = compute()

    def draw(result: Any) -> Any:
        from service import figures

        return getattr(figures, f"{chart}_chart")(result)

    for path, name in targets:
        formats.write(result, path, name, draw)
    if format_ is None or not targets:
        sys.stdout.buffer.write(formats.encode(result, format_ or "table", draw))
        sys.stdout.buffer.flush()
