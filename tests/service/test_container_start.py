"""The container's start: baked caches are copied once, and their absence or a read-only root is no error."""

import pytest

from service.container import CACHES, seed


@pytest.fixture
def folders(tmp_path, monkeypatch):
    for variable, name in zip(CACHES, ("samplerscope", "mesa"), strict=True):
        (tmp_path / "baked" / name / "deep").mkdir(parents=True)
        (tmp_path / "baked" / name / "deep" / "entry").write_text(name)
        monkeypatch.setenv(variable, str(tmp_path / "cache" / name))
    return tmp_path


def test_baked_caches_are_laid_out_where_the_environment_says(folders):
    seed(folders / "baked")
    assert (folders / "cache/mesa/deep/entry").read_text() == "mesa"
    assert (folders / "cache/samplerscope/deep/entry").read_text() == "samplerscope"


def test_a_cache_that_is_there_is_left_alone(folders):
    (folders / "cache/mesa").mkdir(parents=True)
    seed(folders / "baked")
    assert list((folders / "cache/mesa").iterdir()) == []


def test_a_place_that_cannot_be_written_only_costs_time(folders, capsys):
    (folders / "cache").write_text("in the way")
    seed(folders / "baked")
    assert "cold caches" in capsys.readouterr().err


def test_no_baked_cache_is_no_error(folders):
    seed(folders / "nothing")
    assert not (folders / "cache").exists()
