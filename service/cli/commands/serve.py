"""samplerscope serve"""

from __future__ import annotations

import click


@click.command()
@click.option("--host", metavar="ADDRESS", help="Address to listen on. Default: 127.0.0.1, this machine only.")
@click.option("--port", metavar="N", help="Port to listen on; 0 takes a free one. Default: 8000.")
def serve(host: str | None, port: str | None) -> None:
    """The HTTP service. Other settings come from the environment: SAMPLERSCOPE_*, see docs/http.md."""
    from service.api import server
    from service.api.settings import load_settings

    server.serve(load_settings(host=host, port=port))
