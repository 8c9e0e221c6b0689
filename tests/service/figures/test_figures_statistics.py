"""The charts of statistics: what they hold, what they say, and that Vega-Lite accepts them."""

import json
import math

import altair
import jsonschema
import pytest

from service.figures import roughness_chart, statistics_chart
from service.figures.style import technique_styles
from service.formats import encode
from tests.service.formats.statistics_results import (
    TECHNIQUES,
    a_result,
    awkward,
    make_infinite,
    one_series,
    paper_angles,
    roughness_sweep,
    six_techniques,
)


def spec_of(result, chart=None):
    return json.loads(encode(result, "vega", chart))


def everything(node, key):
    """All values of `key` anywhere in a specification."""
    if isinstance(node, dict):
        found = [node[key]] if key in node else []
        return found + [hit for child in node.values() for hit in everything(child, key)]
    return [hit for child in node for hit in everything(child, key)] if isinstance(node, list) else []


def rows_of(spec, statistic):
    named = spec["datasets"].items()
    return [row for name, rows in named if name.startswith(f"{statistic}-") and "reference" not in name for row in rows]


@pytest.mark.parametrize(
    ("result", "chart"),
    [
        (six_techniques(5), statistics_chart),
        (six_techniques(1), statistics_chart),
        (awkward(), statistics_chart),
        (roughness_sweep(count=4), statistics_chart),
        (roughness_sweep(count=4), roughness_chart),
    ],
)
def test_the_specification_is_valid_vega_lite_with_its_data_inside(result, chart):
    spec = spec_of(result, chart)
    schema = altair.vegalite.v6.schema.core.load_schema()
    jsonschema.Draft7Validator(schema).validate(spec)
    assert not everything(spec, "url")
    assert {data["name"] for data in everything(spec, "data") if "name" in data} <= set(spec["datasets"])


def test_every_value_is_drawn_once():
    result = six_techniques(16)
    spec = spec_of(result)
    for statistic in ("mean", "variance", "max_weight"):
        drawn = [(row["technique"].split()[0], row["theta_o_deg"], row["value"]) for row in rows_of(spec, statistic)]
        asked = [
            (series["technique"], angle, value)
            for series in result["series"]
            for angle, value in zip(series["theta_o_deg"], series[statistic], strict=True)
        ]
        assert drawn == asked


@pytest.mark.parametrize("zero", [0.0, -1e-18, 1e-13, None])
def test_logarithmic_panels_get_positive_values_only_and_the_line_breaks_there(zero):
    series = one_series("cosine", paper_angles(9))
    series["variance"][4] = series["max_weight"][4] = series["reference"]["variance"][4] = zero
    spec = spec_of(a_result([series]))
    for statistic in ("variance", "max_weight"):
        assert all(row["value"] > 0 for row in rows_of(spec, statistic))
        assert len({row["run"] for row in rows_of(spec, statistic)}) == 2
    logs = [scale for scale in everything(spec, "scale") if scale.get("type") == "log"]
    assert logs
    assert all(scale["domain"][0] > 0 for scale in logs)


def test_axis_ticks_of_logarithmic_panels_are_decades_or_simple_parts_of_them():
    axes = [axis for axis in everything(spec_of(six_techniques()), "axis") if axis and "labelExpr" in axis]
    for tick in (tick for axis in axes for tick in axis["values"]):
        assert round(tick / 10 ** math.floor(math.log10(tick)), 9) in (1, 2, 5)


def test_a_statistic_that_was_not_asked_for_has_no_panel():
    result = six_techniques(3)
    for series in result["series"]:
        del series["mean"], series["mean_stderr"], series["max_weight"]
    assert len(spec_of(result)["hconcat"]) == 1


def test_a_result_without_statistics_cannot_be_drawn():
    with pytest.raises(ValueError, match="nothing to draw"):
        statistics_chart(a_result([]))


def test_an_infinite_variance_is_said_in_the_legend_and_drawn_with_markers():
    series = make_infinite(one_series("cltc", paper_angles(9)), 5)
    spec = spec_of(a_result([series]))
    rows = rows_of(spec, "variance")
    assert [row["limit"] for row in rows] == [True] * 5 + [False] * 4
    assert {row["technique"] for row in rows} == {"cltc (infinite variance: sampled value)"}
    assert all(row["marker"] for row in rows[5:])
    assert not any("stderr" in row for row in rows[5:])
    assert "no finite value" in " ".join(spec["title"]["subtitle"])


def test_the_subtitle_tells_samples_seed_and_device():
    subtitle = " ".join(spec_of(six_techniques(3))["title"]["subtitle"])
    assert "1,000,000 samples per angle" in subtitle
    assert "seed 3" in subtitle
    assert "llvmpipe" in subtitle


def test_a_title_replaces_the_usual_one():
    assert statistics_chart(six_techniques(2), title="Figure 11").to_dict()["title"]["text"] == "Figure 11"


def test_techniques_have_the_styles_of_the_paper_and_others_their_own():
    styles = technique_styles([*TECHNIQUES, "mine", "other"])
    assert len(set(styles)) == 8
    dashes = dict(zip(TECHNIQUES, (dash for _, dash in styles), strict=False))
    assert dashes["cosine"] == dashes["ltc"] == dashes["cltc-mis"]
    assert dashes["uniform"] == dashes["ltc-nonnegative"] != dashes["cltc"]


def test_few_swept_values_are_rows_and_many_are_colours():
    assert len(spec_of(roughness_sweep((0.25, 1.0), 3))["vconcat"]) == 2
    many = spec_of(roughness_sweep((0.0, 0.2, 0.4, 0.6, 0.8, 1.0), 3))
    assert [row["title"]["text"] for row in many["vconcat"]] == ["cosine", "cltc-mis"]


def test_the_roughness_chart_has_a_column_for_each_technique():
    spec = spec_of(roughness_sweep(count=3), roughness_chart)
    assert [len(row["hconcat"]) for row in spec["vconcat"]] == [2, 2]
    scales = {json.dumps(scale["domain"]) for scale in everything(spec["vconcat"][0], "scale") if "type" in scale}
    assert len(scales) == 1


def test_azimuths_are_told_apart():
    series = [{**one_series("cosine", paper_angles(3)), "phi_o_deg": phi} for phi in (0.0, 90.0)]
    titles = [row["title"]["text"] for row in spec_of(a_result(series))["vconcat"]]
    assert titles == ["phi_o_deg 0", "phi_o_deg 90"]


def test_the_line_at_one_is_drawn_only_where_one_is_expected():
    grey = one_series("cosine", paper_angles(3))
    assert '"one"' in json.dumps(spec_of(a_result([grey])))
    grey["parameters"]["albedo"] = 0.5
    assert '"one"' not in json.dumps(spec_of(a_result([grey])))
