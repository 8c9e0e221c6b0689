"""samplerscope info"""

from __future__ import annotations

from functools import partial

import click

from service.cli.delivery import deliver
from service.cli.options import output_options


@click.command()
@partial(output_options, formats="table, json")
def info(format_: str | None, outputs: tuple[str, ...], device: str | None) -> None:
    """Device, driver, versions and the catalogue."""
    from service.information import describe

    deliver("info", lambda: describe(device), format_, outputs)
