"""Charts as Vega-Lite JSON, PNG and SVG."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from service.formats import strict_json

if TYPE_CHECKING:
    from service.figures import AnyChart

PNG_SCALE = 2


def encode(chart: AnyChart, format: str) -> bytes:  # noqa: A002 (the word of the CLI and the API)
    """Return `chart` as `vega`, `png` (at two pixels a point) or `svg`; raises ValueError where a datum is not
    finite.
    """
    # Altair checks every inline datum against the whole schema: seconds for thousands of angles. The charts'
    # specifications are validated by their tests instead.
    spec: dict[str, Any] = chart.to_dict(validate=False)
    if format == "vega":
        return strict_json.encode(spec)
    import altair
    import vl_convert

    version = ".".join(altair.SCHEMA_VERSION.split(".")[:2])
    text = json.dumps(spec, allow_nan=False)
    if format == "png":
        return bytes(vl_convert.vegalite_to_png(text, vl_version=version, scale=PNG_SCALE))
    return str(vl_convert.vegalite_to_svg(text, vl_version=version)).encode()
