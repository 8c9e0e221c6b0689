"""CSV holds the JSON's numbers bit for bit, one row for each series and angle."""

import csv
import io

from service.formats import encode
from tests.service.formats.statistics_results import a_result, awkward, one_series, roughness_sweep, six_techniques


def rows_of(result):
    return list(csv.DictReader(io.StringIO(encode(result, "csv").decode())))


def test_csv_numbers_equal_the_results_bit_for_bit():
    result = six_techniques(16)
    rows = iter(rows_of(result))
    for series in result["series"]:
        for index, angle in enumerate(series["theta_o_deg"]):
            row = next(rows)
            assert (row["technique"], float(row["theta_o_deg"])) == (series["technique"], angle)
            assert float(row["roughness"]) == series["parameters"]["roughness"]
            for name in ("mean", "mean_stderr", "variance", "variance_stderr", "max_weight", "zero_fraction"):
                assert row[name] == ("" if series[name][index] is None else repr(series[name][index]))
            for name, column in series["reference"].items():
                assert row[f"reference_{name}"] == ("" if column[index] is None else repr(column[index]))
            assert (row["samples"], row["status"]) == ("1000000", series["verdict"]["status"])
    assert next(rows, None) is None


def test_csv_leaves_null_and_absent_values_empty():
    rows = rows_of(awkward())
    assert rows[0]["mean_stderr"] == rows[0]["reference_mean"] == rows[4]["mean"] == rows[11]["variance"] == ""
    assert rows[4]["nonfinite"] == "17"


def test_csv_has_no_column_for_a_statistic_that_was_not_asked_for():
    result = six_techniques(2)
    for series in result["series"]:
        del series["variance"], series["variance_stderr"]
    header = rows_of(result)[0]
    assert "variance" not in header
    assert "reference_variance" in header


def test_csv_has_the_azimuth_only_where_the_result_has_it():
    series = one_series("cosine", [0.0, 30.0])
    assert "phi_o_deg" not in rows_of(a_result([series]))[0]
    series["phi_o_deg"] = 45.0
    assert [row["phi_o_deg"] for row in rows_of(a_result([series]))] == ["45.0", "45.0"]


def test_csv_has_every_parameter_once_even_one_named_like_a_statistic():
    result = roughness_sweep((0.5, 1.0), 2)
    for series in result["series"]:
        series["parameters"]["mean"] = 0.25
    row = rows_of(result)[0]
    assert float(row["parameter_mean"]) == 0.25
    assert float(row["mean"]) == result["series"][0]["mean"][0]
