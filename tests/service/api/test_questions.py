"""What is asked over HTTP is answered as the command line and the functions answer it, in every format."""

import csv
import io
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from http_server import SMALL, without_run
from starlette.datastructures import QueryParams

from service.api.queries import parameter_names, scene_of_query
from service.catalogue import load_catalogue
from service.cli.commands.stats import stats
from service.cli.options import scene_data
from service.scene import parse_scene, resolve
from service.worker.kinds import KINDS

LINK = "/v1/statistics?model=eon&roughness=0.5,1&techniques=cosine,cltc-mis&angles=4&samples=20000&seed=3"
TYPES = {
    "json": "application/json",
    "csv": "text/csv",
    "npz": "application/x-npz",
    "vega": "application/vnd.vegalite.v6+json",
    "png": "image/png",
    "svg": "image/svg+xml",
    "table": "text/plain",
}


def test_a_link_gives_the_json_of_the_command_line(server):
    options = "stats --model eon --set roughness=0.5,1 --technique cosine,cltc-mis --angles 4 --samples 20000 --seed 3"
    command = [sys.executable, "-c", "from service.cli import main; main()", *options.split(), "--format", "json"]
    printed = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    answered = server.client.get(LINK).json()
    assert without_run(answered) == without_run(printed)
    assert list(answered) == list(printed)
    assert answered["run"].keys() == printed["run"].keys()


def test_every_link_of_the_documentation_asks_what_the_command_beside_it_asks():
    """The same function answers both, so that equal questions have equal answers; order counts: it is the series'."""
    catalogue = load_catalogue()
    text = (Path(__file__).parents[3] / "docs" / "http.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(/v1/statistics\?[^`]*)` \| `stats ([^`]*)` \|$", text, re.MULTILINE)
    assert len(rows) >= 6
    for link, options in rows:
        query = QueryParams(link.partition("?")[2])
        linked = scene_of_query(query, KINDS["statistics"], catalogue, parameter_names(catalogue))
        given = stats.make_context("stats", options.split()).params
        typed = parse_scene(scene_data(**{k: v for k, v in given.items() if k not in ("format_", "outputs", "device")}))
        asked, commanded = resolve(linked, catalogue), resolve(typed, catalogue)
        assert asked.scene.model_dump_json() == commanded.scene.model_dump_json()
        assert asked.series == commanded.series


def test_a_preset_with_azimuths_over_http_gives_the_json_of_the_command_line(server):
    options = (
        "stats --preset red-velvet --set kd=0.1,0.2 --set ks=0.3,0.1 --zip kd,ks --technique cosine --samples 2000"
    )
    view = "--theta-o-deg 0,60 --phi-o-deg 0,45"
    command = [sys.executable, "-c", "from service.cli import main; main()", *options.split(), *view.split()]
    printed = json.loads(subprocess.run([*command, "--format", "json"], capture_output=True, check=True).stdout)
    link = "preset=red-velvet&kd=0.1,0.2&ks=0.3,0.1&zip=kd,ks&techniques=cosine"
    link += "&theta_o_deg=0,60&phi_o_deg=0,45&samples=2000"
    answered = server.client.get(f"/v1/statistics?{link}")
    while answered.status_code == 202:
        server.await_job(answered.headers["location"])
        answered = server.client.get(f"/v1/statistics?{link}")
    assert answered.status_code == 200, answered.text
    assert without_run(answered.json()) == without_run(printed)
    both = server.client.get("/v1/statistics?preset=red-velvet&model=eon&techniques=cosine").json()
    assert {error["field"] for error in both["errors"]} == {"model"}
    unknown = server.client.get("/v1/statistics?preset=gold").json()
    assert "preset" in {error["field"] for error in unknown["errors"]}


def test_a_posted_scene_and_the_link_for_it_get_the_same_bytes(server):
    linked = server.client.get(LINK)
    scene = {
        "model": "eon",
        "parameters": {"roughness": [0.5, 1]},
        "techniques": ["cosine", "cltc-mis"],
        "theta_o_deg": {"count": 4},
        "estimator": {"samples": 20000, "seed": 3},
    }
    posted = server.ask(scene)
    assert posted.status_code == 200
    assert posted.content == linked.content
    assert posted.headers["etag"] == linked.headers["etag"]


