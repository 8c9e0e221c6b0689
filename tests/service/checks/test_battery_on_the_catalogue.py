"""The full battery on every technique of EON: real faults are found, and nothing else.

Statistical checks fail by chance with a probability of 1e-5 each (`effort.FALSE_ALARM`), three of them a technique; the
seed is fixed.
"""

import pytest

from .conftest import failures, outcome

REAL_FAULTS = {"coverage", "unbiased", "tail", "supremum"}


@pytest.mark.parametrize("technique", ["ltc", "cltc"])
def test_techniques_that_leave_a_part_out_fail_what_follows_from_it_and_nothing_else(battery, technique):
    result = battery(technique, quick=False)
    assert failures(result) == REAL_FAULTS
    assert outcome(result, "coverage")["evidence"]["lost_share"] == pytest.approx(0.0080, abs=0.0002)
    # The tail of these is W^-2 exactly; the fit scatters by a few percent.
    assert outcome(result, "tail")["evidence"]["tail_index"] == pytest.approx(2, abs=0.2)
    assert result["status"] == "fail"


@pytest.mark.parametrize("technique", ["cosine", "uniform", "ltc-nonnegative", "cltc-mis"])
def test_sound_techniques_pass_all_that_apply(battery, technique):
    result = battery(technique, quick=False)
    assert failures(result) == set()
    skipped = {check["name"] for check in result["checks"] if check["status"] == "not-applicable"}
    assert skipped == ({"jacobian"} if technique == "cltc-mis" else set())
    assert {check["status"] for check in result["stability"]["checks"]} == {"pass"}
    assert result["status"] == "pass"


@pytest.mark.parametrize("model", ["fon", "eon-approx", "lambert"])
def test_models_pass_with_their_usual_techniques(battery, model):
    result = battery(model)
    assert result["techniques"] == ["cosine", "uniform"]
    assert failures(result) == set()


def test_every_check_of_the_list_is_made_and_states_its_power(battery):
    from service.checks.outcome import NAMES

    result = battery("cosine", quick=False)
    assert {check["name"] for check in result["checks"]} == set(NAMES)
    assert all(check["power"] for check in result["checks"] if check["status"] != "not-applicable")


def test_quick_states_a_lower_power(battery):
    def found(result):
        return outcome(result, "chi-square")["power"]

    assert "32,768 directions" in found(battery("cosine", quick=True))
    assert "131,072 directions" in found(battery("cosine", quick=False))


def test_the_same_seed_gives_the_same_result(battery, engine):
    from service.catalogue import load_catalogue
    from service.checks.battery import Battery, run_battery
    from service.checks.selection import select

    again = run_battery(engine, select("cltc", load_catalogue()), Battery(quick=True))
    assert again["checks"] == battery("cltc")["checks"]
