"""Charts as Vega-Lite JSON, PNG and SVG."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from service.formats import strict_json

if TYPE_CHECKING:
    from service.figures import AnyChart

PNG_SCALE = 2


def encode(chart: AnyChart, format: str) -> bytes:  # noqa: A002 (the word of the CLI and the API)
    """`chart` as `vega`, `png` (two pixels a point) or `svg`; raises ValueError for a datum not finite."""
    spec = _specification(chart)
    if format == "vega":
        return strict_json.encode(spec)
    import altair
    import vl_convert

    version = ".".join(altair.SCHEMA_VERSION.split(".")[:2])
    text = json.dumps(spec, allow_nan=False)
    if format == "png":
        return bytes(vl_convert.vegalite_to_png(text, vl_version=version, scale=PNG_SCALE))
    return str(vl_convert.vegalite_to_svg(text, vl_version=version)).encode()


def _specification(chart: AnyChart) -> dict[str, Any]:
    """The Vega-Lite specification of `chart`.

    Its data sets, plain rows already, are carried over as they are: Altair looks at every value of every row, which
    takes seconds for thousands of angles. The tests validate whole specifications against the schema.
    """
    import altair

    bare = chart.copy(deep=False)
    bare.datasets = altair.Undefined
    spec: dict[str, Any] = bare.to_dict(validate=False)
    if chart.datasets is not altair.Undefined:
        spec["datasets"] = {**spec.get("datasets", {}), **chart.datasets}
    return spec
