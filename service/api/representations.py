"""Which format a client wants, and the answer in it, with its entity tag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from starlette.requests import Request
from starlette.responses import Response

from service.api.problems import HttpError
from service.errors import BadInput, Problem
from service.formats import FORMATS
from service.jobs.store import Stored


def chosen_format(request: Request, allowed: Sequence[str]) -> str:
    """The format of `?format=`, else the best that `Accept` allows, else JSON.

    Raises BadInput for a `format` that there is not, HttpError (406) where nothing is acceptable.
    """
    named = request.query_params.get("format")
    if named is not None:
        if named not in allowed:
            raise BadInput(Problem("format", named, "one of " + ", ".join(allowed)))
        return named
    ranges = _ranges(",".join(request.headers.getlist("accept")) or "*/*")
    best = max(allowed, key=lambda name: _quality(FORMATS[name].media_type, ranges))
    if _quality(FORMATS[best].media_type, ranges) <= 0:
        types = [FORMATS[name].media_type for name in allowed]
        raise HttpError(406, "not-acceptable", "none of the accepted types is there; allowed: " + ", ".join(types))
    return best


def _ranges(accept: str) -> Mapping[str, float]:
    """Media ranges of an Accept header with their qualities."""
    ranges = {}
    for entry in accept.split(","):
        name, *parameters = (text.strip().lower() for text in entry.split(";"))
        quality = 1.0
        for parameter in parameters:
            if parameter.startswith("q="):
                try:
                    quality = min(1.0, max(0.0, float(parameter[2:])))
                except ValueError:
                    quality = 0.0
        if name:
            ranges[name] = quality if quality == quality else 0.0
    return ranges


def _quality(media_type: str, ranges: Mapping[str, float]) -> float:
    """The quality of a type: that of the most specific range which holds it (RFC 9110, 12.5.1)."""
    main = media_type.partition("/")[0]
    return next((ranges[name] for name in (media_type, f"{main}/*", "*/*") if name in ranges), 0.0)


def represent(request: Request, stored: Stored, media_type: str) -> Response:
    """The stored bytes, or 304 where the client has them."""
    headers = {"etag": stored.etag, "vary": "Accept", "cache-control": "no-cache"}
    if has(request.headers.get("if-none-match"), stored.etag):
        return Response(status_code=304, headers=headers)
    return Response(stored.content, headers=headers, media_type=media_type)


def has(header: str | None, etag: str) -> bool:
    """Whether an If-None-Match header names the tag (weak comparison, RFC 9110, 13.1.2)."""
    if header is None:
        return False
    tags = [tag.strip().removeprefix("W/") for tag in header.split(",")]
    return etag in tags or "*" in tags
