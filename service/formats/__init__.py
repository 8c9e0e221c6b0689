"""Results as bytes: JSON, CSV, NumPy, Vega-Lite, pictures and terminal text.

A result is a plain dict with a `kind`. A kind's own representations live in `kinds/KIND.py`; JSON needs none.
What a format needs (Altair, vl-convert, NumPy) is imported when that format is first asked for.
"""

from service.formats.encoding import FORMATS, Format, UnknownFormat, encode, format_of, formats_of
from service.formats.writing import write, write_bytes

__all__ = ["FORMATS", "Format", "UnknownFormat", "encode", "format_of", "formats_of", "write", "write_bytes"]
