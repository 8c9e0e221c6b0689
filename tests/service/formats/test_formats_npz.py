"""NumPy archives load without pickle, hold what the JSON holds and depend on the result alone."""

import io
import json
import time

import numpy as np

from service.formats import encode
from tests.service.formats.statistics_results import a_result, awkward, one_series, six_techniques


def loaded(result):
    with np.load(io.BytesIO(encode(result, "npz")), allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


def test_npz_stacks_series_by_angle():
    result = six_techniques(8)
    arrays = loaded(result)
    assert arrays["variance"].shape == (6, 8)
    assert arrays["technique"].tolist() == [series["technique"] for series in result["series"]]
    np.testing.assert_array_equal(arrays["mean"], [series["mean"] for series in result["series"]])
    assert arrays["parameter_roughness"].tolist() == [1.0] * 6
    assert json.loads(str(arrays["scene"])) == result["scene"]


def test_npz_has_nan_for_null_and_whole_numbers_for_counts():
    arrays = loaded(awkward())
    assert np.isnan(arrays["mean"][1, 1])
    assert np.isnan(arrays["reference_mean"][0]).all()
    assert arrays["nonfinite"].dtype == arrays["samples"].dtype == np.int64
    assert arrays["nonfinite"][1].tolist() == [0, 17, 2]


def test_npz_bytes_do_not_depend_on_the_time(monkeypatch):
    first = encode(awkward(), "npz")
    monkeypatch.setattr(time, "time", lambda: 2e9)
    assert encode(awkward(), "npz") == first


def test_npz_pads_series_of_fewer_angles():
    arrays = loaded(a_result([one_series("cosine", [0.0, 10.0]), one_series("uniform", [0.0])]))
    assert np.isnan(arrays["theta_o_deg"][1, 1])
