"""Which driver is opened, and what is said where there is none: one line that says what to do."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lavapipe import Device, DeviceNotFound, InvalidArgument, drivers

OPEN = """
import os, lavapipe
before = dict(os.environ)
try:
    with lavapipe.Device.open({arguments}) as device:
        print(device.info.name)
except lavapipe.DeviceNotFound as error:
    print(error)
assert dict(os.environ) == before
"""


def said(arguments: str = "", **environment: str) -> str:
    """What a fresh process prints: the device's name or the error, and nothing on stderr."""
    clean = {name: value for name, value in os.environ.items() if name not in drivers.VARIABLES}
    run = subprocess.run(
        [sys.executable, "-c", OPEN.format(arguments=arguments)],
        env=clean | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stderr == ""
    assert run.stdout.count("\n") == 1
    return run.stdout.strip()


def test_lavapipe_is_the_default() -> None:
    assert said().startswith("llvmpipe")


@pytest.mark.parametrize("variable", drivers.VARIABLES)
def test_nonsense_in_the_environment_is_one_line(variable: str, tmp_path: Path) -> None:
    (tmp_path / "bad.json").write_text("{}")
    for value in ("/nonsense", str(tmp_path / "bad.json"), str(tmp_path)):
        line = said(**{variable: value})
        assert line.startswith(f"{variable}={value} names no Vulkan driver that works here: unset it")


def test_manifest_of_a_missing_library_is_one_line(tmp_path: Path) -> None:
    manifest = tmp_path / "driver.json"
    manifest.write_text('{"file_format_version": "1.0.0", "ICD": {"library_path": "/no.so", "api_version": "1.3.0"}}')
    assert "names no Vulkan driver that works here: unset it" in said(VK_ICD_FILENAMES=str(manifest))


@pytest.mark.parametrize("variable", drivers.VARIABLES)
def test_a_driver_in_the_environment_is_respected(variable: str, tmp_path: Path) -> None:
    manifest = drivers.lavapipe_manifest()
    assert manifest is not None
    copy = tmp_path / "mine.json"
    copy.write_bytes(manifest.read_bytes())
    assert said(**{variable: str(copy)}).startswith("llvmpipe")
    assert said(**{variable: f"/nonsense:{copy}"}).startswith("llvmpipe")


def test_an_empty_variable_is_none() -> None:
    assert said(VK_ICD_FILENAMES="", VK_DRIVER_FILES="").startswith("llvmpipe")


def test_unknown_name_lists_what_there_is() -> None:
    with pytest.raises(DeviceNotFound, match=r"no Vulkan device is named 'GeForce'; there are: .*llvmpipe"):
        Device.open("GeForce")


def test_missing_driver_says_what_to_run() -> None:
    # The loader and this package look for drivers in the same folders.
    line = said(XDG_DATA_DIRS="/nonsense")
    assert line == "Mesa's software Vulkan driver lavapipe is not installed: run lavapipe/install.sh"


def test_missing_layer_says_what_to_run() -> None:
    line = said("validation=True", VK_LAYER_PATH="/nonsense")
    assert line.startswith("the Vulkan validation layer VK_LAYER_KHRONOS_validation is not installed: run lavapipe/")


def test_importing_loads_no_vulkan() -> None:
    script = "import sys, lavapipe; sys.exit('vulkan' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_driver_threads_follow_the_environment() -> None:
    script = "import lavapipe; print(lavapipe.Device.open().info.threads)"
    for setting, threads in (("3", "3"), ("0", "1"), ("", str(len(os.sched_getaffinity(0))))):
        environment = os.environ | {"LP_NUM_THREADS": setting}
        run = subprocess.run(
            [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True
        )
        assert run.stdout.strip() == threads


def test_bad_memory_limit_is_named() -> None:
    with pytest.raises(InvalidArgument, match="memory_limit_bytes=0"):
        Device.open(memory_limit_bytes=0)


def test_a_driver_whose_hardware_is_not_here_is_one_line() -> None:
    """The package that holds lavapipe holds Radeon's driver too, which fails on a machine without such a card."""
    manifest = drivers.lavapipe_manifest()
    assert manifest is not None
    (radeon,) = manifest.parent.glob("radeon_icd*.json")
    line = said(VK_DRIVER_FILES=str(radeon))
    assert "names no Vulkan driver that works here" in line or "AMD" in line


OPEN_AND_RUN = """
import sys, numpy as np
from lavapipe import Device, compile_glsl
code = "#version 460\\nlayout(local_size_x = 1) in;\\nlayout(set = 0, binding = 0) buffer B { float x[]; };\\n"
spirv = compile_glsl(code + "void main() { x[0] = sqrt(x[1]); }")
with Device.open(shader_cache=sys.argv[1] == "on") as device, device.buffer(2, np.float32) as data:
    device.run(device.pipeline(spirv, buffers=1), [data], (1, 1, 1))
"""


@pytest.mark.parametrize("cache", ["on", "off"])
def test_a_device_without_a_shader_cache_keeps_nothing(cache, tmp_path):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("MESA_")}
    environment["MESA_SHADER_CACHE_DIR"] = str(tmp_path / "not there yet")
    subprocess.run([sys.executable, "-c", OPEN_AND_RUN, cache], env=environment, check=True, timeout=120)
    assert any(path.is_file() and path.name != "index" for path in tmp_path.rglob("*")) == (cache == "on")
