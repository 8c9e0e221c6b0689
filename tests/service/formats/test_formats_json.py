"""JSON is strict, keeps the order of the result and reads back equal."""

import json
import math

import pytest

from service.formats import encode
from tests.service.formats.statistics_results import awkward, six_techniques


def test_json_reads_back_equal():
    result = awkward()
    text = encode(result, "json").decode()
    assert json.loads(text) == result
    assert list(json.loads(text)["series"][0]) == list(result["series"][0])


def test_json_has_no_constant_that_strict_parsers_refuse():
    def refuse(constant):
        raise AssertionError(constant)

    json.loads(encode(six_techniques(), "json"), parse_constant=refuse)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("format_", ["json", "csv"])
def test_a_number_that_is_not_finite_is_refused(bad, format_):
    result = six_techniques(3)
    result["series"][2]["variance"][1] = bad
    with pytest.raises(ValueError, match=r"not finite.*variance"):
        encode(result, format_)


def test_the_refusal_names_the_place():
    result = six_techniques(3)
    result["series"][2]["variance"][1] = math.nan
    with pytest.raises(ValueError, match=r"series\[2\]\.variance\[1\] is nan"):
        encode(result, "json")


def test_equal_results_give_equal_bytes():
    assert encode(awkward(), "json") == encode(awkward(), "json")


def test_an_array_of_numbers_stands_on_one_line():
    lines = encode(six_techniques(64), "json").decode().splitlines()
    assert sum('"variance": [' in line and line.rstrip(",").endswith("]") for line in lines) == 12
