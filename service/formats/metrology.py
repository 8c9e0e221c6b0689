"""Numbers as metrology writes them: 0.9923(4) is 0.9923 with a standard error of 0.0004."""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext

_PLAIN = range(-2, 4)
"""Powers of ten of the leading digit that are written without an exponent."""

# Decimals of floats are exact, up to 767 digits; rounding happens only where it is meant.
_EXACT = Context(prec=800, rounding=ROUND_HALF_EVEN)


def uncertain(value: float, stderr: float | None) -> str:
    """`value` with its standard error in units of its last digit; without an error bar, `plain(value)`.

    The error has two digits where they begin with 10 to 35, one otherwise, and 95 to 99 round up to 100: the rule of
    the Particle Data Group ("Review of Particle Physics", introduction, rounding).
    """
    if not stderr:
        return plain(value)
    with localcontext(_EXACT):
        exact, error = Decimal(value), Decimal(stderr)
        place = _error_place(error)
        mantissa, units = _round(exact, place), _round(error, place)
        leading = max(mantissa.adjusted() if mantissa else place, units.adjusted())
        power = 0 if leading in _PLAIN and place <= 0 else leading
        shifted = mantissa.scaleb(-power).quantize(Decimal(1).scaleb(place - power))
        return f"{shifted + 0:f}({int(units.scaleb(-place))})" + (f"e{power}" if power else "")


def plain(value: float, digits: int = 4) -> str:
    """`value` to `digits` significant digits, without trailing zeros after the point."""
    if not value:
        return "0"
    with localcontext(_EXACT):
        exact = Decimal(value)
        rounded = _round(exact, exact.adjusted() - digits + 1)
        power = 0 if rounded.adjusted() in _PLAIN else rounded.adjusted()
        text = f"{rounded.scaleb(-power):f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return text + (f"e{power}" if power else "")


def _error_place(error: Decimal) -> int:
    """The power of ten of the last digit that the error is written to."""
    place = error.adjusted()
    head = int(_round(error, place - 2).scaleb(2 - place))
    return place - 1 if head < 355 else place


def _round(value: Decimal, place: int) -> Decimal:
    return value.quantize(Decimal(1).scaleb(place))
