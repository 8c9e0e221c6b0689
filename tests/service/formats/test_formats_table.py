"""The terminal text: cells, splitting, width, the summary."""

import pytest

from service.formats import encode
from service.formats.series import Series
from service.formats.table import angle_texts, cells, statistics_table
from tests.service.formats.statistics_results import (
    a_result,
    awkward,
    make_infinite,
    one_series,
    paper_angles,
    roughness_sweep,
    six_techniques,
)


def text_of(result):
    return encode(result, "table").decode()


@pytest.mark.parametrize("result", [six_techniques(), roughness_sweep(), awkward(), six_techniques(1)])
def test_no_line_is_wider_than_120_columns_and_none_has_trailing_blanks_or_colour(result):
    for line in text_of(result).splitlines():
        assert len(line) <= 120
        assert line == line.rstrip()
        assert "\x1b" not in line


@pytest.mark.parametrize("result", [six_techniques(64), roughness_sweep(count=64)])
def test_all_angles_are_printed(result):
    lines = text_of(result).splitlines()
    assert sum(line.lstrip().startswith("89.91") for line in lines) >= 3
    assert sum(line.lstrip().startswith("1.43") for line in lines) >= 3


def test_an_infinite_variance_never_stands_as_a_bare_number():
    series = make_infinite(one_series("cltc", [0.0, 45.0, 89.9]), 1)
    series["variance"] = [0.0607, 8.2149, None]
    found = [cell.strip() for cell in cells(Series(series), "variance")]
    assert found == ["0.0607(24)", "inf [8.21]", "inf"]
    text = text_of(a_result([series]))
    assert "tail strength up to 0.127, at 89.9 deg" in text
    assert "has no limit" in text


def test_a_finding_that_lists_its_angles_marks_those_alone():
    series = one_series("cltc", [0.0, 45.0, 89.9])
    finding = {"name": "infinite-variance", "message": "", "evidence": {"theta_o_deg": [45.0]}}
    series["verdict"] = {"status": "infinite-variance", "findings": [finding]}
    assert Series(series).infinite_variance == [False, True, False]


def test_a_maximum_stands_before_its_supremum():
    series = make_infinite(one_series("cltc", [0.0, 89.9]), 1)
    series["max_weight"] = [12.3, 35.36]
    series["reference"]["max_weight"] = [57.3, None]
    assert [cell.split() for cell in cells(Series(series), "max_weight")] == [
        ["12.3", "/", "57.3"],
        ["35.36", "/", "inf"],
    ]


def test_a_null_is_a_dash_and_findings_are_told_with_their_message():
    text = text_of(awkward())
    assert any(line.split()[:3] == ["45.00", "0.999764", "-"] for line in text.splitlines())
    assert "    nonfinite: 19 samples are NaN or infinite" in text
    assert "multiple-scattering lobe (roughness is 0)" in text


def test_panels_stand_side_by_side_where_they_fit():
    one = text_of(a_result([one_series("cosine", paper_angles(4))]))
    assert "mean weight" in one
    assert one.splitlines()[2].count("|") == 2


def test_techniques_of_one_roughness_stay_in_one_table():
    heads = [line.split() for line in text_of(roughness_sweep()).splitlines() if line.startswith("  roughness  ")]
    assert [head[1:] for head in heads[:2]] == [["0", "0", "0.25", "0.25", "0.5", "0.5"], ["0.75", "0.75", "1", "1"]]


def test_speed_is_samples_of_all_angles_over_device_time():
    series = one_series("cosine", paper_angles(10))
    series["device_ms"] = 5.0
    assert "2000.0" in text_of(a_result([series]))


@pytest.mark.parametrize(
    ("angles", "texts"),
    [
        ([0.0, 45.0], ["0", "45"]),
        ([0.0, 89.99], ["0.00", "89.99"]),
        ([89.99991, 89.99992], ["89.99991", "89.99992"]),
        ([0.0, 89.999999999999], ["0", "89.999999999999"]),
    ],
)
def test_angles_have_as_few_decimals_as_keep_them_apart(angles, texts):
    assert angle_texts(angles) == texts


def test_long_names_and_few_columns_still_fit():
    result = a_result([one_series("a-technique-" + "x" * 80, paper_angles(3))])
    assert max(map(len, statistics_table(result).splitlines())) <= 160
