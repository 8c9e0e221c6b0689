"""The driver's vectors: the processor's widest, unless the user says otherwise, with compiled shaders kept apart."""

import os
from pathlib import Path

import pytest

from lavapipe import Device
from lavapipe.vectors import widest

WIDE = "processor\t: 0\nflags\t\t: fpu sse2 avx avx2 avx512f avx512dq avx512bw avx512vl\n"
NARROW = "processor\t: 0\nflags\t\t: fpu sse2 avx avx2 avx512f\n"


@pytest.fixture(autouse=True)
def unset(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("LP_NATIVE_VECTOR_WIDTH", "MESA_SHADER_CACHE_DIR"):
        monkeypatch.setenv(name, "")  # so that it is restored
        monkeypatch.delenv(name)


def cpu(folder: Path, text: str) -> Path:
    file = folder / "cpuinfo"
    file.write_text(text)
    return file


def test_a_processor_with_avx512_gets_512_bits_and_a_cache_of_their_own(tmp_path: Path) -> None:
    os.environ["MESA_SHADER_CACHE_DIR"] = str(tmp_path)
    before = dict(os.environ)
    with widest(cpu(tmp_path, WIDE)), widest(cpu(tmp_path, WIDE)):  # again is harmless
        assert os.environ["LP_NATIVE_VECTOR_WIDTH"] == "512"
        assert os.environ["MESA_SHADER_CACHE_DIR"] == str(tmp_path / "512-bit")
    assert dict(os.environ) == before


@pytest.mark.parametrize("text", [NARROW, "", "processor : 0\n"])
def test_other_processors_are_left_to_the_driver(text: str, tmp_path: Path) -> None:
    with widest(cpu(tmp_path, text)), widest(tmp_path / "missing"):
        assert not {"LP_NATIVE_VECTOR_WIDTH", "MESA_SHADER_CACHE_DIR"} & set(os.environ)


def test_a_width_that_is_set_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LP_NATIVE_VECTOR_WIDTH", "256")
    with widest(cpu(tmp_path, WIDE)):
        assert os.environ["LP_NATIVE_VECTOR_WIDTH"] == "256"
        assert "MESA_SHADER_CACHE_DIR" not in os.environ


def test_the_default_cache_folder_is_the_drivers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with widest(cpu(tmp_path, WIDE)):
        assert os.environ["MESA_SHADER_CACHE_DIR"] == str(tmp_path / "mesa_shader_cache" / "512-bit")
    assert not {"LP_NATIVE_VECTOR_WIDTH", "MESA_SHADER_CACHE_DIR"} & set(os.environ)


def test_the_devices_name_says_how_wide_it_is(device: Device) -> None:
    assert f"{32 * device.info.subgroup_size} bits" in device.info.name
