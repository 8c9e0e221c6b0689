"""The command line. It parses options into a scene and prints results; all logic is elsewhere.

Exit codes: 0 fine, 1 a check failed, 2 bad input, 3 no device. Results go to stdout, progress and errors to stderr. A
command's file, and what it imports, is loaded when the command is called: a small scene is answered before a plotting
or server library would have loaded.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module

import click

from service.errors import BadInput, Problem, SamplerscopeError

EXIT_FAILED = 1
EXIT_BAD_INPUT = 2
EXIT_NO_DEVICE = 3
EXIT_INTERRUPTED = 130

COMMANDS = ("info", "stats", "converge", "stability", "check", "explain", "figure", "serve")


class _Commands(click.Group):
    """Commands by name, each imported from its file under `commands/` when asked for."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args[0] not in COMMANDS:
            raise BadInput(Problem("command", args[0], "one of " + ", ".join(COMMANDS)))
        return super().resolve_command(ctx, args)

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(f"service.cli.commands.{cmd_name}"), cmd_name)
        return command


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="samplerscope", prog_name="samplerscope")
def cli() -> None:
    """How noisy, how right and how fast a BRDF sampler is: its own GLSL, run on Vulkan compute."""


def main() -> None:
    """Entry point of the command `samplerscope`: every error becomes one line on stderr and an exit code."""
    _hold_streams()
    from lavapipe import CompileError, LavapipeError

    try:
        cli.main(prog_name="samplerscope", standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        sys.exit(EXIT_BAD_INPUT)
    except click.ClickException as error:
        _fail(error.format_message(), EXIT_BAD_INPUT)
    except (click.Abort, KeyboardInterrupt):
        _fail("interrupted", EXIT_INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()
    except (CompileError, SamplerscopeError) as error:
        _fail(str(error), EXIT_BAD_INPUT)
    except OSError as error:
        _fail(": ".join(str(part) for part in (error.filename, error.strerror or error) if part), EXIT_BAD_INPUT)
    except LavapipeError as error:
        _fail(str(error), EXIT_NO_DEVICE)


def _hold_streams() -> None:
    """A standard stream that the caller has closed is the null device, lest a file opened later takes its place."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115 (open to the end)


def _fail(message: str, code: int) -> None:
    click.echo(f"samplerscope: {message}", err=True)
    sys.exit(code)
