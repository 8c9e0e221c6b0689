"""The comparison of `make bench` with its recorded ratios."""

import json

import pytest

from tests.benchmarks.recorded import FILE, against_record, compare, save, slower

RECORD = {
    "C++": {"cosine": 1.0, "ltc": 0.8},
    "Dr.Jit": {"cosine": 0.6, "ltc": 0.5},
    "NumPy": {"cosine": 9.0, "ltc": 8.0},
}


def scaled(cosine=1.0, ltc=1.0):
    return {peer: {"cosine": row["cosine"] * cosine, "ltc": row["ltc"] * ltc} for peer, row in RECORD.items()}


@pytest.mark.parametrize(("factor", "found"), [(0.89, {"ltc"}), (0.91, set()), (1.5, set())])
def test_a_technique_is_slower_below_nine_tenths_of_its_record(factor, found):
    assert set(slower(scaled(ltc=factor), RECORD)) == found
    assert against_record(scaled(ltc=factor), RECORD)["ltc"] == pytest.approx(factor)


def test_one_peer_that_changes_does_not_decide():
    measured = scaled()
    measured["C++"]["cosine"] *= 0.5
    assert not slower(measured, RECORD)


def test_only_what_both_have_is_compared():
    measured = {peer: row for peer, row in scaled(cosine=0.5).items() if peer != "NumPy"} | {
        "new": {"cosine": 1, "ltc": 1}
    }
    assert against_record(measured, RECORD) == pytest.approx({"cosine": 0.5, "ltc": 1.0})
    assert against_record({"new": {"cosine": 1.0}}, RECORD) == {}


def test_a_slow_down_is_said_and_another_device_is_not_compared(tmp_path):
    file = tmp_path / "recorded.json"
    save(RECORD, "device A", file)
    lines, fallen = compare(scaled(cosine=0.8), "device A", file)
    assert fallen
    assert any("SLOWER" in line and "cosine" in line and "0.80" in line for line in lines)
    assert not compare(RECORD, "device A", file)[1]
    (line,), fallen = compare(scaled(cosine=0.1), "device B", file)
    assert not fallen
    assert "device A" in line


def test_the_recorded_file_holds_positive_ratios_of_all_techniques():
    record = json.loads(FILE.read_text())
    assert all(len(row) == 6 and min(row.values()) > 0 for row in record["ratios"].values())
