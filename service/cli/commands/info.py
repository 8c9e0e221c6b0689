"""samplerscope info"""

from __future__ import annotations

import click

from service.cli.delivery import deliver
from service.cli.options import output_options


@click.command()
@output_options
def info(format_: str | None, outputs: tuple[str, ...], device: str | None) -> None:
    """Device, driver, versions and the catalogue."""
    from service.information import describe

    deliver(lambda: describe(device), format_, outputs)
