"""install.sh: does nothing where nothing is missing, and says what it needs where it cannot go on."""

import os
import stat
import subprocess
from pathlib import Path

import lavapipe

SCRIPT = Path(lavapipe.__file__).parent / "install.sh"


def run(path: Path) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PATH": f"{path}:{os.environ['PATH']}"}
    return subprocess.run([str(SCRIPT)], env=environment, capture_output=True, text=True, check=False)


def fake(folder: Path, name: str, script: str) -> None:
    (folder / name).write_text(f"#!/bin/sh\n{script}\n")
    (folder / name).chmod(0o755)


def test_it_is_executable() -> None:
    assert SCRIPT.stat().st_mode & stat.S_IXUSR


def test_nothing_missing_means_no_apt(tmp_path: Path) -> None:
    fake(tmp_path, "dpkg-query", "printf 'install ok installed'")
    fake(tmp_path, "apt-get", f"touch {tmp_path}/called")
    result = run(tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert not (tmp_path / "called").exists()


def test_only_what_is_missing_is_installed(tmp_path: Path) -> None:
    fake(tmp_path, "dpkg-query", 'case "$*" in *glslang*) exit 1 ;; *) printf "install ok installed" ;; esac')
    fake(tmp_path, "apt-get", f'echo "$*" >> {tmp_path}/calls')
    fake(tmp_path, "id", "echo 0")
    assert run(tmp_path).returncode == 0
    update, install = (tmp_path / "calls").read_text().splitlines()
    assert update.startswith("update")
    assert install.split()[-2:] == ["--no-install-recommends", "glslang-tools"]


def test_sudo_is_used_where_not_root(tmp_path: Path) -> None:
    fake(tmp_path, "dpkg-query", "exit 1")
    fake(tmp_path, "apt-get", "exit 99")
    fake(tmp_path, "id", "echo 1000")
    fake(tmp_path, "sudo", f'echo "$*" >> {tmp_path}/calls')
    assert run(tmp_path).returncode == 0
    assert (tmp_path / "calls").read_text().startswith("apt-get update")


def test_a_failed_update_is_a_failure(tmp_path: Path) -> None:
    fake(tmp_path, "dpkg-query", "exit 1")
    fake(tmp_path, "apt-get", "exit 7")
    fake(tmp_path, "id", "echo 0")
    assert run(tmp_path).returncode == 7
