"""Files that a browser is given: their bytes, also compressed, under entity tags that are hashes of them."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from pathlib import Path

from starlette.requests import Request
from starlette.responses import Response

from service.api.representations import has
from service.jobs.store import Stored

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}

_HEADERS = {
    # Plots need no eval: vega's expressions are interpreted. Styles are set from modules, not by attributes or markup.
    "content-security-policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-cache",
    "vary": "Accept-Encoding",
}


@dataclass(frozen=True)
class Asset:
    """A file in both encodings."""

    media_type: str
    plain: Stored
    compressed: Stored

    @classmethod
    def of(cls, name: str, content: bytes) -> Asset:
        """The asset of a file of this name."""
        compressed = gzip.compress(content, mtime=0)
        return cls(_TYPES[Path(name).suffix], Stored.of(content), Stored.of(compressed))

    def respond(self, request: Request) -> Response:
        """The bytes in an encoding that the client takes, or 304 where it has them."""
        accepted = {part.partition(";")[0].strip() for part in request.headers.get("accept-encoding", "").split(",")}
        packed = "gzip" in accepted
        chosen = self.compressed if packed else self.plain
        headers = {**_HEADERS, "etag": chosen.etag, **({"content-encoding": "gzip"} if packed else {})}
        if has(request.headers.get("if-none-match"), chosen.etag):
            return Response(status_code=304, headers=headers)
        return Response(chosen.content, headers=headers, media_type=self.media_type)


def assets_of(folder: Path) -> dict[str, Asset]:
    """The files of a folder by name."""
    return {path.name: Asset.of(path.name, path.read_bytes()) for path in folder.iterdir() if path.suffix in _TYPES}