def test_the_answer_is_that_of_the_function(server, direct_answer):
    assert without_run(server.ask(SMALL).json()) == direct_answer(SMALL)


@pytest.mark.parametrize("name", TYPES)
def test_accept_and_format_choose_the_same_representation(server, name):
    by_header = server.client.get(LINK, headers={"accept": f"{TYPES[name]}, */*;q=0.1"})
    by_query = server.client.get(f"{LINK}&format={name}")
    assert by_header.status_code == by_query.status_code == 200
    assert by_header.headers["content-type"].partition(";")[0] == TYPES[name]
    assert by_header.headers["vary"] == "Accept"
    assert by_header.content == by_query.content
    assert by_header.headers["etag"] == by_query.headers["etag"]


def test_every_representation_holds_the_numbers_of_the_json(server):
    series = server.client.get(LINK).json()["series"]
    rows = list(csv.DictReader(io.StringIO(server.client.get(f"{LINK}&format=csv").text)))
    assert [float(row["mean"]) for row in rows] == [value for one in series for value in one["mean"]]
    archive = np.load(io.BytesIO(server.client.get(f"{LINK}&format=npz").content))
    assert archive["variance"].tolist() == [one["variance"] for one in series]
    assert server.client.get(f"{LINK}&format=vega").json()["$schema"].partition(".json")[0].split("/")[-1][:2] == "v6"
    assert server.client.get(f"{LINK}&format=png").content.startswith(b"\x89PNG\r\n\x1a\n")
    assert server.client.get(f"{LINK}&format=svg").text.startswith("<svg")


def test_series_carry_axis_labels_units_and_scale_hints(server):
    answer = server.client.get(LINK).json()
    assert answer["axes"]["theta_o_deg"] == {"label": "view angle θo", "unit": "deg", "scale": "linear"}
    assert answer["axes"]["variance"]["scale"] == "log"
    plotted = {"mean", "variance", "max_weight"}
    assert plotted <= answer["axes"].keys()
    for one in answer["series"]:
        assert {len(one[name]) for name in plotted} == {len(one["theta_o_deg"])}


def test_quality_values_choose_and_json_is_the_default(server):
    for accept, wanted in (
        ("text/csv;q=0.5, image/png;q=0.4", "text/csv"),
        ("*/*", "application/json"),
        ("application/*", "application/json"),
        ("image/*;q=0.9, application/json;q=0.1", "image/png"),
    ):
        assert server.client.get(LINK, headers={"accept": accept}).headers["content-type"].startswith(wanted)


def test_figures_are_scenes_of_papers(server):
    listed = server.client.get("/v1/figures").json()["figures"]
    assert {"eon-11", "eon-13"} <= {figure["name"] for figure in listed}
    answer = server.client.get("/v1/figures/eon-13?samples=2000&seed=5&format=json")
    while answer.status_code == 202:  # the first time its reference takes long
        server.await_job(answer.headers["location"])
        answer = server.client.get("/v1/figures/eon-13?samples=2000&seed=5&format=json")
    scene = answer.json()["scene"]
    assert (scene["estimator"]["samples"], scene["estimator"]["seed"]) == (2000, 5)
    assert scene["parameters"] == {"roughness": [0.0, 0.25, 0.5, 0.75, 1.0]}
    picture = server.client.get("/v1/figures/eon-13?samples=2000&seed=5&format=svg")
    assert picture.text.startswith("<svg")
    plain = server.ask(scene, params={"format": "svg"})
    assert plain.status_code == 200
    assert plain.content != picture.content  # the figure's own chart, not that of statistics in general


def test_the_catalogue_is_that_of_info(server):
    from service.information import describe_catalogue

    answer = server.client.get("/v1/catalogue")
    assert answer.json() == {"kind": "catalogue", **describe_catalogue(load_catalogue())}
    again = server.client.get("/v1/catalogue", headers={"if-none-match": answer.headers["etag"]})
    assert again.status_code == 304
    assert not again.content


def test_head_tells_the_etag_without_a_body(server):
    head = server.client.head(LINK)
    assert head.status_code == 200
    assert head.headers["etag"] == server.client.get(LINK).headers["etag"]
    assert not head.content
