"""Metrology notation: exact cases, and a value is recovered to half a unit of its last digit."""

import re
from decimal import Decimal, localcontext

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.formats.metrology import plain, uncertain

NOTATION = re.compile(r"^(-?\d+)(?:\.(\d+))?\((\d+)\)(?:e(-?\d+))?$")


@pytest.mark.parametrize(
    ("value", "stderr", "text"),
    [
        (0.99234, 0.0004, "0.9923(4)"),
        (0.001234, 0.000012, "1.234(12)e-3"),
        (1.0, 0.00354, "1.0000(35)"),
        (1.0, 0.00356, "1.000(4)"),
        (1.0, 0.0097, "1.000(10)"),
        (123.456, 1.2, "123.5(12)"),
        (12345.0, 560.0, "1.23(6)e4"),
        (1234.0, 400.0, "1.2(4)e3"),
        (0.0, 1e-8, "0.0(10)e-8"),
        (-1e-9, 0.012, "0.000(12)"),
        (0.99999, 0.001, "1.0000(10)"),
        (9.9996, 0.004, "10.000(4)"),
        (-0.5, 0.02, "-0.500(20)"),
        (0.0, 0.0, "0"),
        (1.5, 0.0, "1.5"),
        (1.5, None, "1.5"),
    ],
)
def test_value_and_error_are_written_as_metrology_does(value, stderr, text):
    assert uncertain(value, stderr) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (57.345, "57.34"), (12.3, "12.3"), (99999.0, "1e5"), (1234567.0, "1.235e6"), (0.00123, "1.23e-3")],
)
def test_a_value_without_error_has_four_digits(value, text):
    assert plain(value) == text


@given(
    value=st.floats(allow_nan=False, allow_infinity=False),
    stderr=st.floats(min_value=5e-324, allow_nan=False, allow_infinity=False),
)
def test_value_is_recovered_within_half_a_digit_of_its_uncertainty(value, stderr):
    whole, fraction, error, power = NOTATION.match(uncertain(value, stderr)).groups()
    with localcontext(prec=800):
        unit = Decimal(10) ** (int(power or 0) - len(fraction or ""))
        mantissa = Decimal(f"{whole}.{fraction or 0}") * Decimal(10) ** int(power or 0)
        assert abs(mantissa - Decimal(value)) <= unit / 2
        assert abs(int(error) * unit - Decimal(stderr)) <= unit / 2
    assert 1 <= int(error) <= 35
