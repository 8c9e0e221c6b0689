"""What calls cost: laws that hold for any machine. Times themselves are compared in `make bench` only."""

from service.convergence import compute_timings
from service.convergence.cost import Loop, measure_costs, median_interval
from service.formats import encode
from service.variant import compose


def loops(engine, *techniques, task="sample", model="eon"):
    catalogue = engine.catalogue
    return [Loop(catalogue.model(model), catalogue.technique(name), task) for name in techniques]


def test_a_cost_lies_within_its_interval_and_is_positive(engine):
    costs, built_ms = measure_costs(engine, loops(engine, "cosine", "cltc-mis"), repeats=5)
    for cost in costs:
        assert 0 < cost.interval_ns[0] <= cost.call_ns <= cost.interval_ns[1]
        assert cost.empty_ns > 0
        assert cost.repeats == 5
    assert built_ms > 0


def test_parameters_change_from_call_to_call(engine):
    """So that no coefficient can be hoisted: every declared parameter is assigned inside the loop."""
    catalogue = engine.catalogue
    variant = compose(catalogue, catalogue.model("eon"), [catalogue.technique("cltc-mis")], "cost")
    drawn = variant.includes["variant/draw_parameters.glsl"]
    assert all(f"parameter_{name} = ranges[" in drawn for name in ("roughness", "albedo"))
    loop = variant.source[variant.source.index("for (uint i = 0u; i < calls") :]
    assert "draw_parameters(" in loop


def test_the_interval_of_a_median_has_its_ranks():
    """Tables of the sign test: for 15 values the 4th and 12th, for 31 the 10th and 22nd; for 5 all there is."""
    assert median_interval(15) == (3, 11)
    assert median_interval(31) == (9, 21)
    assert median_interval(5) == (0, 4)


def test_the_table_has_every_model_and_technique_beside_the_papers_figures(engine):
    result = compute_timings(engine, repeats=1)
    rows = {(row["model"], row["technique"], row["task"]): row for row in result["rows"]}
    catalogue = engine.catalogue
    for model in catalogue.models:
        assert (model, None, "eval") in rows
        assert all((model, name, "sample") in rows for name in catalogue.techniques_for(model))
    assert {key[1] for key in rows if key[2] == "pdf"} == {
        name for model in catalogue.models for name in catalogue.techniques_for(model)
    }
    assert rows["eon", None, "eval"]["paper_ns"] == 108.7
    assert rows["eon", "cltc-mis", "sample"]["paper_ns"] == 297.0
    assert rows["eon", "ltc", "sample"]["paper_ns"] is None
    text = encode(result, "table").decode()
    assert "empty loop" in text
    assert "AMD 3970X" in text
    assert encode(result, "csv").decode().count("\n") == len(rows) + 1
