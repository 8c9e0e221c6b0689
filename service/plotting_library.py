"""The plotting library of the page: vega-embed as one ES module, out of the package that draws the figures."""

from __future__ import annotations

from importlib.metadata import version

from lavapipe import default_cache

_EXPORTS = "export { vegaEmbed };"


def plotting_library() -> bytes:
    """The module, which exports `vegaEmbed`. Bundling takes seconds, so it is kept in the cache of this user."""
    cache = default_cache()
    key = f"plotting-library:{version('vl-convert-python')}:{_EXPORTS}"
    found = cache.get(key)
    if found is None:
        import vl_convert

        bundled: str = vl_convert.javascript_bundle(_EXPORTS)
        found = bundled.encode()
        cache.put(key, found)
    return found
