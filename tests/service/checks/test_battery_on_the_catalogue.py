"""The battery on the catalogue: real faults are found, and nothing else.

The full battery on every technique of EON, the quick one on a choice of the others; `make bench-checks` runs the full
one on all. Statistical checks fail by chance with a probability of 1e-5 each (`effort.FALSE_ALARM`), three of them a
technique; the seed is fixed.
"""

import re
from pathlib import Path

import pytest

from service.catalogue import load_catalogue
from service.checks.battery import Battery, run_battery
from service.checks.outcome import NAMES
from service.checks.selection import select
from tests.service.checks.conftest import failures, outcome
from tests.service.checks.expected_findings import FAULTS, expected, pairs, table

DOCS = Path(__file__).parents[3] / "docs"
CATALOGUE = load_catalogue()


@pytest.mark.parametrize("technique", ["ltc", "cltc"])
def test_techniques_that_leave_a_part_out_fail_what_follows_from_it_and_nothing_else(battery, technique):
    result = battery(technique, quick=False)
    assert failures(result) == expected("eon", technique) == {"coverage", "unbiased", "tail", "supremum"}
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


CHOSEN = [
    ("qon", "cosine"),
    ("oren-nayar-full", "uniform"),
    ("lambert", "cltc-mis"),
    ("ashikhmin-shirley", "ashikhmin-shirley"),
    ("blinn-phong", "uniform"),
    ("cook-torrance", "beckmann-half-vector"),
    ("ggx", "ggx-vndf"),
    ("ggx", "ggx-vndf-bounded"),
    ("kurt", "beckmann-half-vector"),
    ("kurt-coupled", "half-vector-cosine"),
    ("kurt-multilobe", "kurt-multilobe"),
    ("ward-duer", "cosine"),
]
"""A pair of every kind of sampler, sound ones and such with faults; among their settings are lobes 1e-3 in width."""


@pytest.mark.parametrize(("model", "technique"), CHOSEN)
def test_the_quick_battery_finds_faults_where_there_are_some_and_invents_none(battery, model, technique):
    found, must = failures(battery(technique, model, [technique])), expected(model, technique)
    assert found <= must
    assert bool(found) == bool(must)


def test_the_faults_are_those_of_pairs_that_exist_and_the_page_lists_them():
    every = pairs(CATALOGUE)
    for fault in FAULTS:
        for model in fault.models:
            assert any(fault.holds_for(*pair) for pair in every if pair[0] == model)
    assert table() in (DOCS / "checks.md").read_text()


@pytest.mark.parametrize("model", list(CATALOGUE.models))
def test_the_faults_are_those_that_the_float64_reference_shows(model):
    """docs/models.md is made from the reference: largest albedo; at the defaults variance by angle and the bound."""
    page = (DOCS / "models.md").read_text().split(f"## `{model}`:")[1].split("\n## ")[0]
    albedo = float(re.search(r"the largest albedo found is ([0-9.e+]+)", page)[1])
    assert ("energy" in expected(model, "uniform")) == (albedo > 1.001)
    rows = re.findall(r"^\| `([a-z-]+)` \|(.*)\| ([^|]*) \|$", page.split("| variance |")[1], re.MULTILINE)
    assert [technique for technique, *_ in rows] == list(CATALOGUE.techniques_for(model))
    for technique, variances, weight in rows:
        assert weight != "no bound" or "supremum" in expected(model, technique)
        assert "inf" not in variances or "tail" in expected(model, technique)


@pytest.mark.parametrize("model", ["fon", "eon-approx", "lambert"])
def test_models_pass_with_their_usual_techniques(battery, model):
    result = battery(model)
    assert result["techniques"] == ["cosine", "uniform"]
    assert failures(result) == set()


def test_every_check_of_the_list_is_made_and_states_its_power(battery):
    result = battery("cosine", quick=False)
    assert {check["name"] for check in result["checks"]} == set(NAMES)
    assert all(check["power"] for check in result["checks"] if check["status"] != "not-applicable")


def test_quick_states_a_lower_power(battery):
    def found(result):
        return outcome(result, "chi-square")["power"]

    assert "32,768 directions" in found(battery("cosine", quick=True))
    assert "131,072 directions" in found(battery("cosine", quick=False))


def test_the_same_seed_gives_the_same_result(battery, engine):
    again = run_battery(engine, select("cltc", CATALOGUE), Battery(quick=True))
    assert again["checks"] == battery("cltc")["checks"]
