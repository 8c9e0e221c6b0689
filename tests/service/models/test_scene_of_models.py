"""View azimuths, presets and the whole catalogue in one scene."""

import math

import pytest

from service.catalogue import load_catalogue
from service.errors import BadInput
from service.presets import preset_names, with_preset
from service.random_numbers import cell_key
from service.scene import parse_scene, resolve
from service.statistics import series_cells


def question(**scene):
    return resolve(parse_scene(scene), load_catalogue())


def test_only_anisotropic_models_have_a_view_azimuth():
    assert "phi_o_deg" not in question(model="eon").scene.model_dump(mode="json")
    assert question(model="ward").scene.model_dump(mode="json")["phi_o_deg"] == [0.0]
    with pytest.raises(BadInput, match="eon is isotropic"):
        question(model="eon", phi_o_deg=[0])
    with pytest.raises(BadInput, match="-360 to 360"):
        question(model="ward", phi_o_deg=[361])


def test_azimuths_are_swept_one_series_a_value():
    asked = question(model="ward", techniques="cosine", phi_o_deg=[0, 90], parameters={"mx": [0.1, 0.2]})
    assert [(plan.parameters["mx"], plan.phi_o_deg) for plan in asked.series] == [
        (0.1, 0.0), (0.1, 90.0), (0.2, 0.0), (0.2, 90.0),
    ]  # fmt: skip


def test_the_view_turns_with_its_azimuth_and_has_random_numbers_of_its_own():
    asked = question(model="ward", techniques="cosine", phi_o_deg=[30], theta_o_deg=[60], estimator={"seed": 5})
    cells = series_cells(asked.series[0], asked.scene)
    expected = [math.sin(math.pi / 3) * math.cos(math.pi / 6), math.sin(math.pi / 3) / 2, 0.5]
    assert cells.wo[0] == pytest.approx(expected, rel=1e-7)
    assert tuple(cells.keys[0]) == cell_key(5, 60.0, 30.0)


def test_all_asks_every_model_with_every_technique_made_for_it():
    catalogue = load_catalogue()
    pairs = {(plan.model.name, plan.technique.name) for plan in question(model="all").series}
    assert pairs == {(model, technique) for model in catalogue.models for technique in catalogue.techniques_for(model)}


def test_a_preset_zips_the_channels_of_its_reflectances():
    assert preset_names() == ["brushed-aluminum", "purple-satin", "red-velvet", "yellow-satin"]
    asked = question(**with_preset("red-velvet", {"model": "eon", "techniques": ["cosine"]}))
    rows = [(plan.parameters["kd"], plan.parameters["ks"]) for plan in asked.series]
    assert rows == [(0.0048, 0.1938), (0.0005, 0.0333), (0, 0.0267)]
    assert all(plan.model.name == "kurt" and plan.parameters["my"] == 2.644 for plan in asked.series)


def test_a_parameter_given_beside_a_preset_wins():
    asked = question(**with_preset("red-velvet", {"techniques": ["cosine"], "parameters": {"kd": [0.1]}}))
    assert [(plan.parameters["kd"], plan.parameters["ks"]) for plan in asked.series] == [
        (0.1, 0.1938), (0.1, 0.0333), (0.1, 0.0267),
    ]  # fmt: skip


def test_an_unknown_preset_is_answered_with_those_there_are():
    with pytest.raises(BadInput, match="brushed-aluminum, purple-satin"):
        with_preset("gold", {})
